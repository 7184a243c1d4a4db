"""A gentle swaying of a tree's joints that can be repeated without a break."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.wind import Armature, Sway, WindWeights

# By tier: stem, limb, finer branch.
_TURN = np.radians([3.0, 6.5, 8.0])  # at the end of a branch whose extent reaches 1, at strength 1
_HASTE = np.array([1.0, 1.9, 3.1])  # frequency, relative to the stem's
_STEM_FREQUENCY = 1.0  # [Hz] of a stem 1 m high; falls with the root of the height, as a pendulum's
_KEYS_A_SWING = 12
_FEWEST_KEYS, _MOST_KEYS = 24, 360
# A breeze from -x to +x: how it is shared between leaning steadily, gusts, and each branch's own swinging.
_LEAN, _GUST, _OWN = 0.35, 0.3, 0.35
_ACROSS = 0.45  # how far branches swing across the wind, relative to along it
_LAG = 0.06  # of a cycle, by which a branch's end is behind its beginning


def sway_joints(
    armature: Armature,
    weights: WindWeights,
    *,
    strength: float = 1.0,
    seconds: float = 8.0,
    seed: int = 0,
) -> Sway:
    """Bakes a loop of a tree in a breeze along +x, as sums of sines with whole periods.

    The stem swings slowly and little, limbs faster and farther, each with its own phase, and finer branches
    most. All lean a little with the wind and more in gusts, which pass through all of them. Each joint turns
    by what its piece of the branch bends (`weigh_wind`); joint 0, at the foot, does not turn.

    Args:
        armature: of the skeleton that was weighed.
        weights: of its nodes.
        strength: 1 is a gentle breeze; turns grow with it.
        seconds: length of the loop [s].
        seed: of the gusts.

    Returns: see `Sway`; the last key equals the first to the bit.

    Raises:
        InputError: a strength below 0, a length that is not positive, weights of another skeleton.
    """
    check.require(bool(strength >= 0), "wind strength", "must be at least 0", strength, "raise it")
    check.require(bool(seconds > 0), "wind seconds", "must be positive", seconds, "make the loop longer")
    count = len(weights.depth)
    check.require(
        len(armature.joint) == count,
        "wind weights",
        "must be of the armature's skeleton",
        f"{count} nodes, not {len(armature.joint)}",
        "weigh that skeleton",
    )
    tier = weights.depth[armature.node]
    turn = strength * _TURN[tier] * _bending(armature, weights, tier)
    height = float(np.ptp(armature.points[:, 1])) or 1.0
    frequency = _STEM_FREQUENCY / np.sqrt(height)
    rounds = np.maximum(1, np.rint(_HASTE * frequency * seconds)).astype(np.int64)
    keys = int(np.clip(_KEYS_A_SWING * (rounds[-1] + 1), _FEWEST_KEYS, _MOST_KEYS))
    cycle = np.arange(keys) / keys

    phase = np.take_along_axis(weights.phase[armature.node], np.maximum(tier - 1, 0)[:, None], axis=1)[:, 0]
    phase = np.where(tier > 0, phase, 0.0) - _LAG * _steps_on_branch(armature, tier)
    # Of each two whole numbers of swings half of the branches take the greater: they drift apart and meet.
    swings = rounds[tier] + (tier > 0) * (np.floor(phase * 16.0).astype(np.int64) % 2)
    own = np.sin(2.0 * np.pi * (cycle[:, None] * swings + phase))
    across = np.sin(2.0 * np.pi * (cycle[:, None] * (swings + 1) + 0.37 + 1.7 * phase))
    along = _LEAN + _GUST * _gust(cycle[:, None] - 0.02 * tier, seed) + _OWN * own
    # Leaning toward +x is turning against +z; to the side it is turning around x, and limbs also around y.
    turns = np.stack(
        [_ACROSS * across, np.where(tier > 0, _ACROSS, 0.0) * np.roll(across, keys // 7, axis=0), -along],
        axis=2,
    )
    rotation = _rotations(turns * turn[:, None])
    rotation[:, 0] = (0.0, 0.0, 0.0, 1.0)
    return Sway(
        name="sway",
        times=np.linspace(0.0, seconds, keys + 1).astype(np.float32),
        rotation=np.concatenate([rotation, rotation[:1]]).astype(np.float32),
    )


def _bending(armature: Armature, weights: WindWeights, tier: NDArray[np.int32]) -> NDArray[np.float64]:
    """How far the piece of its own branch that each joint turns bends, (j,): its share of the extent."""
    extent = weights.extent.astype(np.float64)
    begin = extent[armature.node, tier]
    carrier = armature.joint[:, 0]
    own = np.flatnonzero(weights.depth == tier[carrier])
    end = begin.copy()
    np.maximum.at(end, carrier[own], extent[own, weights.depth[own]])
    return end - begin


def _steps_on_branch(armature: Armature, tier: NDArray[np.int32]) -> NDArray[np.int64]:
    """How many joints of the same tier lie between each joint and the tier's beginning, (j,)."""
    steps = np.zeros(len(tier), np.int64)
    for joint, parent in enumerate(armature.parent):
        if parent >= 0 and tier[parent] == tier[joint]:
            steps[joint] = steps[parent] + 1
    return steps


def _gust(cycle: NDArray[np.float64], seed: int) -> NDArray[np.float64]:
    """A slow rise and fall of the wind, -1..1, periodic in ``cycle``."""
    late = np.random.default_rng(seed).random(3)
    waves = [np.sin(2.0 * np.pi * ((k + 1) * cycle + late[k])) for k in range(3)]
    rise: NDArray[np.float64] = 0.5 * waves[0] + 0.3 * waves[1] + 0.2 * waves[2]
    return rise


def _rotations(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rotation vectors (…, 3) [radians] as unit quaternions (…, 4) with w last."""
    angle = np.linalg.norm(turns, axis=-1, keepdims=True)
    scale = 0.5 * np.sinc(angle / (2.0 * np.pi))  # sin(angle / 2) / angle, 1/2 at 0
    return np.concatenate([turns * scale, np.cos(0.5 * angle)], axis=-1)
