"""Where the particles start (Particle Flows, section 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.morton import morton_code
from flowtree.geometry.place_chance import place_chance, place_words
from flowtree.model.volume import DensityVolume

_RANGE = 1 << 13  # voxels along a side after which their numbers repeat; no volume is so large
_LEVELS = 8  # octants of octants: beyond 256 voxels chance alone spreads them well enough
_SPARE = 2.0  # roots of their number: by how many particles a guess may miss

_Doubles = NDArray[np.float64]


def seed_particles(volume: DensityVolume, count: int, *, seed: int = 0) -> NDArray[np.float32]:
    """Random places in the voxels, in proportion to their density, that stay where the density stays.

    Unlike the paper's independent draws, every voxel has its own threshold, whatever is in the others: a
    voxel that should hold e particles gets floor(e + t) of them, t its threshold in 0..1. Whoever adds
    density in one place, or takes it away, moves no particle elsewhere, but for the few that are too many or
    too few for the given number.

    The thresholds of eight neighbours are spread evenly, those of eight such blocks fill the gaps, and so on
    (a radical inverse of the voxels' octants, scrambled at random as Owen, 1995, does): every place keeps its
    probability, but particles neither clump nor leave gaps.

    Args:
        volume: that holds density.
        count: particles.
        seed: of the draws.

    Returns: (count, 3) float32 [m], along a space-filling (Morton) curve.
    """
    filled = np.argwhere(volume.density > 0)
    # Counted from the axis, a voxel keeps its number in a box that has become wider.
    axis = np.array([1.0, 0.0, 1.0]) * np.rint(np.asarray(volume.origin, np.float64) / volume.voxel)
    code = morton_code((filled + axis.astype(np.int64)) % _RANGE)
    order = np.argsort(code, kind="stable")
    filled, code = filled[order], code[order]
    share = volume.density[tuple(filled.T)].astype(np.float64)
    voxel, number = _draw(share / share.sum(), _thresholds(code, seed), count)
    place = np.stack([place_chance(code[voxel], seed, 1 + 3 * number + k) for k in range(3)], axis=1)
    return np.asarray(volume.origin + (filled[voxel] + place) * float(volume.voxel), np.float32)


def _draw(share: _Doubles, threshold: _Doubles, count: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The voxel of each of ``count`` particles, growing, and the particle's number in it.

    With a share s of all, voxel i gets its k-th particle when the total reaches (k + 1 - t_i) / s_i.
    """
    step = 1.0 + _SPARE / np.sqrt(count)
    low, high = float(count), float(count)
    while np.floor(low * share + threshold).sum() > count:
        low /= step
    while np.floor(high * share + threshold).sum() < count:
        high *= step
    sure = np.floor(low * share + threshold).astype(np.int64)
    more = np.floor(high * share + threshold).astype(np.int64) - sure
    late = np.repeat(np.arange(len(share)), more)
    number = np.arange(len(late)) - np.repeat(np.cumsum(more) - more, more)
    due = (sure[late] + number + 1 - threshold[late]) / share[late]
    taken = np.argsort(due, kind="stable")[: count - int(sure.sum())]
    held = sure + np.bincount(late[taken], minlength=len(share))
    voxel = np.repeat(np.arange(len(share)), held)
    return voxel, np.arange(count) - np.repeat(np.cumsum(held) - held, held)


def _thresholds(code: NDArray[np.int64], seed: int) -> _Doubles:
    """(n,) in 0..1: the finest octant counts most, shuffled otherwise in each block of eight."""
    threshold = np.zeros(len(code))
    for level in range(_LEVELS):
        octant = (code >> 3 * level) & 7
        block = code >> 3 * level + 3
        chance = (place_words(block, seed, -1 - level) & np.uint64(63)).astype(np.int64)
        # Adding a number and exchanging the order of bits: 8 x 8 of the ways to shuffle eight.
        turned = ((octant + chance) ^ (chance >> 3)) & 7
        threshold += turned * 8.0 ** -(level + 1)
    return threshold + place_chance(code, seed) * 8.0**-_LEVELS
