"""Frames that follow many curves without twisting around them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Vectors = NDArray[np.float64]

# The side of a branch where its texture's seam lies: below, and for upright ones behind (away from the
# cameras at yaw 0 and 90).
_SEAM_SIDE = np.array([-0.1, -1.0, -0.1])


def transport_frames(points: Vectors, tangents: Vectors, chain: NDArray[np.int64]) -> tuple[Vectors, Vectors]:
    """Rotation-minimising frames along many polylines at once.

    The double reflection of Wang, Jüttler, Zheng and Liu (2008, "Computation of Rotation Minimizing Frames")
    takes the frame of one point to the next. Two reflections are one rotation, and rotations compose
    associatively: so instead of walking every polyline, the quaternions are multiplied up in a segmented
    prefix scan, log2(longest polyline) rounds over all points.

    Args:
        points: (k, 3) [m], the polylines one behind the other.
        tangents: (k, 3), unit.
        chain: (k,), which polyline a point belongs to, never falling.

    Returns: two (k, 3) arrays of unit vectors, right-handed with the tangent: first x second = tangent.
    """
    k = len(points)
    index = np.arange(k)
    first = np.concatenate(([True], chain[1:] != chain[:-1]))
    begin = np.maximum.accumulate(np.where(first, index, 0))

    turn = np.zeros((k, 4))
    turn[:, 0] = 1.0
    turn[1:] = _double_reflection(points[:-1], points[1:], tangents[:-1], tangents[1:])
    turn[first] = (1.0, 0.0, 0.0, 0.0)
    place = index - begin
    step = 1
    while step <= int(place.max(initial=0)):
        later = np.flatnonzero(place >= step)
        turn[later] = _unit(_multiply(turn[later], turn[later - step]))
        step *= 2

    start = _across(np.broadcast_to(_SEAM_SIDE, (k, 3)), tangents)[begin]
    # Rounding must not lean the frame, so it is set upright on the tangent once more.
    one = _across(_rotate(turn, start), tangents)
    return one, np.cross(tangents, one)


def _double_reflection(p0: Vectors, p1: Vectors, t0: Vectors, t1: Vectors) -> Vectors:
    """(k, 4) unit quaternions (w, x, y, z): each takes the frame at p0 to the one at p1."""
    chord = _unit(p1 - p0)
    mirrored = t0 - 2.0 * np.sum(chord * t0, axis=1, keepdims=True) * chord
    second = _unit(t1 - mirrored)
    quaternion = np.concatenate(
        [np.sum(chord * second, axis=1, keepdims=True), np.cross(chord, second)], axis=1
    )
    # A chord of no length or a curve that turns right back has no such rotation; the frame is then carried
    # over as it is and set upright on the new tangent.
    quaternion[np.linalg.norm(quaternion, axis=1) < 0.5] = (1.0, 0.0, 0.0, 0.0)
    return _unit(quaternion)


def _multiply(a: Vectors, b: Vectors) -> Vectors:
    w = a[:, :1] * b[:, :1] - np.sum(a[:, 1:] * b[:, 1:], axis=1, keepdims=True)
    v = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    return np.concatenate([w, v], axis=1)


def _rotate(quaternion: Vectors, vector: Vectors) -> Vectors:
    axis = quaternion[:, 1:]
    twice = 2.0 * np.cross(axis, vector)
    return vector + quaternion[:, :1] * twice + np.cross(axis, twice)


def _across(vector: Vectors, tangent: Vectors) -> Vectors:
    """The part of the vector across the tangent, unit; any direction across it where there is none."""
    across = vector - np.sum(vector * tangent, axis=1, keepdims=True) * tangent
    lost = np.linalg.norm(across, axis=1) < 1e-3
    if lost.any():
        flat = np.eye(3)[np.argmin(np.abs(tangent[lost]), axis=1)]
        across[lost] = flat - np.sum(flat * tangent[lost], axis=1, keepdims=True) * tangent[lost]
    return _unit(across)


def _unit(vector: Vectors) -> Vectors:
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    unit: Vectors = np.divide(vector, length, out=np.zeros_like(vector), where=length > 1e-12)
    return unit
