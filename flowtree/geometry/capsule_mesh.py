"""Capsules as triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flowtree.geometry.frames import side_axes, unit


def capsule_mesh(
    ends: ArrayLike, radius: float, *, sides: int = 8, rings: int = 2
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """The closed, convex surface of a cylinder with round ends; its corners lie on the capsule.

    Args:
        ends: (2, 3) centres of the round ends [m]; in one place they make a sphere.
        radius: [m].
        sides: around the axis, at least 3.
        rings: of corners on each round end, the cylinder's edge among them, at least 1.

    Returns: positions (2 * rings * sides + 2, 3) and triangles, counter-clockwise seen from outside.
    """
    low, high = np.asarray(ends, np.float64)
    axis = unit((high - low)[None])
    if not axis.any():
        axis = np.array([[0.0, 1.0, 0.0]])
    one, two = (each[0] for each in side_axes(axis))
    turn = 2.0 * np.pi * np.arange(sides) / sides
    around = np.cos(turn)[:, None] * one + np.sin(turn)[:, None] * two
    rise = 0.5 * np.pi * np.arange(rings) / rings
    cap = np.cos(rise)[:, None, None] * around + np.sin(rise)[:, None, None] * axis[0]
    base = np.cos(rise)[::-1, None, None] * around - np.sin(rise)[::-1, None, None] * axis[0]
    poles = [low - radius * axis[0], high + radius * axis[0]]
    positions = np.concatenate(
        [(low + radius * base).reshape(-1, 3), (high + radius * cap).reshape(-1, 3), poles]
    )

    corner = np.arange(2 * rings * sides).reshape(2 * rings, sides)
    after = np.roll(corner, -1, axis=1)
    wall = np.stack(
        [corner[:-1], after[:-1], after[1:], corner[:-1], after[1:], corner[1:]], axis=-1
    ).reshape(-1, 3)
    bottom, top = len(positions) - 2, len(positions) - 1
    floor = np.stack([np.full(sides, bottom), after[0], corner[0]], axis=1)
    roof = np.stack([np.full(sides, top), corner[-1], after[-1]], axis=1)
    return positions.astype(np.float32), np.concatenate([wall, floor, roof]).astype(np.int32)
