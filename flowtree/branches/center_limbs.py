"""Draws thick limbs onto the attractor graphs that they followed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.branches.smooth_branches import smooth_branches
from flowtree.geometry.parent_array import levels
from flowtree.geometry.projection import to_plane, view_axes
from flowtree.model.attractor import AttractorGraph
from flowtree.model.skeleton import Skeleton

_REACH = 0.02  # of the height: a limb farther from the graph than this has not followed it
_THICK = 0.12  # share of all particles from which a limb is drawn fully; thinner ones less
_ROUNDS = 4  # of smoothing of the shifts, not of the limb


def center_limbs(skeleton: Skeleton, graphs: Sequence[AttractorGraph], yaws: Sequence[float]) -> Skeleton:
    """Shifts the trunk and thick limbs sideways until they lie on the graph in every view.

    The direction field loses its pull toward the graph as the distance falls (Particle Flows, equation 3 with
    linear blending), so a trunk swings around the line it follows by about half its width. The graph's line
    is the middle of the visible stem: the picture is right. Everything that grows from a limb moves with it.

    Args:
        skeleton: the branches.
        graphs: one a view.
        yaws: of the views [degrees].

    Returns: the skeleton with moved points; the root stays.
    """
    height = float(np.ptp(skeleton.points[:, 1]))
    share = skeleton.particles / max(int(skeleton.particles[0]), 1)
    weight = np.clip(share / _THICK, 0.0, 1.0)
    rights = np.array([view_axes(yaw)[0][[0, 2]] for yaw in yaws])
    offsets = np.stack(
        [_offset(skeleton, g, yaw, _REACH * height) for g, yaw in zip(graphs, yaws, strict=True)]
    )
    drawn = np.where(np.isnan(offsets), 0.0, weight)
    aside = np.nan_to_num(offsets) * drawn
    aside[:, 0] = 0.0
    parent = skeleton.parent
    for nodes in levels(parent)[1:]:  # what is not drawn itself goes along with the limb it grows from
        aside[:, nodes] += (1.0 - drawn[:, nodes]) * aside[:, parent[nodes]]
    # The horizontal shift that views agree on: each view sees one component of it.
    shift = np.zeros((len(share), 3))
    shift[:, [0, 2]] = (np.linalg.pinv(rights) @ aside).T
    shift = smooth_branches(parent, shift, skeleton.particles, rounds=_ROUNDS)
    return replace(skeleton, points=(skeleton.points + shift).astype(np.float32))


def _offset(skeleton: Skeleton, graph: AttractorGraph, yaw: float, reach: float) -> NDArray[np.float64]:
    """How far right of each node the graph runs at the node's height [m]; NaN where it runs nowhere near."""
    flat = to_plane(skeleton.points, yaw)
    low, high = graph.points[graph.parent[1:]].astype(np.float64), graph.points[1:].astype(np.float64)
    rise = high[:, 1] - low[:, 1]
    offset = np.full(len(flat), np.nan)
    nearest = np.full(len(flat), reach)
    for a, b, dy in zip(low[rise > 0], high[rise > 0], rise[rise > 0], strict=True):
        level = (flat[:, 1] >= a[1]) & (flat[:, 1] < b[1])
        across = a[0] + (b[0] - a[0]) * (flat[:, 1] - a[1]) / dy - flat[:, 0]
        closer = level & (np.abs(across) < nearest)
        offset[closer] = across[closer]
        nearest[closer] = np.abs(across[closer])
    return offset
