"""Where side branches come out of the wood that they leave."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flowtree.geometry.local_units import local_units
from flowtree.meshing.branch_axes import Floats, Ints, unit
from flowtree.meshing.branch_curves import BranchCurves, any_across

# Where a branch is looked at, in radii of its host: beyond the last it stays a part of it.
_STEPS = np.array([0.4, 0.7, 0.9, 1.05, 1.2, 1.4, 1.65, 2, 2.5, 3.1, 4, 5, 6.5, 8.5, 11, 14, 18, 24])
_CLEAR = 1.1  # of its own radius by which a branch's axis is outside of its host where it begins
_WIDTH = 1.06  # half the width of the square that becomes a circle of radius 1
_SLANT = 2.4  # a slanting section is this much longer than wide at most
_SHARE = 0.6  # of a branch's length that may lie inside the host


@dataclass(frozen=True)
class Exits:
    """One entry a branch; those of branch 0, which leaves none, mean nothing.

    Attributes:
        begin: (c,) [m], arc of the branch where it leaves the host's surface.
        arc: (c,) [m], arc of the host beside that place.
        outward: (c, 3), unit, across the host, toward the branch: the local z axis.
        host_along: (c, 3), unit, the host's direction: the local y axis.
        angle: (c,) of ``outward`` in the host's rotation-minimising frame [radians].
        radius: (c,) [m], the branch's where it begins.
        host_radius: (c,) [m], beside it.
        lean: (c,) cosine between the branch and the host's direction.
        way: (c, 3), unit, the branch's direction there.
        half: (c, 2) [m], half the size of its square section with the host's surface, across and along it.
    """

    begin: Floats
    arc: Floats
    outward: Floats
    host_along: Floats
    angle: Floats
    radius: Floats
    host_radius: Floats
    lean: Floats
    way: Floats
    half: Floats


def find_exits(curves: BranchCurves) -> Exits:
    """Follows every side branch from its fork to where it has come out of its host's wood.

    That is a host radius and a little more than its own away from the host's axis: begun further down, the
    inner side of its first rings would lie within the wood and fold the surface at the crotch.

    The paper takes the point where the branch's first segment meets the unit's main face (figure 3: Q). A
    branch that leaves at a few degrees meets it far up, or never: so the branch is followed along its bends,
    24 host radii or 0.6 of its length at most.
    """
    count = len(curves.length)
    branch, host = np.arange(count), np.maximum(curves.host, 0)
    fork_radius = curves.at(host, curves.fork_arc)[1]
    away = np.minimum(fork_radius[:, None] * _STEPS, _SHARE * curves.length[:, None])
    steps = len(_STEPS)
    each, on = np.repeat(branch, steps), np.repeat(host, steps)
    place = curves.at(each, away.ravel())[0]
    beside = _nearest_arc(curves, on, np.repeat(curves.fork_arc, steps), place)
    axis, wide, _ = curves.at(on, beside)
    share = (np.linalg.norm(place - axis, axis=1) / wide).reshape(count, steps)

    own = np.minimum(curves.at(branch, np.minimum(fork_radius, curves.length))[1] / fork_radius, 1.0)
    clear = 1.0 + _CLEAR * own
    out = share >= clear[:, None]
    last = np.where(out.any(axis=1), out.argmax(axis=1), steps - 1)
    before = np.maximum(last - 1, 0)
    near, far = share[branch, before], share[branch, last]
    gain = np.where((far > clear) & (last > 0), (clear - near) / np.maximum(far - near, 1e-9), 1.0)
    begin = away[branch, before] + np.clip(gain, 0.0, 1.0) * (away[branch, last] - away[branch, before])

    center, radius, _ = curves.at(branch, begin)
    arc = _nearest_arc(curves, host, curves.fork_arc, center)
    axis, host_radius, _ = curves.at(host, arc)
    one, two, along = curves.frames(host, arc, 0.5 * host_radius)
    direction = curves.frames(branch, begin, 0.5 * radius)[2]
    toward = center - axis
    toward -= np.sum(toward * along, axis=1, keepdims=True) * along
    vague = np.linalg.norm(toward, axis=1) < 0.05 * host_radius
    toward = np.where(vague[:, None], direction, unit(toward))
    parallel = np.linalg.norm(np.cross(along, toward), axis=1) < 1e-3
    toward[parallel] = any_across(along[parallel])
    outward = local_units(along, toward)[:, 2]
    angle = np.arctan2(np.sum(outward * two, axis=1), np.sum(outward * one, axis=1))
    lean = np.clip(np.sum(direction * along, axis=1), -1.0, 1.0)
    slant = np.clip(1.0 / np.sqrt(np.maximum(1.0 - lean**2, 1e-6)), 1.0, _SLANT)
    half = _WIDTH * radius[:, None] * np.stack([np.ones(count), slant], axis=1)
    return Exits(begin, arc, outward, along, angle, radius, host_radius, lean, direction, half)


def leave_wood(curves: BranchCurves) -> tuple[BranchCurves, Exits]:
    """The curves and their exits, where what leaves a branch within that one's host leaves the host itself.

    A branch of a thick host runs in its wood for a while; what it carries there comes out of the host.
    """
    while True:
        exits = find_exits(curves)
        hidden = np.flatnonzero((curves.host > 0) & (exits.arc < exits.begin[curves.host]))
        if not len(hidden):
            return curves, exits
        host, fork_arc = curves.host.copy(), curves.fork_arc.copy()
        fork_arc[hidden] = exits.arc[curves.host[hidden]]
        host[hidden] = curves.host[curves.host[hidden]]
        curves = replace(curves, host=host, fork_arc=fork_arc)


def _nearest_arc(curves: BranchCurves, host: Ints, fork_arc: Floats, place: Floats) -> Floats:
    """(n,) [m], where hosts pass nearest to places (n, 3) beside forks, found by three projections."""
    arc = fork_arc
    for _ in range(3):
        axis, wide, _ = curves.at(host, arc)
        along = curves.frames(host, arc, 0.5 * wide)[2]
        arc = np.clip(arc + np.sum((place - axis) * along, axis=1), 0.0, curves.length[host])
    return arc
