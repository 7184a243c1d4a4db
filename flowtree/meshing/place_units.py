"""Where along their branches the ramification units stand, once they have pushed each other apart."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.branch_curves import BranchCurves
from flowtree.meshing.calibrate_units import calibrate_units
from flowtree.meshing.classify_ramifications import CONNECTABLE, Ramifications
from flowtree.meshing.find_exits import Exits

_TOO_MUCH = 1.2  # the paper's T_add, of RU + RC
_SHIFT = 5.0  # host radii that a unit may be pushed along its host to find room
_SHIFT_PASTED = 0.7  # the same where it could be pasted instead


@dataclass(frozen=True)
class Collars:
    """How branches begin and end: (c,) arcs of each branch [m].

    Where ``second`` equals ``first`` there is one ring for both.

    Attributes:
        begin: where it leaves its host; 0 for branch 0.
        first: a ring soon after.
        second: a ring by which the branch runs as its axis does.
        tip: a ring close to the last, which keeps the tip as thick as it should be.
        end: the last ring.
    """

    begin: Floats
    first: Floats
    second: Floats
    tip: Floats
    end: Floats


@dataclass(frozen=True)
class Units:
    """One entry a unit, ordered by host and then along it.

    Attributes:
        owner: the branch that the unit was made for.
        host: the branch that it is a part of.
        start: [m], arc of its start boundary on the host.
        end: [m], arc of its end boundary.
        angle: of its main face in the host's frame [radians].
    """

    owner: Ints
    host: Ints
    start: Floats
    end: Floats
    angle: Floats


def shape_collars(curves: BranchCurves, exits: Exits, birth: Ints, last: int) -> Collars:
    """The first rings of every branch: near its host, to make the corner round, but clear of it."""
    radius, begin = exits.radius, exits.begin.copy()
    begin[0] = 0.0
    room = np.maximum(curves.length - begin, 1.5 * radius)
    sine = np.sqrt(np.maximum(1.0 - exits.lean**2, 0.01))
    clear = np.clip(0.4 + 0.6 * exits.lean / sine, 0.9, 2.5) * radius
    both = birth < last
    first = np.where(both, np.minimum(clear, 0.3 * room), np.minimum(1.2 * clear, 0.4 * room))
    second = np.where(both, np.minimum(clear + 1.4 * radius, 0.6 * room), first)
    first[0] = second[0] = 0.0
    thin = curves.at(np.arange(len(begin)), curves.length)[1]
    tip = begin + room - np.minimum(0.6 * thin, 0.2 * room)
    return Collars(begin, begin + first, begin + second, tip, begin + room + 0.3 * thin)


def place_units(
    curves: BranchCurves, exits: Exits, made: Ramifications, collars: Collars, *, subdivisions: int
) -> tuple[Ramifications, Units]:
    """Gives every unit its stretch of its host, or takes it away from those that find none.

    Units stand where their branches come out, in that order; where two overlap at their least length the
    upper one is pushed on, and where that is too far the thinner branch loses its unit. Then neighbours
    share the gap between them (`calibrate_units`); of those that crowd each other still the thinner loses
    its unit too, if it can be pasted instead.
    """
    owner = np.flatnonzero((made.unit == np.arange(len(made.unit))) & (made.kind == CONNECTABLE))
    owner = owner[np.lexsort((owner, made.middle[owner], curves.host[owner]))]
    pasted = made.birth[owner] + 1 < subdivisions
    reach = np.where(pasted, _SHIFT_PASTED, _SHIFT) * exits.host_radius[owner]
    host = curves.host[owner]
    low = np.where(host == 0, 0.3 * exits.host_radius[owner], collars.second[host])
    kept, middle = _stack(
        host, made.middle[owner], made.short[owner], exits.radius[owner], reach, low, collars.tip[host]
    )
    made = replace(made, middle=made.middle.copy())
    made.middle[owner[kept]] = middle
    rows = owner[kept]

    before, after, crowd = _calibrate(curves, exits, made, rows)
    thinner = np.where(exits.radius[rows[:-1]] < exits.radius[rows[1:]], rows[:-1], rows[1:])
    loser = np.unique(thinner[(crowd > _TOO_MUCH) & (made.birth[thinner] + 1 < subdivisions)])
    rows = rows[~np.isin(rows, loser)]
    before, after, _ = _calibrate(curves, exits, made, rows)
    on = curves.host[rows]
    base = np.where(on == 0, 0.3 * exits.host_radius[rows], collars.second[on])
    start = np.maximum(made.middle[rows] - before, base)
    end = np.minimum(made.middle[rows] + after, collars.tip[on])
    # Close to the tip the boundary before it is the last.
    end = np.where(collars.tip[on] - end < 0.2 * made.short[rows], collars.tip[on], end)
    # Boundaries that all but touch are one, as are one and the ring by which its host begins.
    after_unit = np.concatenate(([False], on[1:] == on[:-1]))
    floor = np.where(after_unit, np.roll(end, 1), np.where(on == 0, -np.inf, base))
    start = np.where(start - floor < 0.2 * made.short[rows], floor, start)
    units = Units(rows, on, start, end, made.angle[rows])
    return _without(made, rows, subdivisions), units


def _without(made: Ramifications, owners: Ints, subdivisions: int) -> Ramifications:
    """The ramifications, where those of a unit that is none of these (u,) have lost it."""
    lost = np.flatnonzero((made.unit >= 0) & ~np.isin(made.unit, owners))
    return made.but(lost, subdivisions)


def _stack(
    host: Ints, middle: Floats, short: Floats, radius: Floats, reach: Floats, low: Floats, high: Floats
) -> tuple[Ints, Floats]:
    """Which units (n,) stay, ordered, and the middles of those that do: a pass along each branch."""
    kept: list[int] = []
    places: list[float] = []
    columns = zip(*(a.tolist() for a in (host, middle, short, radius, reach, low, high)), strict=True)
    size, thickness, branch = short.tolist(), radius.tolist(), host.tolist()
    for row, (on, wanted, half, thick, push, lowest, highest) in enumerate(columns):
        while True:
            floor = lowest
            if kept and branch[kept[-1]] == on:
                floor = places[-1] + size[kept[-1]]
            place = min(max(wanted, floor + half), highest - half)
            fits = place - half >= floor and abs(place - wanted) <= push
            if fits or not kept or branch[kept[-1]] != on or thickness[kept[-1]] >= thick:
                break
            kept.pop()
            places.pop()
        if fits:
            kept.append(row)
            places.append(place)
    return np.array(kept, np.int64), np.array(places)


def _calibrate(
    curves: BranchCurves, exits: Exits, made: Ramifications, rows: Ints
) -> tuple[Floats, Floats, Floats]:
    """From the middle to the start and to the end boundary (u,), and RU + RC of neighbours (u - 1,)."""
    long, short = made.long[rows], made.short[rows]
    before, after = long.copy(), long.copy()
    same = curves.host[rows[1:]] == curves.host[rows[:-1]]
    gap = np.diff(made.middle[rows]) - long[1:] - long[:-1]
    turn = np.diff(made.angle[rows])
    twist = np.abs(np.mod(turn + 0.25 * np.pi, 0.5 * np.pi) - 0.25 * np.pi)
    width = np.maximum(exits.host_radius[rows[1:]], exits.host_radius[rows[:-1]])
    ends, starts, total = calibrate_units(
        gap, twist, (long[:-1], long[1:]), (short[:-1], short[1:]), 2.0 * width
    )
    after[:-1] -= np.where(same, ends, 0.0)
    before[1:] -= np.where(same, starts, 0.0)
    return before, after, np.where(same, total, 0.0)
