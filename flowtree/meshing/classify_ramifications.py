"""Which side branches are connected before the first subdivision, and which are pasted after it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.parent_array import levels
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.branch_curves import BranchCurves
from flowtree.meshing.find_exits import Exits

_FINER = 8.0  # a branch this many times thinner than the thickest needs half as many sides
_THIN = 0.25  # of the host's radius; thinner branches fit into a face of a host once subdivided
_MIDDLING = 0.6  # of the host's radius; thinner branches fit into the four faces around a vertex then
_CORNER = np.radians(35.0)  # from the middle of a face: nearer than 10 degrees to an edge of the unit
_NEAR = 0.5  # of the unit's half length: children this near to its middle may share it

TRUNK, CONNECTABLE, ADDITIONAL, LATER = range(4)
Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Ramifications:
    """One entry a branch.

    Attributes:
        kind: TRUNK; CONNECTABLE: leaves a unit of its host before any subdivision of the host's; ADDITIONAL:
            is subdivided once by itself and then pasted; LATER: put into the host as it is then.
        birth: number of subdivisions after which the branch's control mesh is made.
        unit: branch whose unit it shares (itself, if it has one of its own); -1 without a unit.
        angle: of the unit's main face in the host's frame [radians].
        middle: [m], arc of the unit's middle on the host.
        long: [m], half the length that the unit wants.
        short: [m], half the least length that it can have.
    """

    kind: Ints
    birth: Ints
    unit: Ints
    angle: Floats
    middle: Floats
    long: Floats
    short: Floats

    def but(self, dropped: Ints, subdivisions: int) -> Ramifications:
        """The same, with some branches (m,) that have found no place in their hosts' control meshes."""
        kind, unit = self.kind.copy(), self.unit.copy()
        again = self.birth[dropped] + 1 < subdivisions
        kind[dropped] = np.where(again, ADDITIONAL, LATER)
        unit[dropped] = -1
        return replace(self, kind=kind, unit=unit)


def classify_ramifications(
    curves: BranchCurves, exits: Exits, *, subdivisions: int, all_additional: bool = False
) -> Ramifications:
    """Connectable and additional ramifications (Manifold Ramifications, section 5).

    Of the children that leave a branch at one node the thickest makes the unit. Another is connectable if

    1. seen along the branch, its direction stays 10 degrees away from the unit's edges (the paper: the angle
       to the first child modulo 45 degrees is at least 10 degrees; read so, a child straight across would
       never do, although it leaves through the middle of a face: what matters are the edges, at 45 degrees
       modulo 90), and
    2. it leaves through a face of the unit that no thicker child has taken, beside the unit's middle.

    Unlike the paper, branches are also told apart by thickness: one that needs fewer sides, or is thin enough
    for a face of its host once that is subdivided, is LATER: made and put in after another subdivision. That
    is what keeps thousands of twigs from having as many sides as the trunk. After the last subdivision but
    one everything is made as it is: there the first condition does not count, and what is not connectable
    gets a unit of its own further along, if there is room, or else a face.

    Args:
        curves: the branches.
        exits: where they leave their hosts.
        subdivisions: of the whole surface.
        all_additional: leave nothing connectable, where a subdivision is left to do otherwise.
    """
    count = len(curves.length)
    host = np.maximum(curves.host, 0)
    birth = _births(curves, exits, subdivisions)
    kind = np.where(birth > birth[host], LATER, CONNECTABLE)
    kind[0] = TRUNK
    hosted = kind == CONNECTABLE

    half = exits.half[:, 1] + 0.4 * np.abs(exits.lean) * exits.radius  # with room for the web
    thin = exits.radius < _THIN * exits.host_radius
    long = np.maximum(np.where(thin, 2.0, 1.5) * half, np.where(thin, 0.0, exits.host_radius))
    short = half / 0.8

    own = np.arange(count)
    order = np.lexsort((own, -exits.radius, curves.fork_arc, curves.host))
    order = order[hosted[order]]
    same = (np.diff(curves.host[order]) == 0) & (np.diff(curves.fork_arc[order]) == 0)
    begin = np.flatnonzero(np.concatenate(([True], ~same))[: len(order)])
    current = np.empty(count, np.int64)
    current[order] = np.repeat(order[begin], np.diff(np.append(begin, len(order))))
    other = order[current[order] != order]
    turn = exits.angle[other] - exits.angle[current[other]]
    side = np.rint(turn / (0.5 * np.pi)).astype(np.int64) % 4
    off = np.abs(np.mod(turn + 0.25 * np.pi, 0.5 * np.pi) - 0.25 * np.pi)
    unpasted = birth[other] + 1 >= subdivisions
    fits = ((off <= _CORNER) | unpasted) & (side != 0)
    fits &= np.abs(exits.arc[other] - exits.arc[current[other]]) <= _NEAR * long[current[other]]
    fits &= short[other] <= long[current[other]]
    face = 4 * current[other] + side
    _, first = np.unique(np.where(fits, face, -1), return_index=True)
    only = np.zeros(len(other), np.bool_)
    only[first] = True
    fits &= only

    unit = np.where(hosted, own, -1)
    unit[other[fits]] = current[other[fits]]
    shared = long.copy()
    np.maximum.at(shared, unit[other[fits]], short[other[fits]])
    least = short.copy()
    np.maximum.at(least, unit[other[fits]], short[other[fits]])
    # A unit turns to where the children that are farthest off the middles of their faces are equally far.
    swing = np.mod(turn[fits] + 0.25 * np.pi, 0.5 * np.pi) - 0.25 * np.pi
    left, right = np.zeros((2, count))
    np.minimum.at(left, current[other[fits]], swing)
    np.maximum.at(right, current[other[fits]], swing)
    angle = exits.angle + 0.5 * (left + right)
    made = Ramifications(kind, birth, unit, angle, exits.arc, shared, least)
    rest = np.flatnonzero(hosted) if all_additional else other[~fits]
    return made.but(rest[birth[rest] + 1 < subdivisions], subdivisions)


def _births(curves: BranchCurves, exits: Exits, subdivisions: int) -> Ints:
    """(c,) the subdivisions before each branch is made: later for thin ones, never earlier than its host."""
    thickness = np.zeros(len(curves.length))
    np.maximum.at(thickness, curves.axes.chain, curves.axes.radius)
    wanted = np.floor(np.log(thickness.max() / thickness) / np.log(_FINER) + 1e-9).astype(np.int64)
    birth = np.zeros(len(wanted), np.int64)
    last = max(subdivisions - 1, 0)
    for branches in levels(curves.host)[1:]:
        before = birth[curves.host[branches]]
        finer = exits.radius[branches] < _THIN * exits.host_radius[branches]
        # Another thin one may wait too, if a hole of four quads is wide enough for it.
        may = exits.radius[branches] < _MIDDLING * exits.host_radius[branches]
        later = np.where(may, np.maximum(wanted[branches], before + finer), before)
        birth[branches] = np.clip(later, before, np.minimum(before + 1, last))
    return birth
