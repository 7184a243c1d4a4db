"""Corrects where the tree stands in its photographs until all of them can show one tree."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree.density.fit_sights import fit_sights
from flowtree.density.project_sights import project_sights
from flowtree.density.round_slices import fill_box, round_slices
from flowtree.device import pick_device
from flowtree.geometry.footprint_means import optical_depth
from flowtree.model.matte import Matte
from flowtree.model.placement import Estimate, Placement
from flowtree.photos.level_picture import pixel_centres
from flowtree.photos.straighten_lines import move_places

_ROWS = 48  # voxels along the height
_ABOVE = 1.2  # tree heights that pictures show: near boughs stand above the top
_FINE = 3  # samples along a cell's side
_LEAST = 0.01  # alpha of what may hold a tree
_SMOOTH = 0.75  # cells: what is that near counts as the same place
_BLOCKS = 30.0  # places of a crown, clumps and whorls, that differ independently
_ROUNDS = 2
#: What is corrected: the first step, and how far off it usually is, where nobody knows better: one standard
#: deviation. Foot and top in tree heights, angles in degrees.
_USUAL = {"foot": (0.015, 0.02), "top": (0.03, 0.04), "roll": (1.0, 2.0), "yaw": (5.0, 8.0)}
_NEED_THREE = ("yaw",)  # two views at a right angle fit each other whatever the angle is

_Turns = dict[tuple[int, str], float]


def register_views(
    mattes: Sequence[Matte], placements: Sequence[Placement], *, height: float, device: str | None = None
) -> tuple[Placement, ...]:
    """Moves foot, top and roll of each view, and with three views or more its yaw, to where all views agree.

    Photographs of one tree can all be shown by one density, and those that are placed wrongly cannot: what
    `fit_sights` leaves of their optical depths says how far they are from that. With four known trees and
    their exact mattes it grew by 4 to 49 % where one view was scaled by 3 %, by 14 to 110 % for 6 %, and by
    0 to 40 % for a roll of 2 degrees. The likeliest placement has the least of ``30 ln(what is left)`` plus
    half the squares of all corrections over their usual sizes; each correction in turn goes to the lowest
    point of the parabola through three trials. Nothing tells how large the tree is in all views together, so
    what is common to them stays nearly as it is.

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
        _correct(
            placement, {name: (turns[v, name], narrow[v, name]) for v, name in turns if v == view}, height
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
        foot, top = _ends(placement, height)
        deviation /= abs(foot[1] - top[1])
    return max(deviation, usual)


def _ends(placement: Placement, height: float) -> NDArray[np.float64]:
    """Foot and top (2, 2) [pixels of the photograph]."""
    camera = placement.camera
    ends = np.array([camera.foot, (camera.foot[0], camera.foot[1] - height / camera.metres_per_pixel)])
    return ends if placement.warp is None else move_places(placement.warp, ends)


def _adjust(turns: dict[str, float], height: float) -> NDArray[np.float64]:
    """(3, 3) from a corrected view's plane [m] to the plane that it was taken for."""
    foot, top = turns.get("foot", 0.0), turns.get("top", 0.0)
    scale, angle = 1.0 + top - foot, math.radians(turns.get("roll", 0.0))
    sine, cosine = scale * math.sin(angle), scale * math.cos(angle)
    return np.array([[cosine, sine, 0.0], [-sine, cosine, foot * height], [0.0, 0.0, 1.0]])


def _plane_to_pixels(placement: Placement) -> NDArray[np.float64]:
    """(3, 3) from the plane of a view [m] to the pixels of its straightened picture."""
    camera = placement.camera
    per = 1.0 / camera.metres_per_pixel
    return np.array([[per, 0.0, camera.foot[0]], [0.0, -per, camera.foot[1]], [0.0, 0.0, 1.0]])


def _correct(placement: Placement, turns: dict[str, tuple[float, float]], height: float) -> Placement:
    """The placement with corrections (value, deviation) by name."""
    if not any(value for value, _ in turns.values()):
        return placement
    plain = {name: value for name, (value, _) in turns.items()}
    to_pixels = _plane_to_pixels(placement)
    old = np.eye(3) if placement.warp is None else placement.warp
    warp = old @ to_pixels @ _adjust(plain, height) @ np.linalg.inv(to_pixels)
    yaw = placement.camera.yaw + plain.get("yaw", 0.0)
    corrected = replace(placement, warp=warp, camera=replace(placement.camera, yaw=yaw))
    foot, top = _ends(corrected, height)
    tall = float(abs(foot[1] - top[1]))
    rolled = next((e.value for e in placement.estimates if e.name == "roll"), 0.0)
    values = {
        "foot": (float(foot[1]), "pixels", tall),
        "top": (float(top[1]), "pixels", tall),
        "roll": (rolled + plain.get("roll", 0.0), "degrees", 1.0),
        "yaw": (yaw, "degrees", 1.0),
    }
    found = {
        name: Estimate(name, values[name][0], values[name][1], "estimated", values[name][2] * spread)
        for name, (_, spread) in turns.items()
    }
    kept = tuple(found.pop(estimate.name, estimate) for estimate in placement.estimates)
    return replace(corrected, estimates=(*kept, *found.values()))


@dataclass(frozen=True)
class _Picture:
    """A matte, shrunk until a pixel is about as large as a sample.

    Attributes:
        alpha: (h, w).
        known: (h, w) in 0..1; outside of it is 0 where the tree leaves the frame.
        shrink: pixels of the photograph in one of it, along x and y.
        outside: what is known beyond the frame.
    """

    alpha: NDArray[np.float32]
    known: NDArray[np.float32]
    shrink: tuple[float, float]
    outside: float


class _Trial:
    """Pictures of the views under corrections, and how badly they fit together."""

    def __init__(
        self, mattes: Sequence[Matte], placements: Sequence[Placement], height: float, device: str
    ) -> None:
        self._placements, self._height, self._device = placements, height, device
        self._cell = height / _ROWS
        self._rows = math.ceil(_ABOVE * _ROWS)
        self._pictures = [
            _shrink(matte, placement, self._cell / _FINE)
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
        depths, known = [depth for depth, _ in seen], [sure for _, sure in seen]
        centres = np.arange(self._side) + 0.5 - self._side / 2
        prior = round_slices(depths, known, [sight.yaw for sight in sights], np.asarray(centres, np.float64))
        left = -self._half * self._cell
        fitted = fit_sights(
            depths,
            known,
            sights,
            start=fill_box(prior, self._side)[:, : _ROWS + 1],
            left=left,
            cell=self._cell,
            least=_LEAST,
            device=self._device,
        )
        shown = project_sights(
            fitted,
            sights,
            left=left,
            cell=self._cell,
            columns=2 * self._half,
            rows=self._rows,
            device=self._device,
            looked_at=np.stack(known),
        )
        rest = total = 0.0
        for depth, sure, other in zip(depths, known, shown, strict=True):
            wanted, made = (
                cv2.GaussianBlur((picture * sure).astype(np.float32), (0, 0), _SMOOTH)
                for picture in (depth, other)
            )
            rest += float(np.abs(wanted - made).sum(dtype=np.float64))
            total += float(wanted.sum(dtype=np.float64))
        before = sum((value / usual[key]) ** 2 / 2.0 for key, value in turns.items())
        return _BLOCKS * math.log(max(rest, 1e-9) / max(total, 1e-9)) + before

    def _look(self, view: int, turns: dict[str, float]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Optical depth (columns, rows) of a view's plane, row 0 on the ground, and where it is known."""
        key = (view, tuple(turns.get(name, 0.0) for name in ("foot", "top", "roll")))
        if key not in self._kept:
            placement, picture = self._placements[view], self._pictures[view]
            sample = self._cell / _FINE
            columns, rows = 2 * self._half * _FINE, self._rows * _FINE
            to_plane = np.array(
                [[sample, 0.0, -self._half * self._cell], [0.0, -sample, rows * sample], [0.0, 0.0, 1.0]]
            )
            to_photo = np.eye(3) if placement.warp is None else placement.warp
            matrix = to_photo @ _plane_to_pixels(placement) @ _adjust(turns, self._height) @ to_plane
            matrix = np.diag([1.0 / picture.shrink[0], 1.0 / picture.shrink[1], 1.0]) @ matrix
            flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
            alpha, known = (
                cv2.warpPerspective(
                    values,
                    pixel_centres(matrix),
                    (columns, rows),
                    flags=flags,
                    borderMode=cv2.BORDER_CONSTANT,
                    borderValue=beyond,
                )
                .reshape(self._rows, _FINE, -1, _FINE)
                .mean(axis=(1, 3))[::-1]
                .T
                for values, beyond in ((picture.alpha, 0.0), (picture.known, picture.outside))
            )
            self._kept[key] = optical_depth(alpha.astype(np.float64)), known > 0.99
        return self._kept[key]


def _shrink(matte: Matte, placement: Placement, sample: float) -> _Picture:
    rows, columns = matte.alpha.shape
    # Pixels of the photograph in a sample, at the foot.
    step = _plane_to_pixels(placement) @ np.array([[0.0, sample], [0.0, 0.0], [1.0, 1.0]])
    ends = step[:2].T if placement.warp is None else move_places(placement.warp, step[:2].T)
    ratio = max(1.0, float(np.linalg.norm(ends[1] - ends[0])))
    size = (max(1, round(columns / ratio)), max(1, round(rows / ratio)))
    known = np.ones_like(matte.alpha) if matte.unknown is None else (~matte.unknown).astype(np.float32)
    alpha, sure = (
        np.asarray(cv2.resize(values, size, interpolation=cv2.INTER_AREA), np.float32)
        for values in (matte.alpha, known)
    )
    return _Picture(alpha, sure, (columns / size[0], rows / size[1]), 0.0 if placement.missing else 1.0)
