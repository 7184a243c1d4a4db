"""Where the rings of the wood's surface stand: centre, axis, radius and how far the surface leans."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.meshing.branch_axes import BranchAxes, Floats, Ints, unit
from flowtree.meshing.drop_rings import drop_rings
from flowtree.meshing.ease_forks import ease_forks
from flowtree.meshing.trace_chains import Chains, trace_chains
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

_THINNEST = 1e-5  # of the tree's extent; thinner rings would collapse in float32
_SPACING = 0.35  # of a ring's radius; closer rings would cut into each other at a bend
_THICK = 0.3  # of the parent's radius; thicker branches grow out of it in a curve
_COLLAR = 0.22  # by how much a branch is thicker where it leaves its parent
_COLLAR_REACH = 0.9  # of the branch's radius, over which that fades
_FLARE_REACH = 1.3  # of the trunk's radius, over which the root flare fades
_STOUT = 0.004  # of the extent: the radius from which a branch must be twice as true to its shape as a twig
_BLADE = 0.2  # of the tolerance: thinner twigs have no thickness
_FLAT = 0.007  # of the extent: less of a tolerance finer than this
_FADING = (0.0, 0.5, 1.2, 2.6)  # where rings follow a fading, in units of its reach


@dataclass(frozen=True)
class Rings:
    """Rings of all branches, one branch behind the other, from base to tip.

    Attributes:
        center: (k, 3) [m].
        tangent: (k, 3), unit, toward the tip.
        radius: (k,) [m]; 0 at the apex that ends every branch.
        slope: (k,) d radius / d arc of the surface; -inf at an apex, where the normal is the tangent.
        arc: (k,) [m], distance from the branch's base along its axes.
        bark_radius: (k,) [m], the radius without flare, collar and cap: what the bark's width follows.
        chain: (k,), which branch, counted from 0 without gaps.
        node: (k,), the skeleton node whose segment carries the ring.
        sides: (c,), sides of each branch's rings; 2 make a blade with a front and a back.
    """

    center: Floats
    tangent: Floats
    radius: Floats
    slope: Floats
    arc: Floats
    bark_radius: Floats
    chain: Ints
    node: Ints
    sides: Ints


def place_rings(skeleton: Skeleton, params: MeshingParams) -> Rings:
    """Places rings perpendicular to the branches at the skeleton's nodes (Particle Flows, section 8).

    Beside the nodes' rings there are some at the foot (root flare), where a branch leaves its parent (a curve
    for thick ones, see `ease_forks`, else a collar), and at tips (a dome, a point for twigs). A side branch
    begins on its parent's axis, with a ring small enough to lie inside the parent. Nodes closer than a third
    of the radius share a ring; with ``params.tolerance`` also those that `drop_rings` tells.

    Raises:
        InputError: every branch has no length.
    """
    chains = trace_chains(skeleton)
    points = skeleton.points.astype(np.float64)
    extent = float(np.max(np.ptp(points, axis=0)))
    thick = np.maximum(skeleton.radius.astype(np.float64), _THINNEST * extent)
    parent = skeleton.parent.astype(np.int64)
    axes, base = _axes(chains, points, thick, parent, extent)

    width = np.zeros(len(base.root))
    np.maximum.at(width, axes.chain, axes.radius)
    sides = _side_count(width, width.max(), params)
    thick_enough = ~base.root & (axes.radius[axes.first] > _THICK * base.parent_radius) & (sides >= 6)
    axes, bent = ease_forks(axes, points, parent, base.fork, base.parent_radius, thick_enough)

    # How each branch swells at its base: the collar of a side branch, the flare of the trunk.
    reach = np.where(base.root, _FLARE_REACH, _COLLAR_REACH) * axes.radius[axes.first]
    amount = np.where(base.root, params.root_flare, np.where((sides >= 6) & ~bent, _COLLAR, 0.0))
    leaving = np.where(bent, 0.0, base.leaving)
    axes = _thin_out(_with_extra_rings(axes, leaving, reach, amount > 0))
    arc = axes.arc()
    fading = np.exp(-np.maximum(arc - leaving[axes.chain], 0.0) / reach[axes.chain])
    radius = axes.radius * (1.0 + amount[axes.chain] * fading)
    inside = base.parent_radius * np.cos(np.pi / _side_count(base.parent_radius, width.max(), params))
    hidden = ~base.root[axes.chain] & (arc < leaving[axes.chain])
    hidden[axes.first] = ~base.root
    radius = np.where(hidden, np.minimum(radius, 0.97 * inside[axes.chain]), radius)
    if not params.tolerance:
        return _cap(axes, radius, sides, base.root)
    tolerance = params.tolerance * extent
    strict = tolerance / (1.0 + width / (_STOUT * extent))
    kept = drop_rings(BranchAxes(axes.center, radius, axes.chain, axes.node), strict)
    rings = _cap(axes.at(kept), radius[kept], sides, base.root)
    thin = width < _BLADE * tolerance * min(1.0, params.tolerance / _FLAT)
    return _sharpen(rings, tolerance, np.where(base.root, np.inf, 0.97 * inside + tolerance), thin)


@dataclass(frozen=True)
class _Base:
    """Where branches begin: (c,) arrays."""

    root: NDArray[np.bool_]  # whether the branch stands on the ground
    fork: Ints  # the node it leaves; the root for the trunk
    parent_radius: Floats  # [m], of the branch it leaves
    leaving: Floats  # [m], the arc at which it comes out of the parent's surface; 0 for the trunk


def _axes(
    chains: Chains, points: Floats, thick: Floats, parent: Ints, extent: float
) -> tuple[BranchAxes, _Base]:
    """The axes of all branches of some length, and how they begin."""
    radius = thick[chains.node]
    begin = np.flatnonzero(np.diff(chains.chain, prepend=-1))
    radius[begin] = thick[chains.sprout]
    # A base stands where its branch's first segment begins, not on the segment below.
    node = chains.node.copy()
    node[begin] = chains.node[np.minimum(begin + 1, len(node) - 1)]
    axes = _thin_out(BranchAxes(points[chains.node], radius, chains.chain, node))
    alive = axes.length() > 1e-6 * extent
    check.require(
        bool(alive.any()), "skeleton", "needs a branch of some length", "nodes in one place", "spread them"
    )
    axes = axes.at(alive[axes.chain])
    axes = BranchAxes(axes.center, axes.radius, (np.cumsum(alive) - 1)[axes.chain], axes.node)

    sprout = chains.sprout[alive]
    leaves_from = np.maximum(parent[sprout], 0)
    first = axes.first
    out = unit(axes.center[np.minimum(first + 1, len(axes.chain) - 1)] - axes.center[first])
    before = points[leaves_from] - points[np.maximum(parent[leaves_from], 0)]
    sine = np.linalg.norm(np.cross(out, unit(before)), axis=1)
    root = parent[sprout] < 0
    # A branch that goes on along its parent leaves it only far up: then the collar would be a lone bulge, so
    # it is placed as if the angle were 20 degrees.
    leaving = np.where(root, 0.0, thick[leaves_from] / np.maximum(sine, 0.34))
    return axes, _Base(root, leaves_from, thick[leaves_from], leaving)


def _side_count(radius: Floats, thickest: float, params: MeshingParams) -> Ints:
    """Even, as a texture that runs out and back turns at a corner; but 3 for twigs, and where 3 is asked for.

    It falls with the cube root of the radius. Equal deviation from the circle would ask for the square root,
    but 4 sides show on a branch one walks by: only with a tolerance is it that.
    """
    share = radius / thickest
    wanted = params.sides * (np.sqrt(share) if params.tolerance else np.cbrt(share))
    even = np.clip(2 * np.rint(wanted / 2.0), 4, max(4, params.sides - params.sides % 2))
    count: Ints = np.where((wanted < 3.0) | (params.sides == 3), 3, even).astype(np.int64)
    return count


def _with_extra_rings(
    axes: BranchAxes, leaving: Floats, reach: Floats, where: NDArray[np.bool_]
) -> BranchAxes:
    """Adds the rings that a fading swelling needs, interpolated on the axes."""
    extra = leaving[:, None] + reach[:, None] * np.array(_FADING)
    there = where[:, None] & (extra > 0) & (extra < 0.9 * axes.length()[:, None])
    chain, place = np.nonzero(there)
    above, center, radius = axes.between(chain, extra[chain, place])
    return axes.insert(above, center, radius, chain, axes.node[above])


def _thin_out(axes: BranchAxes) -> BranchAxes:
    """Drops rings until no two of a branch are closer than `_SPACING`; the first and the last always stay."""
    while True:
        k = len(axes.chain)
        first = np.zeros(k, np.bool_)
        first[axes.first] = True
        last = np.append(first[1:], True)
        gap = np.linalg.norm(np.diff(axes.center, axis=0, prepend=axes.center[:1]), axis=1)
        close = ~first & (gap < _SPACING * axes.radius)
        # A tip is not dropped: the ring before it goes instead, unless that is the base.
        crowd = np.append((close & last)[1:], False) & ~first
        close = (close & ~last) | crowd
        if not close.any():
            return axes
        # Of a run of close rings every second goes: then the spacing is measured anew.
        index = np.arange(k)
        run = index - np.maximum.accumulate(np.where(close, -1, index))
        axes = axes.at(~(close & (run % 2 == 1)))


def _cap(axes: BranchAxes, radius: Floats, sides: Ints, root: NDArray[np.bool_]) -> Rings:
    """Adds the rounded or pointed ends and works out tangents and slopes."""
    first = axes.first
    last = axes.last
    tangent = axes.tangents()
    # The foot stands flat on the ground even where the trunk leans.
    upright = root & (tangent[first, 1] > 0.5)
    tangent[first[upright]] = (0.0, 1.0, 0.0)

    arc = axes.arc()
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
    dome = sides[axes.chain[last]] > 4
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
        center=np.insert(axes.center, at, axes.center[end] + rise[:, None] * tangent[end], axis=0),
        tangent=np.insert(tangent, at, tangent[end], axis=0),
        radius=np.insert(radius, at, wide * radius[end]),
        slope=np.insert(slope, at, lean),
        arc=np.insert(arc, at, arc[end] + rise),
        bark_radius=np.insert(axes.radius, at, axes.radius[end]),
        chain=np.insert(axes.chain, at, axes.chain[end]),
        node=np.insert(axes.node, at, axes.node[end]),
        sides=sides,
    )


def _sharpen(rings: Rings, tolerance: float, widest: Floats, thin: NDArray[np.bool_]) -> Rings:
    """Lets branches no thicker at their tips than the tolerance run out into points, without a ring before.

    One that has only its base left then is as wide there as both its ends together were, but no wider than
    ``widest`` (c,) [m]: so much of it is still to be seen. If it is ``thin`` (c,), it is a blade: of two
    sides, without thickness.
    """
    first = np.flatnonzero(np.diff(rings.chain, prepend=-1))
    apex = np.append(first[1:], len(rings.chain)) - 1
    cap = np.where(rings.sides > 4, 2, 1)  # rows above a branch's last ring
    sharp = (rings.radius[apex - cap] <= tolerance) & (apex - cap > first)
    short = sharp & (apex - cap - 1 == first)
    radius = rings.radius.copy()
    both = radius[first[short]] + radius[(apex - cap)[short]]
    radius[first[short]] = np.maximum(radius[first[short]], np.minimum(both, widest[short]))
    kept = np.ones(len(rings.chain), np.bool_)
    kept[apex[sharp] - 1] = False
    kept[(apex - cap)[sharp]] = False
    rows = {each.name: getattr(rings, each.name)[kept] for each in fields(rings) if each.name != "sides"}
    return replace(rings, **rows | {"radius": radius[kept]}, sides=np.where(short & thin, 2, rings.sides))
