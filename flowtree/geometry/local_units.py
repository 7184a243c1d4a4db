"""Local coordinate systems of forks (Manifold Ramifications, section 4.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def local_units(along: Floats, child: Floats) -> Floats:
    """Rotations that take world vectors into forks' local coordinates (equation 3), Rot2 · Rot1.

    Rot1 turns the parent's direction to the y axis, Rot2 then turns about y until y x child is the x axis: a
    child leaves in the half plane of y and +z. Both by Rodrigues' formula.

    Args:
        along: (n, 3), unit, directions of the parents.
        child: (n, 3), directions of the children, not parallel to them.

    Returns: (n, 3, 3); the rows are the local axes in world coordinates.
    """
    y = np.broadcast_to([0.0, 1.0, 0.0], along.shape)
    first = turn_between(along, y)
    turned = np.einsum("nij,nj->ni", first, child)
    side = np.cross(y, turned)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    # The turn is about y whatever the angle: half a turn has no axis of its own.
    sine, cosine = side[:, 2], side[:, 0]
    second = np.zeros_like(first)
    second[:, 1, 1] = 1.0
    second[:, 0, 0] = second[:, 2, 2] = cosine
    second[:, 0, 2], second[:, 2, 0] = sine, -sine
    return np.asarray(second @ first)


def turn_between(start: Floats, end: Floats) -> Floats:
    """Rotations (n, 3, 3) that turn unit vectors (n, 3) to others the short way, by Rodrigues' formula."""
    axis = np.cross(start, end)
    cosine = np.sum(start * end, axis=1)
    k = np.zeros((len(start), 3, 3))
    k[:, 0, 1], k[:, 0, 2], k[:, 1, 2] = -axis[:, 2], axis[:, 1], -axis[:, 0]
    k -= k.transpose(0, 2, 1)
    turn = np.eye(3) + k + k @ k / np.maximum(1.0 + cosine, 1e-12)[:, None, None]
    back = cosine < -1.0 + 1e-9
    flat = np.eye(3)[np.argmin(np.abs(start[back]), axis=1)]
    half = flat - np.sum(flat * start[back], axis=1, keepdims=True) * start[back]
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    turn[back] = 2.0 * half[:, :, None] * half[:, None, :] - np.eye(3)
    return np.asarray(turn)
