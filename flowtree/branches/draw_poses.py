"""Poses that a spray of thin branches may take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from scipy.special import ndtri

from flowtree.branches.look_up_density import look_up_density
from flowtree.geometry.place_chance import place_chance
from flowtree.model.volume import DensityVolume

_DRAWN = 4  # times as many as are kept
_SHORTEST, _LONGEST = 0.7, 1.25  # factors to the length
_SLIMMEST = 0.7  # factor to the radius
_USUAL = 0.75  # quantile of the density beyond which denser is no better
_STREAMS = 8  # random numbers of a pose


@dataclass(frozen=True)
class Poses:
    """What each of m sprays may become; the first pose leaves it as it is.

    Attributes:
        turn: (m, poses, 3, 3) rotations about the fork, times stretches.
        slim: (m, poses) factors to the radius.
    """

    turn: NDArray[np.float64]
    slim: NDArray[np.float64]


def draw_poses(
    arm: NDArray[np.float64],
    first: NDArray[np.int64],
    pivot: NDArray[np.float64],
    code: NDArray[np.int64],
    *,
    count: int,
    spread: float,
    volume: DensityVolume,
    seed: int,
) -> Poses:
    """Draws poses at random and keeps those in which a spray lies in the densest voxels.

    Two mattes alone leave much room for poses that look right from where they were taken and wrong from
    elsewhere; the volume knows where the tree is likely to be.

    Args:
        arm: (k, 3) from the fork to each node of the sprays, one spray's after the other's [m].
        first: (m,) where each spray's nodes begin.
        pivot: (m, 3) the forks [m].
        code: (m,) of the sprays, for their random numbers.
        count: of the poses.
        spread: standard deviation of the turn about each axis [degrees].
        volume: the densities.
        seed: of the draws.
    """
    sprays, drawn = len(first), _DRAWN * count
    number = np.tile(np.arange(1, drawn) * _STREAMS, sprays)
    each = np.repeat(code, drawn - 1)
    draw = [place_chance(each, seed, number + k) for k in range(5)]
    angles = np.radians(spread) * ndtri(np.clip(np.stack(draw[:3], axis=1), 1e-9, 1 - 1e-9))
    stretch = _SHORTEST + (_LONGEST - _SHORTEST) * draw[3]
    drawn_turns = (Rotation.from_rotvec(angles).as_matrix() * stretch[:, None, None]).reshape(
        sprays, -1, 3, 3
    )
    turn = np.concatenate([np.broadcast_to(np.eye(3), (sprays, 1, 3, 3)), drawn_turns], axis=1)
    slim = 1.0 - (1.0 - _SLIMMEST) * draw[4].reshape(sprays, -1)
    slim = np.concatenate([np.ones((sprays, 1)), slim], axis=1)
    size = np.diff(np.append(first, len(arm)))
    spray = np.repeat(np.arange(sprays), size)
    dense = _usual_density(volume)
    inside = np.empty((sprays, drawn))
    for pose in range(drawn):
        place = np.einsum("nij,nj->ni", turn[spray, pose], arm) + pivot[spray]
        share = np.minimum(look_up_density(place, volume) / dense, 1.0)
        inside[:, pose] = np.add.reduceat(share, first) / size
    inside[:, 0] = np.inf
    best = np.argsort(-inside, axis=1, kind="stable")[:, :count]
    rows = np.arange(sprays)[:, None]
    return Poses(turn[rows, best], slim[rows, best])


def _usual_density(volume: DensityVolume) -> float:
    """Rounded to a power of two: a bit of paint must not change the poses of all the tree."""
    filled = volume.density[volume.density > 0]
    return float(np.exp2(np.rint(np.log2(np.quantile(filled, _USUAL))))) if len(filled) else 1.0
