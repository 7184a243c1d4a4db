"""Axes of many branches, one behind the other, while rings are added and taken away."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class BranchAxes:
    """Polylines with radii, from base to tip.

    Attributes:
        center: (k, 3) [m].
        radius: (k,) [m].
        chain: (k,), which branch a row belongs to, counted from 0 without gaps, never falling.
        node: (k,), the skeleton node whose segment carries the row.
    """

    center: Floats
    radius: Floats
    chain: Ints
    node: Ints

    @property
    def first(self) -> Ints:
        """(c,) the row of each branch's base."""
        return np.flatnonzero(np.diff(self.chain, prepend=-1))

    @property
    def last(self) -> Ints:
        """(c,) the row of each branch's tip."""
        return np.append(self.first[1:], len(self.chain)) - 1

    def arc(self) -> Floats:
        """(k,) [m], the distance from the branch's base along its axis."""
        gap = np.linalg.norm(np.diff(self.center, axis=0, prepend=self.center[:1]), axis=1)
        gap[self.first] = 0.0
        total: Floats = np.cumsum(gap)
        along: Floats = total - total[self.first][self.chain]
        return along

    def length(self) -> Floats:
        """(c,) [m]."""
        whole: Floats = self.arc()[self.last]
        return whole

    def tangents(self) -> Floats:
        """(k, 3) halfway between the directions of two segments that meet; the earlier where they cancel."""
        segment = unit(np.diff(self.center, axis=0))
        within = (self.chain[1:] == self.chain[:-1])[:, None]
        segment = np.where(within, segment, 0.0)
        none = np.zeros((1, 3))
        before, after = np.concatenate([none, segment]), np.concatenate([segment, none])
        both = before + after
        back = np.linalg.norm(both, axis=1) < 0.1
        return unit(np.where(back[:, None], before, both))

    def at(self, rows: NDArray[np.bool_] | Ints) -> BranchAxes:
        """Some of the rows; every branch must keep one."""
        return BranchAxes(self.center[rows], self.radius[rows], self.chain[rows], self.node[rows])

    def between(self, chain: Ints, arc: Floats) -> tuple[Ints, Floats, Floats]:
        """Interpolates: the row above (n,), centre (n, 3) and radius (n,) at an arc (n,) of a branch (n,).

        The arc must be more than 0 and less than the branch's length.
        """
        own, length = self.arc(), self.length()
        # One growing coordinate over all branches, so that a single search finds every segment.
        offset = np.concatenate(([0.0], np.cumsum(length + 1.0)[:-1]))
        above = np.searchsorted(offset[self.chain] + own, offset[chain] + arc)
        below = above - 1
        share = (arc - own[below]) / np.maximum(own[above] - own[below], 1e-12)
        center = self.center[below] + share[:, None] * (self.center[above] - self.center[below])
        radius: Floats = self.radius[below] + share * (self.radius[above] - self.radius[below])
        return above, center, radius

    def insert(self, before: Ints, center: Floats, radius: Floats, chain: Ints, node: Ints) -> BranchAxes:
        """The axes with new rows (n,) before those named (n,)."""
        return BranchAxes(
            np.insert(self.center, before, center, axis=0),
            np.insert(self.radius, before, radius),
            np.insert(self.chain, before, chain),
            np.insert(self.node, before, node),
        )


def unit(vector: Floats) -> Floats:
    """Vectors (n, 3) of length 1; those of length 0 stay 0."""
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    scaled: Floats = np.divide(vector, length, out=np.zeros_like(vector), where=length > 0)
    return scaled
