"""What stands in space: voxels, directions, particles, branches; little endian, in metres."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.field import LimbField
from flowtree.model.skeleton import Skeleton
from flowtree.model.traces import FlowTraces
from flowtree.model.volume import DensityVolume
from flowtree.studio.layers.layer import BINARY, Layer

_MOST_VOXELS = 30_000
_MOST_ARROWS = 4_000
_MOST_POINTS = 60_000  # of the particles' paths


def voxels_layer(volume: DensityVolume) -> Layer:
    """The density: count, edge [m], the densest's density [1/m], centres, and shares of the densest (uint8).

    Where there are more than a browser likes to draw, eight become one of their mean.
    """
    density, edge = volume.density, volume.voxel
    while int((density > 0.0).sum()) > _MOST_VOXELS:
        even = tuple((0, size % 2) for size in density.shape)
        blocks = np.pad(density, even)
        shape = [part for size in blocks.shape for part in (size // 2, 2)]
        density, edge = blocks.reshape(shape).mean(axis=(1, 3, 5)).astype(np.float32), 2.0 * edge
    densest = float(density.max())
    share = (
        np.rint(density * (255.0 / densest)).astype(np.uint8) if densest > 0.0 else density.astype(np.uint8)
    )
    cells = np.argwhere(share > 0)
    centres = (volume.origin + (cells + 0.5) * edge).astype("<f4")
    head = np.array([edge, densest], "<f4").tobytes()
    return _binary("voxels", len(cells), head, centres.tobytes(), share[tuple(cells.T)].tobytes())


def field_layer(field: LimbField) -> Layer:
    """The directions around the limbs: count, then place and direction of each."""
    strong = np.argwhere(np.linalg.norm(field.vectors, axis=3) > 0.05)
    stride = max(1, int(np.ceil((len(strong) / _MOST_ARROWS) ** (1.0 / 3.0))))
    cells = strong[(strong % stride == 0).all(axis=1)]
    places = field.corner + cells * field.spacing
    arrows = np.concatenate([places, field.vectors[tuple(cells.T)]], axis=1).astype("<f4")
    return _binary("field", len(arrows), arrows.tobytes())


def flow_layer(traces: FlowTraces) -> Layer:
    """The particles' paths: count, each point's next one, places, times, and how many particles pass it.

    Where there are too many points, whole paths are left out: those that fewest particles pass.
    """
    kept = np.arange(len(traces.parent))
    if len(kept) > _MOST_POINTS:
        tip = np.ones(len(kept), bool)
        tip[traces.parent[1:]] = False
        chosen = np.flatnonzero(tip)[:: max(2, round(len(kept) / _MOST_POINTS))]
        passed = np.zeros(len(kept), bool)
        passed[chosen] = True
        for node in range(len(kept) - 1, 0, -1):  # a point stands behind the one it flows to
            passed[traces.parent[node]] |= passed[node]
        kept = np.flatnonzero(passed)
    number = np.full(len(traces.parent) + 1, -1, np.int64)
    number[kept] = np.arange(len(kept))
    parent = number[traces.parent[kept]].astype("<i4")
    return _binary(
        "flow",
        len(kept),
        parent.tobytes(),
        traces.points[kept].astype("<f4").tobytes(),
        traces.step[kept].astype("<i4").tobytes(),
        traces.particles[kept].astype("<i4").tobytes(),
    )


def skeleton_layer(skeleton: Skeleton) -> Layer:
    """The branches: count, then both ends with their radii, the order, and whether it is a twig."""
    upper = np.arange(1, len(skeleton.parent))
    lower = skeleton.parent[1:]
    rows = np.concatenate(
        [
            _ends(skeleton, lower),
            _ends(skeleton, upper),
            skeleton.level[1:, None].astype(np.float32),
            skeleton.twig[1:, None].astype(np.float32),
        ],
        axis=1,
    ).astype("<f4")
    return _binary("skeleton", len(rows), rows.tobytes())


def _ends(skeleton: Skeleton, nodes: NDArray[np.integer]) -> NDArray[np.float32]:
    return np.concatenate([skeleton.points[nodes], skeleton.radius[nodes, None]], axis=1)


def _binary(name: str, count: int, *parts: bytes) -> Layer:
    return Layer(name, BINARY, b"".join((np.array([count], "<u4").tobytes(), *parts)))
