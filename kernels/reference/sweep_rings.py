"""The NumPy twin of `flowtree.kernels.sweep_rings`: vector after vector."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[Any]


def unit(v: _Array) -> _Array:
    """The vector at length 1; 0 where it has none."""
    length = np.linalg.norm(v)
    return v / length if length > 1e-12 else np.zeros(3)


def across(v: _Array, tangent: _Array) -> _Array:
    """The part of the vector across the tangent, unit; any direction across it where there is none."""
    part = v - (v @ tangent) * tangent
    if np.linalg.norm(part) < 1e-3:
        flat = np.eye(3)[np.argmin(np.abs(tangent))]
        part = flat - (flat @ tangent) * tangent
    return unit(part)


def mirror(v: _Array, normal: _Array) -> _Array:
    """The vector mirrored in the plane across the normal."""
    return v - 2.0 * (normal @ v) * normal


def transport_frames(
    first: int,
    center: _Array,
    tangent: _Array,
    chain_start: _Array,
    side: _Array,
    one_out: _Array,
    two_out: _Array,
) -> None:
    """Rotation-minimising frames by double reflection, one branch an index, ring after ring."""
    for chain in range(first, len(chain_start) - 1):
        one = np.asarray(side, np.float64)
        for ring in range(chain_start[chain], chain_start[chain + 1]):
            if ring > chain_start[chain]:
                chord = unit(center[ring] - center[ring - 1])
                second = unit(tangent[ring] - mirror(tangent[ring - 1], chord))
                if chord.any() and second.any():
                    one = mirror(mirror(one, chord), second)
            one = across(one, tangent[ring])
            one_out[ring], two_out[ring] = one, np.cross(tangent[ring], one)


def place_vertices(
    first: int,
    center: _Array,
    tangent: _Array,
    one: _Array,
    two: _Array,
    radius: _Array,
    slope: _Array,
    ring_of: _Array,
    sides: _Array,
    vertex_start: _Array,
    repeats: _Array,
    uv_start: _Array,
    position_out: _Array,
    normal_out: _Array,
    uv_out: _Array,
    tangent_out: _Array,
) -> None:
    """The vertices of one row an index: a ring's and its first once more, or an apex's, one a side."""
    for row in range(first, len(ring_of)):
        ring, count = ring_of[row], sides[row]
        apex = slope[ring] < -1e30
        for column in range(count if apex else count + 1):
            angle = 2.0 * np.pi * (column % count) / count
            outward = np.cos(angle) * one[ring] + np.sin(angle) * two[ring]
            lean = 0.25 * np.pi * (1 - column) if count == 2 and not apex else 0.0
            facing = np.cos(angle + lean) * one[ring] + np.sin(angle + lean) * two[ring]
            around = (column + 0.5 * apex) / count
            turned = 2.0 * np.pi * (around % 1.0) + lean
            vertex = vertex_start[row] + column
            position_out[vertex] = center[ring] + radius[ring] * outward
            normal_out[vertex] = tangent[ring] if apex else unit(facing - slope[ring] * tangent[ring])
            uv_out[vertex] = uv_start[row] + np.array([around * repeats[row], 0.0])
            tangent_out[vertex, :3] = np.cos(turned) * two[ring] - np.sin(turned) * one[ring]
            tangent_out[vertex, 3] = 1.0
