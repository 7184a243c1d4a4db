"""Corrects where the tree stands in its photographs until all of them can show one tree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.density.rate_sights import rate_sights
from flowtree.device import pick_device
from flowtree.model.matte import Matte
from flowtree.model.placement import Placement
from flowtree.photos.adjust_placement import adjust_placement, view_ends
from flowtree.photos.look_at_plane import look_at_plane, shrink_matte

_ROWS = 48  # voxels along the height
_ABOVE = 1.2  # tree heights that pictures show: near boughs stand above the top
_LEAST = 0.01  # optical depth of what may be the tree
_BLOCKS = 12.0  # places of a crown, clumps and whorls, that differ independently
_ROUNDS = 2
#: What is corrected: the first step, and how far off it usually is, where nobody knows better: one standard
#: deviation. Foot and top in tree heights, angles in degrees.
_USUAL = {"foot": (0.008, 0.01), "top": (0.03, 0.04), "roll": (1.0, 2.0), "yaw": (5.0, 8.0)}
_NEED_THREE = ("roll", "yaw")  # two views at a right angle fit each other whatever the angle is

_Turns = dict[tuple[int, str], float]


def register_views(
    mattes: Sequence[Matte], placements: Sequence[Placement], *, height: float, device: str | None = None
) -> tuple[Placement, ...]:
    """Moves foot and top of each view, and with three views or more roll and yaw, to where all views agree.

    Photographs of one tree can all be shown by one density, and those that are placed wrongly cannot: what
    `fit_sights` leaves of their optical depths says how far they are from that. With four known trees and
    their exact mattes it grew by 4 to 49 % where one view was scaled by 3 %, by 14 to 110 % for 6 %, and by
    0 to 40 % for a roll of 2 degrees. The likeliest placement has the least of ``12 ln(what is left)`` plus
    half the squares of all corrections over their usual sizes; each correction in turn goes to the lowest
    point of the parabola through three trials. Nothing tells how large the tree is in all views together, so
    what is common to them stays nearly as it is; and two views hardly tell how they are rolled or turned.
    From two loose photographs each of four known trees, with distances of 1.7 to 2 heights assumed, the
    volume had a mean soft IoU of 0.608 unregistered, 0.610 registered, 0.609 where 12 is 30, and 0.607 where
    the rolls are corrected, too.

    Args:
        mattes: of the photographs.
        placements: theirs; only what is ``open`` in them is corrected.
        height: of the tree [m].
        device: to run on; None takes the best there is.

    Returns: the placements, corrected; those of which nothing is open as they are.
    """
    turns: _Turns = {
        (view, name): 0.0
        for view, placement in enumerate(placements)
        for name in placement.open
        if name not in _NEED_THREE or (len(placements) > 2 and view > 0)
    }
    if not turns or len(placements) < 2:
        return tuple(placements)
    trial = _Trial(mattes, placements, height, pick_device(device))
    usual = {key: _deviation(placements[key[0]], key[1], height) for key in turns}
    narrow: _Turns = {}
    best = trial.unlikelihood(turns, usual)
    for number in range(_ROUNDS):
        for key in turns:
            step = _USUAL[key[1]][0] / 2**number
            here = turns[key]
            cost = {0: best}
            for side in (-1, 1):
                cost[side] = trial.unlikelihood({**turns, key: here + side * step}, usual)
            bend = cost[-1] + cost[1] - 2.0 * cost[0]
            slope = (cost[1] - cost[-1]) / 2.0
            shift = -slope / bend if bend > 0.0 else 0.0
            if abs(shift) > 1.0 or bend <= 0.0:
                shift = float(min(cost, key=lambda side: (cost[side], abs(side))))
            found = trial.unlikelihood({**turns, key: here + shift * step}, usual)
            nearest = min((found, shift), *((value, float(side)) for side, value in cost.items()))
            best, turns[key] = nearest[0], here + nearest[1] * step
            narrow[key] = step / math.sqrt(bend) if bend > 0.0 else usual[key]
    return tuple(
        adjust_placement(
            placement,
            {name: (turns[v, name], narrow[v, name]) for v, name in turns if v == view},
            height=height,
        )
        for view, placement in enumerate(placements)
    )


def _deviation(placement: Placement, name: str, height: float) -> float:
    """How far off an estimate may be, one standard deviation, in the units of `_USUAL`."""
    known = [estimate.deviation for estimate in placement.estimates if estimate.name == name]
    usual = _USUAL[name][1]
    if not known or not known[0]:
        return usual
    deviation = known[0]
    if name in ("foot", "top"):  # [pixels] of the photograph
        foot, top = view_ends(placement, height)
        deviation /= abs(foot[1] - top[1])
    return max(deviation, usual)


class _Trial:
    """Pictures of the views under corrections, and how badly they fit together."""

    def __init__(
        self, mattes: Sequence[Matte], placements: Sequence[Placement], height: float, device: str
    ) -> None:
        self._placements, self._height, self._device = placements, height, device
        self._cell = height / _ROWS
        self._rows = math.ceil(_ABOVE * _ROWS)
        self._pictures = [
            shrink_matte(matte, placement, self._cell)
            for matte, placement in zip(mattes, placements, strict=True)
        ]
        self._kept: dict[tuple[int, tuple[float, ...]], tuple[NDArray[np.float64], NDArray[np.bool_]]] = {}
        self._half = 2 * _ROWS
        seen = [self._look(view, {}) for view in range(len(placements))]
        wide = np.any([(depth > _LEAST).any(axis=1) for depth, _ in seen], axis=0)
        away = np.abs(np.flatnonzero(wide) + 0.5 - self._half)
        self._side = 2 * (min(math.ceil(float(away.max(initial=2.0))), int(1.2 * _ROWS)) + 2)
        self._half = math.ceil(self._side / math.sqrt(2.0)) + 1
        self._kept.clear()

    def unlikelihood(self, turns: _Turns, usual: _Turns) -> float:
        """Minus the logarithm of how likely corrections are, but for a constant."""
        views = range(len(self._placements))
        each = [{name: value for (v, name), value in turns.items() if v == view} for view in views]
        seen = [self._look(view, each[view]) for view in views]
        sights = [
            replace(placement.camera, yaw=placement.camera.yaw + own.get("yaw", 0.0))
            for placement, own in zip(self._placements, each, strict=True)
        ]
        rest = rate_sights(
            [depth for depth, _ in seen],
            [sure for _, sure in seen],
            sights,
            side=self._side,
            height=_ROWS + 1,
            left=-self._half * self._cell,
            cell=self._cell,
            device=self._device,
        )
        before = sum((value / usual[key]) ** 2 / 2.0 for key, value in turns.items())
        return _BLOCKS * math.log(max(rest, 1e-9)) + before

    def _look(self, view: int, turns: dict[str, float]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Optical depth (columns, rows) of a view's plane, row 0 on the ground, and where it is known."""
        key = (view, tuple(turns.get(name, 0.0) for name in ("foot", "top", "roll")))
        if key not in self._kept:
            self._kept[key] = look_at_plane(
                self._pictures[view],
                self._placements[view],
                turns,
                height=self._height,
                cell=self._cell,
                half=self._half,
                rows=self._rows,
            )
        return self._kept[key]
