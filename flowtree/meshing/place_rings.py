"""Where the rings of the wood's surface stand: centre, axis, radius and how far the surface leans."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.meshing.trace_chains import Chains, trace_chains
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_THINNEST = 1e-5  # of the tree's extent; thinner rings would collapse in float32
_SPACING = 0.35  # of a ring's radius; closer rings would cut into each other at a bend
_COLLAR = 0.22  # by how much a branch is thicker where it leaves its parent
_COLLAR_REACH = 0.9  # of the branch's radius, over which that fades
_FLARE_REACH = 1.3  # of the trunk's radius, over which the root flare fades
_FADING = (0.0, 0.5, 1.2, 2.6)  # where rings follow a fading, in units of its reach


@dataclass(frozen=True)
class Rings:
    """Rings of all branches, one branch behind the other, from base to tip.

    Attributes:
        center: (k, 3) [m].
        tangent: (k, 3), unit, toward the tip.
        radius: (k,) [m]; 0 at the apex that ends every branch.
        slope: (k,) d radius / d arc of the surface; -inf at an apex, where the normal is the tangent.
        arc: (k,) [m], distance from the branch's base along its axis.
        bark_radius: (k,) [m], the radius without flare, collar and cap: what the bark's width follows.
        chain: (k,), which branch, counted from 0 without gaps.
        sides: (c,), sides of each branch's rings.
    """

    center: Floats
    tangent: Floats
    radius: Floats
    slope: Floats
    arc: Floats
    bark_radius: Floats
    chain: Ints
    sides: Ints


@dataclass(frozen=True)
class _Axis:
    """Branch axes while rings are added and taken away; one row an entry, as in `Rings`."""

    center: Floats
    radius: Floats
    chain: Ints

    def at(self, rows: NDArray[np.bool_] | Ints) -> _Axis:
        return _Axis(self.center[rows], self.radius[rows], self.chain[rows])


def place_rings(skeleton: Skeleton, params: MeshingParams) -> Rings:
    """Places rings perpendicular to the branches at the skeleton's nodes (Particle Flows, section 8).

    Beside the nodes' rings there are some at the foot (root flare), where a thick branch leaves its parent
    (collar), and at tips (a rounded end, pointed for twigs). A side branch begins on its parent's axis, with
    a ring small enough to lie inside the parent. Nodes closer than a third of the radius share a ring.

    Raises:
        InputError: every branch has no length.
    """
    chains = trace_chains(skeleton)
    points = skeleton.points.astype(np.float64)
    extent = float(np.max(np.ptp(points, axis=0)))
    thick = np.maximum(skeleton.radius.astype(np.float64), _THINNEST * extent)
    axis, base = _axes(chains, points, thick, skeleton.parent.astype(np.int64), extent)

    chain_count = int(axis.chain[-1]) + 1
    width = np.zeros(chain_count)
    np.maximum.at(width, axis.chain, axis.radius)
    sides = _side_count(width, width.max(), params.sides)

    # How each branch swells at its base: the collar of a thick side branch, the flare of the trunk.
    first = _firsts(axis.chain)
    reach = np.where(base.root, _FLARE_REACH, _COLLAR_REACH) * axis.radius[first]
    amount = np.where(base.root, params.root_flare, np.where(sides >= 6, _COLLAR, 0.0))
    axis = _thin_out(_with_extra_rings(axis, base.leaving, reach, amount > 0))
    arc = _arcs(axis)
    fading = np.exp(-np.maximum(arc - base.leaving[axis.chain], 0.0) / reach[axis.chain])
    radius = axis.radius * (1.0 + amount[axis.chain] * fading)
    inside = base.parent_radius * np.cos(np.pi / _side_count(base.parent_radius, width.max(), params.sides))
    hidden = ~base.root[axis.chain] & (arc < base.leaving[axis.chain])
    hidden[_firsts(axis.chain)] = ~base.root
    radius = np.where(hidden, np.minimum(radius, 0.97 * inside[axis.chain]), radius)
    return _cap(axis, radius, sides, base.root)


@dataclass(frozen=True)
class _Base:
    """Where branches begin: (c,) arrays."""

    root: NDArray[np.bool_]  # whether the branch stands on the ground
    parent_radius: Floats  # [m], of the branch it leaves
    leaving: Floats  # [m], the arc at which it comes out of the parent's surface; 0 for the trunk


def _axes(chains: Chains, points: Floats, thick: Floats, parent: Ints, extent: float) -> tuple[_Axis, _Base]:
    """The axes of all branches of some length, and how they begin."""
    radius = thick[chains.node]
    radius[_firsts(chains.chain)] = thick[chains.sprout]
    axis = _thin_out(_Axis(points[chains.node], radius, chains.chain))
    alive = _lengths(axis) > 1e-6 * extent
    check.require(
        bool(alive.any()), "skeleton", "needs a branch of some length", "nodes in one place", "spread them"
    )
    axis = axis.at(alive[axis.chain])
    axis = _Axis(axis.center, axis.radius, (np.cumsum(alive) - 1)[axis.chain])

    sprout = chains.sprout[alive]
    leaves_from = np.maximum(parent[sprout], 0)
    first = _firsts(axis.chain)
    out = _unit(axis.center[np.minimum(first + 1, len(axis.chain) - 1)] - axis.center[first])
    before = points[leaves_from] - points[np.maximum(parent[leaves_from], 0)]
    sine = np.linalg.norm(np.cross(out, _unit(before)), axis=1)
    root = parent[sprout] < 0
    # A branch that goes on along its parent leaves it only far up: then the collar would be a lone bulge, so
    # it is placed as if the angle were 20 degrees.
    leaving = np.where(root, 0.0, thick[leaves_from] / np.maximum(sine, 0.34))
    return axis, _Base(root, thick[leaves_from], leaving)


def _side_count(radius: Floats, thickest: float, sides: int) -> Ints:
    """Even, as a texture that runs out and back turns at a corner; but 3 for twigs, and where 3 is asked for.

    It falls with the cube root of the radius. Equal deviation from the circle would ask for the square root,
    but 4 sides show on a branch one walks by.
    """
    wanted = sides * np.cbrt(radius / thickest)
    even = np.clip(2 * np.rint(wanted / 2.0), 4, max(4, sides - sides % 2))
    count: Ints = np.where((wanted < 3.0) | (sides == 3), 3, even).astype(np.int64)
    return count


def _with_extra_rings(axis: _Axis, leaving: Floats, reach: Floats, where: NDArray[np.bool_]) -> _Axis:
    """Adds the rings that a fading swelling needs, interpolated on the axis."""
    arc = _arcs(axis)
    length = _lengths(axis)
    extra = leaving[:, None] + reach[:, None] * np.array(_FADING)
    chain, place = np.nonzero(where[:, None] & (extra > 0) & (extra < 0.9 * length[:, None]))
    extra_arc = extra[chain, place]
    # One growing coordinate over all branches, so that a single search finds every segment.
    offset = np.concatenate(([0.0], np.cumsum(length + 1.0)[:-1]))
    along = offset[axis.chain] + arc
    above = np.searchsorted(along, offset[chain] + extra_arc)
    below = above - 1
    share = (extra_arc - arc[below]) / np.maximum(arc[above] - arc[below], 1e-12)
    center = axis.center[below] + share[:, None] * (axis.center[above] - axis.center[below])
    radius = axis.radius[below] + share * (axis.radius[above] - axis.radius[below])
    return _Axis(
        np.insert(axis.center, above, center, axis=0),
        np.insert(axis.radius, above, radius),
        np.insert(axis.chain, above, chain),
    )


def _thin_out(axis: _Axis) -> _Axis:
    """Drops rings until no two of a branch are closer than `_SPACING`; the first and the last always stay."""
    while True:
        k = len(axis.chain)
        first = np.zeros(k, np.bool_)
        first[_firsts(axis.chain)] = True
        last = np.append(first[1:], True)
        gap = np.linalg.norm(np.diff(axis.center, axis=0, prepend=axis.center[:1]), axis=1)
        close = ~first & (gap < _SPACING * axis.radius)
        # A tip is not dropped: the ring before it goes instead, unless that is the base.
        crowd = np.append((close & last)[1:], False) & ~first
        close = (close & ~last) | crowd
        if not close.any():
            return axis
        # Of a run of close rings every second goes: then the spacing is measured anew.
        index = np.arange(k)
        run = index - np.maximum.accumulate(np.where(close, -1, index))
        axis = axis.at(~(close & (run % 2 == 1)))


def _cap(axis: _Axis, radius: Floats, sides: Ints, root: NDArray[np.bool_]) -> Rings:
    """Adds the rounded or pointed ends and works out tangents and slopes."""
    first = _firsts(axis.chain)
    last = np.append(first[1:], len(axis.chain)) - 1
    tangent = _tangents(axis)
    # The foot stands flat on the ground even where the trunk leans.
    upright = root & (tangent[first, 1] > 0.5)
    tangent[first[upright]] = (0.0, 1.0, 0.0)

    arc = _arcs(axis)
    gap = np.diff(arc, prepend=0.0)
    growth = np.diff(radius, prepend=0.0)
    inner = np.ones(len(arc), np.bool_)
    inner[first] = False
    incline = np.where(inner, growth / np.maximum(gap, 1e-12), 0.0)
    after = np.append(incline[1:], 0.0)
    slope = np.where(inner, 0.5 * (incline + after), after)
    slope[last] = incline[last] - 0.5  # already turning into the cap
    slope = np.clip(slope, -2.0, 2.0)

    # Cap rings as (height, width, slope), in radii of the last ring: a dome, a point for twigs.
    dome = sides[axis.chain[last]] > 4
    rows = [(np.flatnonzero(dome), 0.5, 0.78, -1.2), (np.flatnonzero(dome), 0.85, 0.0, -np.inf)]
    rows.append((np.flatnonzero(~dome), 1.6, 0.0, -np.inf))
    at = np.concatenate([last[which] + 1 for which, *_ in rows])
    end = np.concatenate([last[which] for which, *_ in rows])
    height, wide, lean = (
        np.concatenate([np.full(len(row[0]), row[value]) for row in rows]) for value in (1, 2, 3)
    )
    rise = height * radius[end]
    order = np.lexsort((height, at))
    at, end, rise, wide, lean = at[order], end[order], rise[order], wide[order], lean[order]
    return Rings(
        center=np.insert(axis.center, at, axis.center[end] + rise[:, None] * tangent[end], axis=0),
        tangent=np.insert(tangent, at, tangent[end], axis=0),
        radius=np.insert(radius, at, wide * radius[end]),
        slope=np.insert(slope, at, lean),
        arc=np.insert(arc, at, arc[end] + rise),
        bark_radius=np.insert(axis.radius, at, axis.radius[end]),
        chain=np.insert(axis.chain, at, axis.chain[end]),
        sides=sides,
    )


def _tangents(axis: _Axis) -> Floats:
    """Halfway between the directions of the two segments that meet; where they cancel, the earlier one."""
    segment = _unit(np.diff(axis.center, axis=0))
    within = (axis.chain[1:] == axis.chain[:-1])[:, None]
    segment = np.where(within, segment, 0.0)
    none = np.zeros((1, 3))
    before, after = np.concatenate([none, segment]), np.concatenate([segment, none])
    both = before + after
    back = np.linalg.norm(both, axis=1) < 0.1
    return _unit(np.where(back[:, None], before, both))


def _firsts(chain: Ints) -> Ints:
    return np.flatnonzero(np.diff(chain, prepend=-1))


def _arcs(axis: _Axis) -> Floats:
    gap = np.linalg.norm(np.diff(axis.center, axis=0, prepend=axis.center[:1]), axis=1)
    first = _firsts(axis.chain)
    gap[first] = 0.0
    total: Floats = np.cumsum(gap)
    arc: Floats = total - total[first][axis.chain]
    return arc


def _lengths(axis: _Axis) -> Floats:
    first = _firsts(axis.chain)
    length: Floats = _arcs(axis)[np.append(first[1:], len(axis.chain)) - 1]
    return length


def _unit(vector: Floats) -> Floats:
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    unit: Floats = np.divide(vector, length, out=np.zeros_like(vector), where=length > 0)
    return unit
