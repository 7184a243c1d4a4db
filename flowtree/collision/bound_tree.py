"""Capsules around a tree's thick wood, and a coarse hull around its crown."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.coarse_hull import coarse_hull
from flowtree.geometry.parent_array import main_child
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.model.collision import Collision
from flowtree.model.foliage import Foliage
from flowtree.model.skeleton import Skeleton

# Radii of the thinnest wood with capsules that are tried; how well all capsules must fit, and the error at
# which one is not split further; in foot's radii.
_THINNEST = (0.8, 0.7, 0.6, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25, 0.2)
_LOOSEST, _TIGHTEST = 0.4, 0.1
_SPLITS = 40  # points at most at which splitting a capsule is tried
_HULL_CORNERS = 34  # 64 triangles


@dataclass(frozen=True)
class _Piece:
    """A run of a branch, and how far the capsule in its place is from its surface.

    Attributes:
        points: (m, 3) float64 [m], from its beginning, m >= 2.
        radius: (m,) float64 [m].
        error: at the worst place [m].
    """

    points: NDArray[np.float64]
    radius: NDArray[np.float64]
    error: float


def bound_tree(
    skeleton: Skeleton, foliage: Foliage | None = None, *, capsules: int = 16, hull: bool = True
) -> Collision:
    """Bounds stem and thick limbs by capsules, and the crown by a convex hull.

    Each branch begins with one capsule, and the one that fits worst is split, as long as there are some left.
    As much wood is covered, from the thick to the thin, as the capsules suffice for with errors of 0.4 foot's
    radii at most, down to wood of 0.2: what walks into twigs should pass. Where they do not suffice for wood
    of 0.8, that wood is covered as well as they do.

    The hull holds nearly all leaves, or, of a bare tree, the branches: what is below the crown stays free,
    the stem there has its capsules. It has at most 64 triangles.

    Args:
        skeleton: world frame [m].
        foliage: None for a bare tree.
        capsules: at most so many.
        hull: whether to make it; without, it is empty.

    Returns: see `Collision`; the stem's lowest capsule comes first.

    Raises:
        InputError: fewer than one capsule, a skeleton of a single node.
    """
    check.require(capsules >= 1, "capsules", "must be at least 1", capsules, "ask for more")
    count = len(skeleton.parent)
    check.require(count >= 2, "skeleton", "needs two nodes or more", count, "trace more particles")
    foot = float(skeleton.radius[0])
    thinnest = foot * _THINNEST[0]
    pieces, _ = _cover(_thick_branches(skeleton, thinnest), capsules, _TIGHTEST * foot)
    for thinner in _THINNEST[1:]:
        more, error = _cover(_thick_branches(skeleton, foot * thinner), capsules, _TIGHTEST * foot)
        if error > _LOOSEST * foot:
            break
        thinnest, pieces = foot * thinner, more
    positions, triangles = np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32)
    if hull:
        positions, triangles = coarse_hull(_crown(skeleton, foliage), corners=_HULL_CORNERS)
    return Collision(
        capsule_ends=np.array([_ends(piece) for piece in pieces], np.float32),
        capsule_radius=np.array([_middle(piece.radius) for piece in pieces], np.float32),
        hull_positions=positions,
        hull_triangles=triangles,
        thinnest=thinnest,
    )


def _thick_branches(skeleton: Skeleton, thinnest: float) -> list[_Piece]:
    """The thick part of every branch, from where it leaves its parent branch; the stem's first."""
    parent, radius = skeleton.parent, skeleton.radius.astype(np.float64)
    points = skeleton.points.astype(np.float64)
    onward = main_child(parent, radius)
    thick = radius >= thinnest
    thick[max(int(onward[0]), 0)] = True  # a stem has a capsule, however its radii are
    heads = np.flatnonzero(thick & (onward[np.maximum(parent, 0)] != np.arange(len(parent))))
    branches = []
    for head in heads.tolist():
        run = [head]
        while (following := int(onward[run[-1]])) >= 0 and thick[following]:
            run.append(following)
        nodes = np.array([int(parent[head]), *run] if head else run)
        own = radius[nodes]
        if head:  # where a branch leaves another, the radius is the other's
            own[0] = own[1]
        branches.append(_piece(points[nodes], own))
    return branches


def _cover(branches: list[_Piece], capsules: int, tolerance: float) -> tuple[list[_Piece], float]:
    """At most so many pieces near the wood, branch by branch, and the error of the worst [m]."""
    # The greatest error first; of a limb without a capsule it is the limb's own thickness.
    heap = [
        (-(2.0 * float(piece.radius.max()) if branch else np.inf), branch, 0, False, piece)
        for branch, piece in enumerate(branches)
    ]
    heapq.heapify(heap)
    kept: list[tuple[int, int, _Piece]] = []
    room, error = capsules, 0.0
    while heap:
        wrong, branch, place, has_one, piece = heapq.heappop(heap)
        good = room == 0 or -wrong <= tolerance
        if good or (has_one and len(piece.points) == 2):
            error = max(error, -wrong)
            if has_one:
                kept.append((branch, place, piece))
        else:
            room -= 1
            split = _best_split(piece) if has_one else 0
            low = _piece(piece.points[: split + 1], piece.radius[: split + 1]) if split else piece
            heapq.heappush(heap, (-low.error, branch, place, True, low))
            if split:
                high = _piece(piece.points[split:], piece.radius[split:])
                heapq.heappush(heap, (-high.error, branch, place + split, True, high))
    return [piece for _, _, piece in sorted(kept, key=lambda entry: entry[:2])], error


def _piece(points: NDArray[np.float64], radius: NDArray[np.float64]) -> _Piece:
    _, nearest = nearest_on_segments(points, points[0], points[-1])
    beside = np.linalg.norm(points - nearest, axis=1)
    return _Piece(points, radius, float(np.max(beside + np.abs(radius - _middle(radius)))))


def _best_split(piece: _Piece) -> int:
    """The inner point, of some along the whole piece, at which the worse of both halves is best."""
    inner = np.unique(np.linspace(1, len(piece.points) - 2, _SPLITS).astype(int))
    worst = [
        max(
            _piece(piece.points[: k + 1], piece.radius[: k + 1]).error,
            _piece(piece.points[k:], piece.radius[k:]).error,
        )
        for k in inner
    ]
    return int(inner[np.argmin(worst)])


def _middle(radius: NDArray[np.float64]) -> float:
    return 0.5 * float(radius.min() + radius.max())


def _ends(piece: _Piece) -> NDArray[np.float64]:
    """(2, 3), the lower end first."""
    ends = piece.points[[0, -1]]
    return ends if ends[0, 1] <= ends[1, 1] else ends[::-1]


def _crown(skeleton: Skeleton, foliage: Foliage | None) -> NDArray[np.float32]:
    """The points to be held by the hull: leaves; else branches; else the stem."""
    if foliage is not None and len(foliage.position):
        return foliage.position
    branches = skeleton.level > 0
    return skeleton.points[branches] if branches.any() else skeleton.points
