"""The recipe of `flowtree.wind.wind_shader` once more, in numpy."""

from __future__ import annotations

import numpy as np

from flowtree.model.wind import VertexWind


def turn(place, pivot, turning):
    """Points (v, 3) around pivots (v, 3) by axis times angle (v, 3)."""
    angle = np.maximum(np.linalg.norm(turning, axis=1, keepdims=True), 1e-6)
    axis, arm = turning / angle, place - pivot
    along = axis * np.sum(axis * arm, axis=1, keepdims=True)
    return pivot + arm * np.cos(angle) + np.cross(axis, arm) * np.sin(angle) + along * (1 - np.cos(angle))


def swing(wind, cycles):
    """(3,) wind and (v,) cycles: (v, 3)."""
    cycles = np.asarray(cycles)[:, None]
    along = np.cross([0.0, 1.0, 0.0], wind)
    beat, slow = np.sin(2 * np.pi * cycles), np.sin(2 * np.pi * 0.31 * cycles)
    return along * (0.35 + 0.25 * slow + 0.4 * beat) + 0.4 * np.asarray(wind) * np.sin(
        2 * np.pi * 0.83 * cycles
    )


def sway(place, normal, vertices: VertexWind, *, wind=(1.0, 0.0, 0.0), time=0.0, flutter=0.0):
    """Where the vertices are at a time, (v, 3) float64."""
    place, extent, phase = place.astype(float), vertices.extent.astype(float), vertices.phase.astype(float)
    beat = np.sin(2 * np.pi * (1.7 * time + phase[:, 2]))
    place = place + normal * (np.linalg.norm(wind) * flutter * extent[:, 3] * beat)[:, None]
    steps = (
        (0.12, 2, vertices.pivot[:, 1], 0.9, phase[:, 1]),
        (0.09, 1, vertices.pivot[:, 0], 0.55, phase[:, 0]),
    )
    for angle, tier, pivot, pace, begin in steps:
        place = turn(place, pivot, angle * extent[:, tier, None] * swing(wind, pace * time + begin))
    stem = swing(wind, np.full(len(place), 0.25 * time))
    return turn(place, np.zeros(3), 0.035 * extent[:, :1] * stem)
