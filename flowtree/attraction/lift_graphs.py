"""One 3D tree of limbs from the attractor graphs of all views."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.spatial import cKDTree

from flowtree import check
from flowtree.geometry.parent_array import parents_first
from flowtree.geometry.polylines import arc_lengths, nearest_on_segments, smooth_polyline
from flowtree.geometry.projection import Sight, from_plane, growth, lines_of_sight, to_plane, view_axes
from flowtree.model.attractor import AttractorGraph, LimbTree
from flowtree.model.volume import DensityVolume

_DEPTHS = 73  # places along a ray; odd, so that the axis is one
_SAME = 0.015  # of the height: a limb whose picture is this near to a line of a graph is that line
_ON = 0.004  # of the height: as near as this a place is on a line; cell of the maps of distances
_NEAR = 0.05  # of the height: farther from a graph's line than this a place is not on it
_SHORTEST = 0.03  # of the height: what a view shows more of a limb than the others must be this long
_AIR = 2.0  # what a way through air costs, of what a way off the other views' lines costs
_OVER = 20.0  # and a way above the tree, where an eye sees boughs that reach toward it
_SHARED = 0.6  # of that cost where the line is another limb's already
_STEEP = 0.35  # what depth costs: so many times its square over the length seen
_OTHER = 0.02  # of the height: what a branch must save to start at another limb than its fork's
_FAR = 1.2  # depth a limb may gain for the length seen
_SMOOTH = 0.03  # of the height: sigma of the smoothing of the depth along a limb
_SEES = 0.3  # sine of the angle between two views from which one sees the other's depth well enough
_FADE, _FADING = 0.8, 12  # from node to node, over so many nodes
_USUAL = 0.5  # quantile of the density that counts as solid

_Array = NDArray[np.float64]


def lift_graphs(graphs: Sequence[AttractorGraph], sights: Sequence[Sight], volume: DensityVolume) -> LimbTree:
    """Finds for the branches seen in single views the limbs in space that look like them in every view.

    The paper never does this: it averages the views' 2D fields, and particles gather wherever a line of one
    view crosses a line of another, so that most limbs of the pictures are lost among those that nobody drew.

    Branches are taken heaviest first, whichever view shows them. What of a branch the limbs found so far
    already look like is theirs. The rest gets its depth by dynamic programming (Viterbi): a smooth path that
    keeps inside the density and, in every other view, to that view's lines, rather to one that no limb has
    taken. So two views' pictures of one limb become one limb.

    Args:
        graphs: one a view, rooted at (0, 0).
        sights: of the views.
        volume: the density.

    Returns: the limbs, the root at the origin, nodes at most about 1.5 % of the height apart.

    Raises:
        InputError: no graph, or one without a segment.
    """
    check.require(len(graphs) > 0, "attractor graphs", "need at least one", "none", "give a view")
    height = max(float(graph.points[:, 1].max()) for graph in graphs)
    check.require(
        height > 0, "attractor graphs", "must rise from the foot", "none that does", "draw a branch"
    )
    lifting = _Lifting(graphs, sights, volume, height)
    branches = [
        (weight, view, nodes) for view, graph in enumerate(graphs) for weight, nodes in _branches(graph)
    ]
    # A branch is never heavier than its carrier, and comes behind it among equals.
    for _, view, nodes in sorted(branches, key=lambda branch: -branch[0]):
        lifting.add(view, nodes)
    count = lifting.count
    order, parent = parents_first(lifting.parent[:count])
    points, radius = lifting.points[:count][order], lifting.radii()[order]
    return LimbTree(parent, points.astype(np.float32), radius.astype(np.float32))


def _branches(graph: AttractorGraph) -> list[tuple[float, list[int]]]:
    """Length above its base and nodes of every branch, each from the fork that it leaves, carriers first."""
    parent, points = graph.parent, graph.points.astype(np.float64)
    count = len(parent)
    above = np.zeros(count)
    for node in range(count - 1, 0, -1):
        above[parent[node]] += above[node] + float(np.linalg.norm(points[node] - points[parent[node]]))
    children: list[list[int]] = [[] for _ in range(count)]
    for node in range(1, count):
        children[parent[node]].append(node)
    branches = []
    waiting = [(0, -1)]
    while waiting:
        first, fork = waiting.pop(0)
        nodes = [first] if fork < 0 else [fork, first]
        while children[nodes[-1]]:
            heavy = max(children[nodes[-1]], key=lambda child: (above[child], -child))
            waiting.extend((child, nodes[-1]) for child in children[nodes[-1]] if child != heavy)
            nodes.append(heavy)
        rise = float(np.linalg.norm(points[first] - points[max(fork, 0)]))
        branches.append((above[first] + rise, nodes))
    return branches


def _height_offset(line: _Array, flat: _Array) -> _Array:
    """How far right of each point (n, 2) a line runs at its nearest place [m]."""
    start, end = line[:-1], line[1:]
    _, nearest = nearest_on_segments(flat[:, None], start[None], end[None])
    distance = np.linalg.norm(nearest - flat[:, None], axis=2)
    chosen = nearest[np.arange(len(flat)), distance.argmin(axis=1)]
    return np.asarray((chosen - flat)[:, 0])


class _Distances:
    """How far the places of a view's plane are from the nearest of some of its lines, on a grid."""

    def __init__(self, graph: AttractorGraph, chosen: NDArray[np.bool_], height: float) -> None:
        points = graph.points.astype(np.float64)
        self._cell = _ON * height
        self._low = points.min(axis=0) - _NEAR * height
        size = np.ceil((points.max(axis=0) + _NEAR * height - self._low) / self._cell).astype(int)
        place = np.floor((points - self._low) / self._cell).astype(np.int32)
        blank = np.ones((size[1], size[0]), np.uint8)
        node = np.flatnonzero(chosen & (graph.parent >= 0))
        cv2.polylines(blank, list(np.stack([place[graph.parent[node]], place[node]], axis=1)), False, 0)
        found = cv2.distanceTransform(blank, cv2.DIST_L2, 5) if len(node) else np.full(blank.shape, np.inf)
        self._distance = np.asarray(found, np.float32)  # [cells]

    def at(self, flat: _Array) -> _Array:
        """Distance (n,) [m] of places (n, 2) [m], to a cell; infinite far outside of the graph."""
        column, row = np.floor((flat - self._low) / self._cell).astype(int).T
        rows, columns = self._distance.shape
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        result = np.full(len(flat), np.inf)
        result[inside] = self._distance[row[inside], column[inside]].astype(np.float64) * self._cell
        return result


class _Lifting:
    """The limbs while branches are still joining them.

    Attributes:
        count: of nodes; the arrays hold room for more.
        parent: of each node; the root's is -1.
        points: of each node [m].
    """

    def __init__(
        self,
        graphs: Sequence[AttractorGraph],
        sights: Sequence[Sight],
        volume: DensityVolume,
        height: float,
    ) -> None:
        room = 1 + sum(len(graph.parent) for graph in graphs)
        self.count = 1
        self.parent = np.full(room, -1, np.int64)
        self.points = np.zeros((room, 3))
        self._half_width = np.full((len(graphs), room), np.nan)  # as each view shows it [m]
        self._view = np.full(room, -1)
        self._settled = np.zeros((len(graphs), room), np.bool_)  # nodes that look like a line of a view
        self._graphs, self._height = graphs, height
        self._axes = [view_axes(sight.yaw) for sight in sights]
        self._sights = sights
        self._limb_of = [np.zeros(len(graph.parent), np.int64) for graph in graphs]
        self._taken = [np.zeros(len(graph.parent), np.bool_) for graph in graphs]
        smooth = gaussian_filter(volume.density.astype(np.float64), 0.7)
        filled = smooth[smooth > 0]
        usual = float(np.quantile(filled, _USUAL)) if len(filled) else 1.0
        self._solid = np.minimum(smooth / usual, 1.0)
        self._origin, self._voxel = volume.origin.astype(np.float64), float(volume.voxel)
        size = np.array(volume.density.shape) * self._voxel
        reach = float(np.abs([self._origin, self._origin + size])[:, [0, 2]].max())
        self._depths = np.linspace(-reach, reach, _DEPTHS)
        self._distances: dict[int, tuple[_Distances, _Distances]] = {}

    def add(self, view: int, nodes: list[int]) -> None:
        """Adds what no limb looks like yet of a branch of one view."""
        line = self._graphs[view].points[nodes].astype(np.float64)
        known = self._follow(view, nodes, line)
        along = arc_lengths(line)
        if along[-1] - along[known] < _SHORTEST * self._height and known > 0:
            self._limb_of[view][nodes[known:]] = self._limb_of[view][nodes[known]]
            return
        at, depth = self._find_depth(view, line[known:], int(self._limb_of[view][nodes[known]]))
        new = nodes[known + 1 :]
        place = np.arange(self.count, self.count + len(new))
        self.parent[place] = np.concatenate([[at], place[:-1]])
        self.points[place] = from_plane(line[known + 1 :], depth[1:], self._sights[view])
        self._half_width[view][place] = self._thickness(view, new)
        self._view[place] = view
        self._settled[view][place] = True
        self._limb_of[view][new] = place
        self.count += len(new)
        self._mark_taken(self.points[place])

    def radii(self) -> _Array:
        """Of each node [m], as the view has it that shows it thinnest; NaN where no view shows how thick."""
        points = self.points[: self.count]
        radius = np.full(self.count, np.nan)
        for half, sight in zip(self._half_width, self._sights, strict=True):
            radius = np.fmin(radius, half[: self.count] / growth(points, sight))
        return radius

    def _thickness(self, view: int, nodes: list[int]) -> _Array:
        half = self._graphs[view].half_width
        return np.full(len(nodes), np.nan) if half is None else half[nodes].astype(np.float64)

    def _follow(self, view: int, nodes: list[int], line: _Array) -> int:
        """How many of the branch's nodes lie on the picture of a limb that goes on from the fork's.

        Sets the limb's nodes that they belong to.
        """
        start = int(self._limb_of[view][nodes[0]])
        flat = to_plane(self.points[: self.count], self._sights[view])
        same = _SAME * self._height
        near = np.flatnonzero(
            ((flat > line.min(axis=0) - same) & (flat < line.max(axis=0) + same)).all(axis=1)
        )
        distance, nearest = cKDTree(line).query(flat[near])
        reached = {start: 0}
        for node, off, k in zip(near.tolist(), distance.tolist(), nearest.tolist(), strict=True):
            if node > start and off < same and k >= reached.get(int(self.parent[node]), len(line)):
                reached[node] = k
        end = max(reached, key=lambda node: (reached[node], -node))
        known = reached[end]
        way = [end]
        while way[-1] != start:
            way.append(int(self.parent[way[-1]]))
        way.reverse()
        # Each node of the branch belongs to the first limb's node that has come as far.
        come = np.array([reached[node] for node in way])
        at = np.searchsorted(come, np.arange(known + 1))
        self._limb_of[view][nodes[: known + 1]] = np.array(way)[at]
        # A lighter branch that begins beside a heavier one must neither bend nor thin it.
        fresh = ~self._settled[view][way]
        self._settled[view][way] = True
        self._half_width[view][way] = np.where(
            fresh, self._thickness(view, nodes)[come], self._half_width[view][way]
        )
        self._draw_onto(view, np.array(way)[fresh], line)
        return known

    def _draw_onto(self, view: int, way: NDArray[np.int64], line: _Array) -> None:
        """Shifts limb nodes in depth, as their own view sees it, onto the line that they look like here."""
        right = self._axes[view][0]
        sees = np.array([0.0, *(float(axes[2] @ right) for axes in self._axes)])[self._view[: self.count] + 1]
        movable = (self._view[: self.count] != view) & (np.abs(sees) > _SEES)
        if not movable[way].any():
            return
        there = self._sights[view]
        aside = _height_offset(line, to_plane(self.points[way], there)) / growth(self.points[way], there)
        shift = np.zeros(self.count)
        shift[way] = np.divide(aside, sees[way], out=np.zeros(len(way)), where=movable[way])
        front = way
        done = np.zeros(self.count, np.bool_)
        done[way] = True
        for _ in range(_FADING):  # what grows from there comes along, less and less
            front = np.flatnonzero(~done & done[self.parent[: self.count]] & (self.parent[: self.count] >= 0))
            free = (self._view[front] >= 0) & ~self._settled[view][front]
            shift[front] = _FADE * shift[self.parent[front]] * free
            done[front] = True
        for own, sight in enumerate(self._sights):
            moved = np.flatnonzero((self._view[: self.count] == own) & (shift != 0.0))
            self.points[moved] += shift[moved, None] * lines_of_sight(self.points[moved], sight)

    def _find_depth(self, view: int, line: _Array, fork: int) -> tuple[int, _Array]:
        """Where a line starts, and depth (n,) [m] toward the camera of its points.

        It starts at the fork's limb, or at another one that this view sees before or behind it, where the way
        from there is so much better: a picture does not tell which of two limbs that cross bears a branch.
        """
        toward = self._axes[view][2]
        depths = self._depths
        flat = to_plane(self.points[: self.count], self._sights[view])
        crossing = np.linalg.norm(flat - flat[fork], axis=1) < _SAME * self._height
        starts = np.unique(np.append(np.flatnonzero(crossing), fork))
        begins = np.clip(self.points[starts] @ toward, depths[0], depths[-1])
        shape = (len(line), len(depths))
        place = from_plane(
            np.broadcast_to(line[:, None], (*shape, 2)), np.broadcast_to(depths, shape), self._sights[view]
        )
        price = self._price(view, place)
        step = np.maximum(np.linalg.norm(np.diff(line, axis=0), axis=1), 1e-9)
        gain = np.abs(depths[:, None] - depths[None, :])
        # The first step starts between two depths.
        first = self._change(np.abs(depths[:, None] - begins), step[0], depths)
        first += _OTHER * self._height * (starts != fork)
        start = first.argmin(axis=1)
        total = first[np.arange(len(depths)), start] + step[0] * price[1]
        back = np.zeros((len(line), len(depths)), np.int64)
        for k in range(2, len(line)):
            ways = total[None, :] + self._change(gain, step[k - 1], depths)
            back[k] = ways.argmin(axis=1)
            total = ways[np.arange(len(depths)), back[k]] + step[k - 1] * price[k]
        chosen = [int(total.argmin())]
        for k in range(len(line) - 1, 1, -1):
            chosen.append(int(back[k][chosen[-1]]))
        at = int(start[chosen[-1]])
        depth = np.concatenate([begins[at : at + 1], depths[chosen[::-1]]])
        spacing = float(np.mean(step))
        curve = np.stack([arc_lengths(line), depth], axis=1)
        return int(starts[at]), np.asarray(smooth_polyline(curve, _SMOOTH * self._height / spacing)[:, 1])

    def _change(self, gain: _Array, step: float, depths: _Array) -> _Array:
        """What a change of depth costs over a step of the line."""
        # Depths are too coarse for a short step: the nearest place is always allowed.
        most = max(_FAR * step, float(depths[1] - depths[0]))
        return np.asarray(np.where(gain <= most, _STEEP * gain**2 / max(step, most), np.inf))

    def _price(self, view: int, place: _Array) -> _Array:
        """Cost (n, depths) a metre of a limb at these places (n, depths, 3)."""
        index = (place - self._origin) / self._voxel - 0.5
        solid = map_coordinates(self._solid, index.reshape(-1, 3).T, order=1, mode="constant")
        price = _AIR * (1.0 - solid.reshape(place.shape[:2]))
        price += _OVER * (index[..., 1] > self._solid.shape[1] - 0.5)
        for other in range(len(self._graphs)):
            if other == view or abs(float(self._axes[other][2] @ self._axes[view][2])) > 0.995:
                continue
            flat = to_plane(place.reshape(-1, 3), self._sights[other])
            off = np.full(len(flat), 1.0)
            for lines, least in zip(self._map_distances(other), (0.0, _SHARED), strict=True):
                away = np.maximum(lines.at(flat) / self._height - _ON, 0.0) / (_NEAR - _ON)
                off = np.minimum(off, least + (1.0 - least) * away)
            price += off.reshape(price.shape)
        return np.asarray(price)

    def _mark_taken(self, points: _Array) -> None:
        """Remembers which lines of all views a new limb looks like."""
        for view, graph in enumerate(self._graphs):
            left = np.flatnonzero(~self._taken[view])
            distance = cKDTree(to_plane(points, self._sights[view])).query(graph.points[left])[0]
            self._taken[view][left] = distance < _SAME * self._height
        self._distances.clear()

    def _map_distances(self, view: int) -> tuple[_Distances, _Distances]:
        """How far all places are from the view's lines that no limb has taken, and from the others."""
        if view not in self._distances:
            graph, taken = self._graphs[view], self._taken[view]
            self._distances[view] = (
                _Distances(graph, ~taken, self._height),
                _Distances(graph, taken, self._height),
            )
        return self._distances[view]
