"""Rings carried along branches and their vertices placed with NumPy."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[Any]
_SEAM_SIDE = np.array([-0.1, -1.0, -0.1])


def transport_frames_numpy(points: _Array, tangents: _Array, chain: _Array) -> tuple[_Array, _Array]:
    """Rotation-minimising frames by a segmented prefix scan over quaternions, one for each double reflection.

    Two reflections are one rotation, and rotations compose associatively: log2(longest branch) rounds over
    all rings at once, where walking the branches would be a loop in Python.
    """
    count = len(points)
    index = np.arange(count)
    first = np.concatenate(([True], chain[1:] != chain[:-1]))
    begin = np.maximum.accumulate(np.where(first, index, 0))
    turn = np.zeros((count, 4))
    turn[:, 0] = 1.0
    turn[1:] = _double_reflection(points[:-1], points[1:], tangents[:-1], tangents[1:])
    turn[first] = (1.0, 0.0, 0.0, 0.0)
    place = index - begin
    step = 1
    while step <= int(place.max(initial=0)):
        later = np.flatnonzero(place >= step)
        turn[later] = _unit(_multiply(turn[later], turn[later - step]))
        step *= 2
    start = _across(np.broadcast_to(_SEAM_SIDE, (count, 3)), tangents)[begin]
    twice = 2.0 * np.cross(turn[:, 1:], start)
    one = _across(start + turn[:, :1] * twice + np.cross(turn[:, 1:], twice), tangents)
    return one, np.cross(tangents, one)


def place_numpy(rings: Any, bark: Any, sides: _Array, offset: _Array, device: str) -> tuple[_Array, ...]:
    """Positions, normals, texture coordinates and tangents, as `flowtree.meshing.sweep_rings` asks for them.

    Rings of two sides, which the benchmark's branches do not have, are left out.
    """
    del device
    one, two = transport_frames_numpy(rings.center, rings.tangent, rings.chain)
    row = np.repeat(np.arange(len(sides)), np.diff(offset))
    column = np.arange(offset[-1]) - offset[row]
    ring, count = bark.ring[row], sides[row]
    angle = 2.0 * np.pi * (column % count) / count
    outward = np.cos(angle)[:, None] * one[ring] + np.sin(angle)[:, None] * two[ring]
    apex = np.isneginf(rings.slope)[ring]
    lean = np.where(apex, 1.0, -rings.slope[ring])
    normal = outward * ~apex[:, None] + lean[:, None] * rings.tangent[ring]
    around = (column + 0.5 * apex) / count
    uvs = bark.start[row]
    uvs[:, 0] += around * bark.repeats[row]
    turned = 2.0 * np.pi * (around % 1.0)
    along = np.cos(turned)[:, None] * two[ring] - np.sin(turned)[:, None] * one[ring]
    tangents = np.concatenate([along, np.ones((len(along), 1))], axis=1)
    positions = rings.center[ring] + rings.radius[ring, None] * outward
    return tuple(a.astype(np.float32) for a in (positions, _unit(normal), uvs, tangents))


def _double_reflection(p0: _Array, p1: _Array, t0: _Array, t1: _Array) -> _Array:
    chord = _unit(p1 - p0)
    mirrored = t0 - 2.0 * np.sum(chord * t0, axis=1, keepdims=True) * chord
    second = _unit(t1 - mirrored)
    turn = np.concatenate([np.sum(chord * second, axis=1, keepdims=True), np.cross(chord, second)], axis=1)
    turn[np.linalg.norm(turn, axis=1) < 0.5] = (1.0, 0.0, 0.0, 0.0)
    return _unit(turn)


def _multiply(a: _Array, b: _Array) -> _Array:
    w = a[:, :1] * b[:, :1] - np.sum(a[:, 1:] * b[:, 1:], axis=1, keepdims=True)
    return np.concatenate(
        [w, a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])], axis=1
    )


def _across(vector: _Array, tangent: _Array) -> _Array:
    across = vector - np.sum(vector * tangent, axis=1, keepdims=True) * tangent
    lost = np.linalg.norm(across, axis=1) < 1e-3
    flat = np.eye(3)[np.argmin(np.abs(tangent[lost]), axis=1)]
    across[lost] = flat - np.sum(flat * tangent[lost], axis=1, keepdims=True) * tangent[lost]
    return _unit(across)


def _unit(vector: _Array) -> _Array:
    length = np.linalg.norm(vector, axis=1, keepdims=True)
    return np.divide(vector, length, out=np.zeros_like(vector), where=length > 1e-12)
