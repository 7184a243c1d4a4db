"""Measures the quad wood: closed, as thick and as heavy as the skeleton, smooth, and how long it takes."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from benchmarks.tree_table import TreeTable, add_options, make_trees
from flowtree import check
from flowtree.geometry.parent_array import child_count, main_child, parents_first
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.geometry.quad_edges import edge_cosines, pair_edges
from flowtree.meshing.connect_ramifications import connect_ramifications
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.meshing.trace_chains import trace_chains
from flowtree.model.mesh import QuadMesh
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

_SHARPEST = 60.0  # [degrees]
_CLEAR = 4.0  # radii from forks, ends and the ground, within which wood is no tube
_STRAIGHT = 0.94  # cosine of 20 degrees: where a line turns by more, it is no place to measure a tube
_TIMED, _ASKED = 2000, {"quads": 3.0, "rings": 0.3}  # branches, and what their wood may take [s]
_SPANNED = 8  # nodes before a quad's own that may be nearer to it
_AT_ONCE = 200_000  # quads whose place is looked up together
_HEAD = (
    ("tree", "tree"),
    ("branches", "branches"),
    ("quads", "quads"),
    ("closed", "one closed surface"),
    ("creases", "edges beyond 60 degrees"),
    ("off_median", "off the radius, median"),
    ("off_most", "95th percentile"),
    ("volume", "volume of the cylinders'"),
    ("seconds", "quads [s]"),
    ("ring_seconds", "rings [s]"),
)

_Array = NDArray[np.float64]
_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class WoodRow:
    """What was measured of one tree's wood.

    Attributes:
        tree: its name.
        branches: of its skeleton.
        quads: of its wood.
        closed: whether it is one closed two-manifold, consistently oriented, with Euler characteristic 2.
        creases: edges whose two quads turn by more than 60 degrees.
        off_median: away from forks, how far the surface is from the skeleton's radius, as a share of it.
        off_most: the same, 95th percentile.
        volume: of the wood there, of that of the skeleton's cones.
        seconds: to make it.
        ring_seconds: to make the plain ring sweep.
    """

    tree: str
    branches: int
    quads: int
    closed: bool
    creases: int
    off_median: float
    off_most: float
    volume: float
    seconds: float
    ring_seconds: float


def main(argv: list[str]) -> int:
    """Prints a table in Markdown; returns 0 where all is closed and 2,000 branches keep to their time."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks wood", description=__doc__)
    add_options(parser)
    parser.add_argument(
        "--runs",
        type=int,
        default=3,
        help="of the largest branches of the first tree, of which the median time counts",
    )
    options = parser.parse_args(argv)
    check.require(options.runs > 0, "--runs", "must be at least 1", options.runs, "give more")
    trees = make_trees(options)
    table = TreeTable(_HEAD, _cell)
    for name, result in trees:
        if not table.rows:
            fewer = keep_largest(result.skeleton, _TIMED)
            table.add(measure_wood(f"{name}, fewer", fewer, options.runs))
        table.add(measure_wood(name, result.skeleton))
    table.end(options.json)
    timed: WoodRow = table.rows[0]
    kept = timed.seconds < _ASKED["quads"] and timed.ring_seconds < _ASKED["rings"]
    print(
        f"{timed.branches} branches: quads {timed.seconds:.2f} s (asked < {_ASKED['quads']:g}),"
        f" rings {timed.ring_seconds:.3f} s (asked < {_ASKED['rings']:g})"
    )
    return 0 if kept and all(row.closed for row in table.rows) else 1


def measure_wood(name: str, skeleton: Skeleton, runs: int = 1) -> WoodRow:
    """Makes the wood of a skeleton with default parameters and compares the two."""
    mesh, seconds = _median_time(lambda: connect_ramifications(skeleton), runs)
    _, ring_seconds = _median_time(lambda: sweep_rings(skeleton), runs)
    positions, quads = mesh.positions.astype(np.float64), mesh.quads.astype(np.int64)
    turn = edge_cosines(positions, quads, *pair_edges(quads))
    # The flare at the foot is wanted, and no fault of the surface.
    plain = connect_ramifications(skeleton, params=MeshingParams(root_flare=0.0))
    off, wanted, area = _compare(plain, skeleton)
    apart = np.abs(off / wanted - 1.0)
    return WoodRow(
        tree=name,
        branches=count_branches(skeleton),
        quads=len(quads),
        closed=is_one_closed_surface(mesh),
        creases=int((turn < np.cos(np.radians(_SHARPEST))).sum()),
        off_median=float(np.median(apart)) if len(apart) else float("nan"),
        off_most=float(np.quantile(apart, 0.95)) if len(apart) else float("nan"),
        # A tube's volume is half the sum of its area times its radius.
        volume=float((area * off).sum() / (area * wanted**2 / off).sum()) if len(off) else float("nan"),
        seconds=seconds,
        ring_seconds=ring_seconds,
    )


def is_one_closed_surface(mesh: QuadMesh) -> bool:
    """Whether every edge is passed once in each direction, and Euler's characteristic is a sphere's."""
    quads, count = mesh.quads.astype(np.int64), len(mesh.positions)
    start, end = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    passed = np.sort(start * count + end)
    closed = np.array_equal(passed, np.sort(end * count + start)) and bool((np.diff(passed) > 0).all())
    whole = bool((np.diff(np.sort(quads, axis=1), axis=1) > 0).all()) and len(np.unique(quads)) == count
    # A vertex where two sheets touch would raise the count of vertices that a sphere needs.
    return closed and whole and count - len(passed) // 2 + len(quads) == 2


def count_branches(skeleton: Skeleton) -> int:
    """Every branch ends in one tip."""
    return int((child_count(skeleton.parent) == 0).sum())


def keep_largest(skeleton: Skeleton, count: int) -> Skeleton:
    """The branches of the most particles, so many; none stays without what bears it."""
    parent, particles = skeleton.parent, skeleton.particles
    first = main_child(parent, particles)[np.maximum(parent, 0)] != np.arange(len(parent))
    first[0] = True
    branch = np.zeros(len(parent), np.int64)  # the node at which each node's branch begins
    for node in range(len(parent)):
        branch[node] = node if first[node] else branch[parent[node]]
    starts = np.flatnonzero(first)
    # Of equally many particles the one nearer to the root has the lower number.
    kept = starts[np.lexsort((starts, -particles[starts]))][:count]
    rows = np.flatnonzero(np.isin(branch, kept))
    number = np.full(len(parent), -1)
    number[rows] = np.arange(len(rows))
    above = np.where(parent[rows] >= 0, number[np.maximum(parent[rows], 0)], -1)
    order, joined = parents_first(above)
    rows = rows[order]
    return Skeleton(
        parent=joined.astype(np.int32),
        points=skeleton.points[rows],
        radius=skeleton.radius[rows],
        particles=particles[rows],
        level=skeleton.level[rows],
        twig=skeleton.twig[rows],
    )


def _compare(mesh: QuadMesh, skeleton: Skeleton) -> tuple[_Array, _Array, _Array]:
    """Of quads away from forks: distance to the skeleton's line, its radius there [m], their area [m²]."""
    parent = skeleton.parent.astype(np.int64)
    points, radius = skeleton.points.astype(np.float64), skeleton.radius.astype(np.float64)
    corner = mesh.positions.astype(np.float64)[mesh.quads]
    middle = corner.mean(axis=1)
    area = 0.5 * np.linalg.norm(np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]), axis=1)
    carrier = mesh.node.astype(np.int64)[mesh.quads[:, 0]]
    # Nearest on the branch that carries it: the node's segment, that behind it, and some before it, since a
    # quad bears the highest of the nodes that its control ring spans.
    following = _goes_on(skeleton)
    # A side branch begins as thick as it is, not as its host.
    first = np.where(following[parent] == np.arange(len(parent)), radius[parent], radius)
    before = np.where((following[parent] == np.arange(len(parent))) & (parent > 0), parent, -1)
    looked_at = [following[carrier], carrier]
    for _ in range(_SPANNED):
        looked_at.append(np.where(looked_at[-1] > 0, before[looked_at[-1]], -1))
    off = np.full(len(middle), np.inf)
    wanted = np.ones(len(middle))
    for node in looked_at:
        for begin in range(0, len(middle), _AT_ONCE):
            rows = np.arange(begin, min(begin + _AT_ONCE, len(middle)))
            rows = rows[node[rows] > 0]
            end, start = node[rows], parent[node[rows]]
            share, nearest = nearest_on_segments(middle[rows], points[start], points[end])
            distance = np.linalg.norm(nearest - middle[rows], axis=1)
            nearer = distance < off[rows]
            taken = rows[nearer]
            off[taken] = distance[nearer]
            wanted[taken] = (first[end] + share * (radius[end] - first[end]))[nearer]
    clear = _stands_clear(skeleton, mesh, carrier, middle, wanted)
    return off[clear], wanted[clear], area[clear]


def _stands_clear(
    skeleton: Skeleton, mesh: QuadMesh, carrier: _Ints, middle: _Array, wanted: _Array
) -> NDArray[np.bool_]:
    """Quads far from where a branch leaves another, from tips, from bends and from the ground."""
    parent, points = skeleton.parent.astype(np.int64), skeleton.points.astype(np.float64)
    stretch = np.arange(len(parent))  # the node at which the branch of each begins
    following = _goes_on(skeleton)
    for node in range(1, len(parent)):
        if following[parent[node]] == node and parent[node] > 0:
            stretch[node] = stretch[parent[node]]
    one, two = (corner // 4 for corner in pair_edges(mesh.quads.astype(np.int64)))
    seam = np.flatnonzero(stretch[carrier[one]] != stretch[carrier[two]])
    ends = [(middle[one[seam]], np.minimum(wanted[one[seam]], wanted[two[seam]]))]
    tips = np.flatnonzero(child_count(parent) == 0)
    ends.append((points[tips], skeleton.radius[tips]))
    way = points - points[np.maximum(parent, 0)]
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-12)
    bends = np.flatnonzero(
        (np.einsum("ij,ij->i", way, way[np.maximum(parent, 0)]) < _STRAIGHT) & (parent > 0)
    )
    ends.append((points[parent[bends]], skeleton.radius[parent[bends]]))
    places, radii = (np.concatenate(part) for part in zip(*ends, strict=True))
    distance, nearest = cKDTree(places).query(middle)
    clear = distance > _CLEAR * radii[nearest]
    return np.asarray(clear & (middle[:, 1] > _CLEAR * skeleton.radius[0]))


def _goes_on(skeleton: Skeleton) -> _Ints:
    """(n,) the node that carries each one's branch on, as the wood has it; -1 at tips."""
    chains = trace_chains(skeleton)
    begins = np.diff(chains.chain, prepend=0) > 0  # with a copy of the node that it leaves
    rows = np.flatnonzero((chains.chain[1:] == chains.chain[:-1]) & ~begins[:-1])
    following = np.full(len(skeleton.parent), -1)
    following[chains.node[rows]] = chains.node[rows + 1]
    return following


def _median_time(work: Callable[[], Any], runs: int) -> tuple[Any, float]:
    seconds = []
    for _ in range(runs):
        start = time.perf_counter()
        result = work()
        seconds.append(time.perf_counter() - start)
    return result, median(seconds)


def _cell(value: str | bool | int | float) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.3f}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else value
