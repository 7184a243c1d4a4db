"""Direction fields from attractor graphs (Particle Flows, section 7)."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import check
from flowtree import device as devices
from flowtree.attraction.branch_levels import branch_levels
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.kernels.nearest_segment import nearest_segment
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.field import DirectionField
from flowtree.params import FieldParams

_BELOW, _ABOVE, _BESIDE = 0.02, 0.05, 0.1  # of the height: what the grid covers around the graph
_RUN = 8  # segments, neighbours along branches, that the search looks at together
_SPLIT_FROM = 64  # cells; each is compared with the whole graph
_ROUNDS = 4  # of tangent smoothing
_STILL = 1e-3  # a sum of directions shorter than this points nowhere

_Array = NDArray[np.float64]


def build_direction_field(
    graph: AttractorGraph,
    camera: Camera,
    *,
    params: FieldParams = FieldParams(),
    bounds: tuple[float, float, float, float] | None = None,
    device: str | None = None,
) -> DirectionField:
    """Directions that lead to the graph and along it to the foot (equation 3).

    At every cell's centre x, with g the nearest point of the graph, v the unit vector from x to g, t the unit
    tangent of the graph at g toward the foot and d = |g - x|: f = h(d) v + (1 - h(d)) t. Linear: h grows
    from 0 on the graph to 1 at ``params.reach`` tree heights. Constant: h is such that f leaves t by
    ``params.angle``, or that of ``params.angles`` for the branch's level, where v is perpendicular to t.

    Deviations: f is normalised, for a weak field would make stragglers; where the two parts cancel f points
    to the foot; around the root's end, where no graph is left to follow, f is v. Tangents are smoothed over
    about 2 % of the height, heavy branches counting most, so that a join is a curve.

    Args:
        graph: rooted at (0, 0).
        camera: of the view.
        params: see `FieldParams`.
        bounds: (left, bottom, right, top) [m] of the grid in the view's plane; None covers the graph, from
            2 % of its height below the foot to 5 % above its top and 10 % to each side.
        device: to run on; None takes the best there is.

    Returns: unit vectors, ``params.resolution`` cells along each side.

    Raises:
        InputError: a graph without a segment, a parent that does not come before its child, bounds without
        area.
    """
    points = check.array(graph.points, "attractor graph", shape=(None, 2), dtype=np.float64)
    parent = check.array(graph.parent, "attractor graph's parents", shape=(len(points),), dtype=np.int64)
    rooted = len(points) > 1 and parent[0] == -1
    rooted = rooted and bool((parent[1:] >= 0).all() and (parent[1:] < np.arange(1, len(points))).all())
    check.require(
        rooted,
        "attractor graph",
        "needs a root and segments, each parent before its child",
        f"{len(points)} nodes",
        "trace or draw a branch",
    )
    height = float(max(points[:, 1].max(), np.ptp(points, axis=0).max(), 1e-6))
    left, bottom, right, top = _bounds(points, height) if bounds is None else bounds
    finite = bool(np.isfinite([left, bottom, right, top]).all())
    check.require(
        finite and left < right and bottom < top,
        "bounds",
        "must be (left, bottom, right, top) with an area",
        (left, bottom, right, top),
        "leave them out to cover the graph",
    )
    cell = np.array([right - left, top - bottom]) / params.resolution
    steps = np.arange(params.resolution) + 0.5
    x, y = np.meshgrid(left + steps * cell[0], bottom + steps * cell[1])
    centres = np.stack([x.ravel(), y.ravel()], axis=1)
    offset, tangent, node = _nearest(centres, parent, points, devices.pick_device(device))
    distance = np.linalg.norm(offset, axis=1)
    if params.blending == "linear":
        h = np.clip(distance / (params.reach * height), 0.0, 1.0)
    else:
        angles = np.array(params.angles or (params.angle,))
        level = branch_levels(parent.astype(np.int32), points)[node]
        turn = np.radians(angles[np.minimum(level, len(angles) - 1)])
        h = np.sin(turn) / (np.sin(turn) + np.cos(turn))
    toward = np.divide(offset, distance[:, None], out=np.zeros_like(offset), where=distance[:, None] > 0.0)
    # Exactly on the graph there is no direction to it: only the tangent is left.
    h = np.where(distance > 0.0, h, 0.0)[:, None]
    force = h * toward + (1.0 - h) * tangent
    vectors = _unit(force, -centres, still=_STILL).astype(np.float32)
    return DirectionField(
        vectors.reshape(params.resolution, params.resolution, 2),
        np.array([left, bottom], np.float32),
        cell.astype(np.float32),
        camera.yaw,
        camera.distance,
        camera.eye,
    )


def _bounds(points: _Array, height: float) -> tuple[float, float, float, float]:
    low, high = points.min(axis=0), points.max(axis=0)
    return (
        float(low[0] - _BESIDE * height),
        float(min(low[1], 0.0) - _BELOW * height),
        float(high[0] + _BESIDE * height),
        float(high[1] + _ABOVE * height),
    )


def _nearest(
    centres: _Array, parent: NDArray[np.int64], points: _Array, device: str
) -> tuple[_Array, _Array, NDArray[np.int64]]:
    """Vector (m, 2) to the nearest point of the graph, the unit tangent (m, 2) there, the node (m,) above it.

    Segments that share their nearest point with another meet there, and have one tangent there: it does not
    matter which of them float32 finds.
    """
    child = np.arange(1, len(points))
    starts, ends = points[parent[child]], points[child]
    chosen = _search(centres, starts, ends, device)
    fraction, nearest = nearest_on_segments(centres, starts[chosen], ends[chosen])
    offset, along = nearest - centres, fraction[:, None]
    tangents = _node_tangents(parent, points)
    tangent = (1.0 - along) * tangents[parent[child]][chosen] + along * tangents[child][chosen]
    at_root = (fraction == 0.0) & (np.abs(starts[chosen]).max(axis=1) == 0.0)
    tangent[at_root] = _unit(offset[at_root], tangent[at_root])
    return offset, _unit(tangent, -centres), child[chosen]


def _search(centres: _Array, starts: _Array, ends: _Array, device: str) -> NDArray[np.int32]:
    """(m,) the segment nearest to each centre."""
    along = ends - starts
    square = (along**2).sum(axis=1)
    over = np.divide(1.0, square, out=np.zeros_like(square), where=square > 1e-30)
    runs = np.arange(0, len(starts), _RUN)
    low = np.minimum.reduceat(np.minimum(starts, ends), runs, axis=0)
    high = np.maximum.reduceat(np.maximum(starts, ends), runs, axis=0)
    found = devices.empty(len(centres), wp.int32, device)

    def up(values: _Array, kind: Any) -> Any:
        return devices.upload(values.astype(np.float32), kind, device)

    inputs = [*(up(a, wp.vec2) for a in (centres, starts, along)), up(over, wp.float32)]
    inputs += [up(low, wp.vec2), up(high, wp.vec2), _RUN]
    devices.launch(nearest_segment, len(centres), inputs, [found], device=device, split_from=_SPLIT_FROM)
    segments: NDArray[np.int32] = found.numpy()
    return segments


def _node_tangents(parent: NDArray[np.int64], points: _Array) -> _Array:
    """Unit directions (n, 2) toward the foot at the nodes, smoothed along the branches."""
    child = np.arange(1, len(points))
    down = np.zeros_like(points)
    down[1:] = points[parent[child]] - points[child]
    length = np.linalg.norm(down, axis=1)
    weight = length.copy()
    for node in range(len(points) - 1, 0, -1):
        weight[parent[node]] += weight[node]
    tangent: _Array = _unit(down, np.zeros_like(down))
    # Repeated points have no direction of their own: they take the one below them.
    for node in range(1, len(points)):
        if length[node] == 0.0:
            tangent[node] = tangent[parent[node]]
    for _ in range(_ROUNDS):
        above = np.zeros_like(points)
        np.add.at(above, parent[child], weight[child, None] * tangent[child])
        behind = _unit(above, tangent)
        before = np.asarray(tangent[np.maximum(parent, 0)])
        before[0] = behind[0]
        tangent = _unit(0.5 * tangent + 0.25 * before + 0.25 * behind, tangent)
    return tangent


def _unit(vectors: _Array, otherwise: _Array, *, still: float = 0.0) -> _Array:
    """Rows of unit length; rows no longer than ``still`` follow ``otherwise``, and failing that go down."""
    result = np.zeros_like(vectors)
    result[:, 1] = -1.0
    for choice, least in ((otherwise, 0.0), (vectors, still)):
        size = np.linalg.norm(choice, axis=1, keepdims=True)
        np.divide(choice, size, out=result, where=size > least)
    return result
