"""The round tree that the views show on the average: what is likely where they say nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.density.guess_depths import guess_depths
from flowtree.geometry.projection import view_axes

_SMOOTH = 0.125  # of the height: standard deviation over which heights share their profile
_KNOTS = 3  # heights per standard deviation at which profiles are computed; between them they are linear
_ROUNDS = 10  # of the inversion: more turn noise near the axis into rings
_STEADY = 0.01  # pull of the axis to the foot's: matters only where all views look the same way
_FLOOR = 1e-6  # of a profile's largest value: nothing is impossible

_Doubles = NDArray[np.float64]
_Known = NDArray[np.bool_]


@dataclass(frozen=True)
class RoundSlices:
    """A stack of slices that are round about an axis; lengths in voxels, from the box's axis.

    Attributes:
        place: (voxels, 2), (x, z) of the voxels' centres in any slice.
        axis: (rows, 2), (x, z) where each slice's axis stands.
        profile: (rows, radii), depth of a voxel at 0.5, 1.5, … from the axis; above 0.
    """

    place: _Doubles
    axis: _Doubles
    profile: _Doubles


def fill_box(prior: RoundSlices, side: int) -> NDArray[np.float32]:
    """The slices as a box (side, rows, side) of voxels, the depth of each; beyond a profile its last."""
    rows = len(prior.profile)
    box = np.empty((side, rows, side), np.float32)
    rings = np.arange(prior.profile.shape[1]) + 0.5
    for row in range(rows):
        far = np.linalg.norm(prior.place - prior.axis[row], axis=1)
        box[:, row] = np.interp(far, rings, prior.profile[row]).reshape(side, side)
    return box


def round_slices(
    depths: Sequence[_Doubles], known: Sequence[_Known], yaws: Sequence[float], centres: _Doubles
) -> RoundSlices:
    """Finds for every height the round slice that looks, seen from the side, as the views do on the average.

    Seen from the side a round slice of profile f(r) has at the distance s from its axis the depth
    ``2 ∫ f(r) r dr / sqrt(r² - s²)`` (Abel's transform), the same in every view. Its inverse is found by
    Richardson's and Lucy's iteration, which keeps f above 0, from the mean of both sides of all views.
    Neighbouring heights share what they see, as a Gaussian of an eighth of the height weighs it: the branches
    of one height are chance, how far and how densely they reach out is the habit of the tree.

    The axis stands where half of the depth is to either side, smoothed alike: it follows a leaning stem.

    Args:
        depths: one a view, (columns, rows), columns about the box's axis, a voxel's edge wide.
        known: one a view, (columns, rows), which of them count.
        yaws: theirs [degrees].
        centres: (side,) of the voxels along x and along z [voxels].

    Returns: the slices; where no view knows anything for a long way the profile is even.
    """
    columns, rows = depths[0].shape
    smooth = _smoothing(rows)
    filled = [guess_depths(depth, sure) for depth, sure in zip(depths, known, strict=True)]
    places = (np.arange(columns) + 0.5) - columns / 2
    # In a view the axis is where half of the depth is to either side.
    middles = [_median(depth @ smooth.T, places) for depth in filled]
    rights = np.array([view_axes(yaw)[0][[0, 2]] for yaw in yaws])
    axis = np.linalg.solve(rights.T @ rights + _STEADY * np.eye(2), rights.T @ np.array(middles)).T
    axis = np.clip(axis, centres[0], centres[-1])  # views from almost one side may cross anywhere
    radii = columns // 2 + 1
    total, count = np.zeros((rows, radii)), np.zeros((rows, radii))
    for depth, sure, right in zip(depths, known, rights, strict=True):
        away = np.clip(np.abs(places[None] - (axis @ right)[:, None]) - 0.5, 0.0, radii - 1.001)
        ring = away.astype(int)
        share = away - ring
        flat = np.arange(rows)[:, None] * radii + ring
        for at, weight in ((flat, 1.0 - share), (flat + 1, share)):
            weight = weight * sure.T
            total += np.bincount(at.ravel(), (weight * depth.T).ravel(), total.size).reshape(total.shape)
            count += np.bincount(at.ravel(), weight.ravel(), total.size).reshape(total.shape)
    knots = max(2, min(rows, int(np.ceil(_KNOTS / _SMOOTH))))
    at = np.linspace(0, rows - 1, knots).round().astype(int)
    seen = np.divide(smooth[at] @ total, np.maximum(smooth[at] @ count, 1e-9))
    profile = _invert(seen)
    profile += _FLOOR * np.maximum(profile.max(axis=1, keepdims=True), 1e-9)
    between = np.clip(np.searchsorted(at, np.arange(rows), side="right") - 1, 0, knots - 2)
    share = ((np.arange(rows) - at[between]) / np.maximum(at[between + 1] - at[between], 1))[:, None]
    x, z = np.meshgrid(centres, centres, indexing="ij")
    return RoundSlices(
        place=np.stack([x.ravel(), z.ravel()], axis=1),
        axis=axis,
        profile=(1.0 - share) * profile[between] + share * profile[between + 1],
    )


def _smoothing(rows: int) -> _Doubles:
    """(rows, rows) weights of all heights for each; a height's sum to 1."""
    apart = np.subtract.outer(np.arange(rows), np.arange(rows)) / max(_SMOOTH * rows, 1e-9)
    weight = np.exp(-0.5 * apart**2)
    return np.asarray(weight / weight.sum(axis=1, keepdims=True))


def _median(depth: _Doubles, places: _Doubles) -> _Doubles:
    """(rows,) where half of each row's depth (columns, rows) is to either side, to a fraction of a column."""
    total = depth.sum(axis=0)
    below = np.cumsum(depth, axis=0)
    at = np.minimum((below < 0.5 * total).sum(axis=0), len(depth) - 1)
    own = np.take_along_axis(depth, at[None], 0)[0]
    before = np.take_along_axis(below, at[None], 0)[0] - own
    share = np.divide(0.5 * total - before, own, out=np.full_like(own, 0.5), where=own > 1e-12)
    return np.where(total > 1e-9, places[at] - 0.5 + np.clip(share, 0.0, 1.0), 0.0)


def _invert(seen: _Doubles) -> _Doubles:
    """Profiles (knots, radii) that look as ``seen`` (knots, radii) from the side."""
    radii = seen.shape[1]
    inner = np.zeros((radii, radii))
    samples = 8  # across a column
    for k in range(samples):
        away = np.arange(radii) + (k + 0.5) / samples
        reach = np.sqrt(np.maximum(np.arange(radii + 1) ** 2 - away[:, None] ** 2, 0.0))
        inner += 2.0 / samples * np.diff(reach, axis=1)
    length = inner.astype(np.float32)  # (columns, rings) of the way through each ring
    norm = length.sum(axis=0)
    wanted = seen.astype(np.float32)
    profile = np.ones_like(wanted)
    for _ in range(_ROUNDS):
        profile *= (wanted / np.maximum(profile @ length.T, 1e-12)) @ length / norm
    return profile.astype(np.float64)
