"""The square rings of the control mesh: where they stand on their branches and how they are turned."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.branch_curves import BranchCurves
from flowtree.meshing.classify_ramifications import CONNECTABLE, Ramifications
from flowtree.meshing.find_exits import Exits
from flowtree.meshing.place_units import Collars, Units

_FLARE_REACH = 1.3  # of the trunk's radius, over which the root flare fades
_FOOT = (0.05, 0.2)  # rings close above the ground keep its edge: subdivision rounds what is far apart
_FLARE = (0.65, 1.6, 3.4)  # rings that follow the flare, in radii
_OFF = 0.06  # radii that a bend may be cut by before it gets two rings
_SHARP = 0.5  # a bend of more [radians] gets three
_ASTRAY = 0.25  # host radii that a face may be away from where a branch comes out
_SPACING = 0.6  # radii between rings that nothing asks for
_ANCHOR = 0.25  # of the host's radius: thinner branches leave a face wherever it is, not through its middle

Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class ControlRings:
    """Rings of all branches, one branch behind the other, from base to tip.

    Attributes:
        chain: (r,), which branch.
        arc: (r,) [m], on its curve.
        turn: (r,), angle of the middle of side 0 in the branch's frame [radians].
        shear: (r,), how far the ring lies in its host's surface: 1 at the base, 0 across the branch.
        start: (u,), the ring at which each unit begins; the next one ends it.
    """

    chain: Ints
    arc: Floats
    turn: Floats
    shear: Floats
    start: Ints


def lay_rings(
    curves: BranchCurves,
    exits: Exits,
    made: Ramifications,
    units: Units,
    collars: Collars,
    drift: Floats,
) -> ControlRings:
    """Rings at bases, collars and ends, at the units' boundaries, and in between where a branch bends.

    A ring is turned so that the main faces of units face their branches. From unit to unit each side goes on
    to the side that is nearest around the branch: of four ways to connect them the one whose cosine distances
    sum to the least (equation 6); the rest of the turn is spread over the rings between.
    """
    count = len(curves.length)
    branch = np.arange(count)
    two = collars.second > collars.first
    side = branch[1:]
    foot = exits.host_radius[0] * np.minimum(1.0, curves.length[0] / (4.0 * exits.host_radius[0]))
    # A unit whose start is the boundary before it shares that ring.
    follows = np.concatenate(([False], units.host[1:] == units.host[:-1]))
    before = np.where(
        follows, np.roll(units.end, 1), np.where(units.host == 0, -1.0, collars.second[units.host])
    )
    fresh = units.start > before
    topped = np.zeros(count, np.bool_)
    topped[units.host[units.end == collars.tip[units.host]]] = True
    parts: list[tuple[Ints, Floats, Floats]] = [
        (branch, collars.begin, np.where(branch > 0, 1.0, 0.0)),
        (side, collars.first[1:], np.full(count - 1, 0.5)),
        (side[two[1:]], collars.second[side[two[1:]]], np.full(two[1:].sum(), 0.15)),
        (np.zeros(len(_FOOT), np.int64), foot * np.array(_FOOT), np.zeros(len(_FOOT))),
        (branch, collars.end, np.zeros(count)),
        (branch[~topped], collars.tip[~topped], np.zeros((~topped).sum())),
        (units.host[fresh], units.start[fresh], np.zeros(fresh.sum())),
        (units.host, units.end, np.zeros(len(units.end))),
    ]
    chain, arc, shear = (np.concatenate(column) for column in zip(*parts, strict=True))
    soft_chain, soft_arc = _between(curves, exits, made, collars, drift, foot)
    soft_chain, soft_arc = _clear_of(curves, (chain, arc), units, (soft_chain, soft_arc))

    fixed = len(chain)
    chain, arc = np.concatenate([chain, soft_chain]), np.concatenate([arc, soft_arc])
    shear = np.concatenate([shear, np.zeros(len(soft_chain))])
    order = np.lexsort((arc, chain))
    place = np.empty(len(order), np.int64)
    place[order] = np.arange(len(order))
    end = place[fixed - len(units.end) : fixed]
    chain, arc = chain[order], arc[order]
    return ControlRings(chain, arc, _turns(curves, exits, units, collars, chain, arc), shear[order], end - 1)


def return_from(drift: Floats, radius: Floats) -> Floats:
    """How far (n,) [m] from their bases branches that were pushed (n, 3) are on their own axes."""
    back: Floats = 1.1 * np.linalg.norm(drift, axis=1) + 1.5 * radius
    return back


def _between(
    curves: BranchCurves,
    exits: Exits,
    made: Ramifications,
    collars: Collars,
    drift: Floats,
    foot: float,
) -> tuple[Ints, Floats]:
    """Rings that bends, the root flare and branches put in later ask for: branch (n,) and arc (n,) [m]."""
    axes = curves.axes
    inner = np.ones(len(axes.chain), np.bool_)
    inner[axes.first] = inner[axes.last] = False
    row = np.flatnonzero(inner)
    ahead, back = axes.center[row + 1] - axes.center[row], axes.center[row] - axes.center[row - 1]
    gap = np.minimum(curves.arc[row + 1] - curves.arc[row], curves.arc[row] - curves.arc[row - 1])
    cosine = np.sum(ahead * back, axis=1) / (np.linalg.norm(ahead, axis=1) * np.linalg.norm(back, axis=1))
    bend = np.arccos(np.clip(cosine, -1.0, 1.0))
    radius = axes.radius[row]
    split = bend * gap > 6.0 * _OFF * radius
    apart = np.minimum(np.clip(0.2 / np.maximum(bend, 1e-6), 0.6, 2.0) * radius, 0.3 * gap)
    one = ~split | (bend > _SHARP)
    at = curves.arc[row]
    host = curves.host
    later = np.flatnonzero((made.kind != CONNECTABLE) & (host >= 0))
    reach = 0.8 * exits.host_radius[later]
    # Those put in later find their faces later: by then the rings stand.
    pushed = np.linalg.norm(drift, axis=1)
    pushed[later] = np.maximum(pushed[later], _ASTRAY * exits.host_radius[later])
    moved = np.flatnonzero((pushed > 0.1 * exits.radius) & (host >= 0))
    home = collars.begin[moved] + 3.0 * pushed[moved] + 1.5 * exits.radius[moved]
    rows = [
        (moved, home),
        (axes.chain[row[one]], at[one]),
        (axes.chain[row[split]], (at - apart)[split]),
        (axes.chain[row[split]], (at + apart)[split]),
        (np.zeros(len(_FLARE), np.int64), foot * np.array(_FLARE)),
        (host[later], exits.arc[later] - reach),
        (host[later], exits.arc[later] + reach),
    ]
    chain, arc = (np.concatenate(column) for column in zip(*rows, strict=True))
    order = np.lexsort((arc, chain))
    chain, arc = chain[order], arc[order]
    inside = (arc > collars.second[chain]) & (arc < collars.end[chain])
    return chain[inside], arc[inside]


def _clear_of(
    curves: BranchCurves, fixed: tuple[Ints, Floats], units: Units, soft: tuple[Ints, Floats]
) -> tuple[Ints, Floats]:
    """Of the soft rings those that stand free: not within a unit, nor close to a ring."""
    chain, arc = soft
    radius = curves.at(chain, arc)[1]
    place = curves.offset[chain] + arc
    standing = np.sort(curves.offset[fixed[0]] + fixed[1])
    after = np.searchsorted(standing, place)
    room = _SPACING * radius
    free = place - standing[np.maximum(after - 1, 0)] > room
    free &= standing[np.minimum(after, len(standing) - 1)] - place > room
    begin, end = curves.offset[units.host] + units.start, curves.offset[units.host] + units.end
    if len(begin):
        inside = np.searchsorted(begin, place) - 1
        free &= (inside < 0) | (place > end[np.maximum(inside, 0)])
    chain, place, room = chain[free], place[free], room[free]
    while True:
        close = np.concatenate(([False], np.diff(place) < room[1:]))[: len(place)]
        if not close.any():
            return chain, place - curves.offset[chain]
        # Of a run of close rings every second goes: then the spacing is measured anew.
        index = np.arange(len(place))
        run = index - np.maximum.accumulate(np.where(close, -1, index))
        kept = ~(close & (run % 2 == 1))
        chain, place, room = chain[kept], place[kept], room[kept]


def _turns(
    curves: BranchCurves, exits: Exits, units: Units, collars: Collars, chain: Ints, arc: Floats
) -> Floats:
    """(r,) how each ring is turned [radians]: as the units' faces and the base ask, between them evenly."""
    side = np.arange(1, len(curves.length))
    one, two, _ = curves.frames(side, collars.begin[1:], 0.5 * exits.radius[1:])
    up = exits.host_along[1:]
    base = np.arctan2(np.sum(up * two, axis=1), np.sum(up * one, axis=1))
    thick = exits.radius[units.owner] >= _ANCHOR * exits.host_radius[units.owner]
    on = np.concatenate([[0], side, np.repeat(units.host[thick], 2)])
    at = np.concatenate([[-1.0], collars.begin[1:], np.stack([units.start, units.end], 1)[thick].ravel()])
    angle = np.concatenate([[np.nan], base, np.repeat(units.angle[thick], 2)])
    order = np.lexsort((at, on))
    on, at, angle = on[order], at[order], angle[order]
    # Branch 0 has no base to follow: it begins as its first unit wants.
    lonely = len(on) < 2 or on[1] != 0
    angle[0] = 0.0 if lonely else angle[1]
    quarter = 0.5 * np.pi
    step = np.diff(angle, prepend=angle[0])
    nearest = np.mod(step + 0.5 * quarter, quarter) - 0.5 * quarter
    first = np.concatenate(([True], on[1:] != on[:-1]))
    total = np.cumsum(np.where(first, 0.0, nearest))
    begin = np.flatnonzero(first)
    branch = np.cumsum(first) - 1
    whole = total - total[begin][branch] + angle[begin][branch]

    place = curves.offset[chain] + arc
    mark = curves.offset[on] + at
    after = np.searchsorted(mark, place)
    below = np.clip(after - 1, begin[chain], None)
    above = np.minimum(after, len(on) - 1)
    above = np.where(on[above] == chain, above, below)
    span = mark[above] - mark[below]
    share = np.clip(np.divide(place - mark[below], span, out=np.zeros(len(place)), where=span > 0), 0.0, 1.0)
    turned: Floats = whole[below] + share * (whole[above] - whole[below])
    return turned
