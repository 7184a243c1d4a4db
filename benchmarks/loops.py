"""Times the hot loops beside the particles: each kernel against the library call that it replaces."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from benchmarks.cases import Case, print_cases, time_programs, write_report
from benchmarks.peers.cast_rays_numpy import cast_rays_numpy
from benchmarks.peers.choose_cover_scipy import choose_cover_scipy
from benchmarks.peers.fit_depths_scipy import fit_depths_scipy
from benchmarks.peers.sweep_rings_numpy import place_numpy
from flowtree import check
from flowtree import device as devices
from flowtree.attraction.build_direction_field import build_direction_field
from flowtree.density.fit_depths import fit_depths
from flowtree.density.footprint_matrix import footprint_matrix
from flowtree.density.solve_density import solve_density
from flowtree.geometry.choose_cover import choose_cover
from flowtree.geometry.cover_canvas import lay_canvas
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.field import DirectionField
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume
from flowtree.params import DensityParams, FieldParams
from flowtree.render.assemble_scene import Scene
from flowtree.render.cast_scene import ParallelView, RayHits, cast_scene

#: Relative residual to which densities are solved, and what that may take by voxels along the height [s].
RESIDUAL, SOLVE_SECONDS = 1e-3, {64: 0.5, 128: 4.0}

_VIEWS = {64: (10.0, 75.0), 128: (5.0, 50.0, 99.0, 140.0)}  # angles at which nothing falls into place
_ROUNDS = 200
_OTHERWISE = 0.01  # share of leaves about which two programs may decide differently


def main(argv: list[str]) -> int:
    """Prints medians; returns 0 where all results are right and the densities keep to `SOLVE_SECONDS`."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks loops", description=__doc__)
    parser.add_argument("--runs", type=int, default=5, help="of which the median counts")
    parser.add_argument("--json", type=Path, metavar="FILE", help="the same numbers as a file")
    options = parser.parse_args(argv)
    cases = time_loops(runs=options.runs)
    print_cases(cases)
    if options.json is not None:
        write_report(cases, options.json)
    slow = [c for c in cases if c.case == "solve_density" and c.median_s > SOLVE_SECONDS.get(c.size, np.inf)]
    return 0 if all(c.valid for c in cases) and not slow else 1


def time_loops(
    *,
    runs: int,
    sides: Sequence[int] = tuple(_VIEWS),
    cells: int = 100,
    branches: int = 20_000,
    leaves: int = 20_000,
    size: int = 384,
    things: int = 70_000,
) -> list[Case]:
    """All hot loops, kernel and library in turn in this process, each result compared before its time counts.

    Args:
        runs: how often each is timed.
        sides: voxels along the height of a volume.
        cells: along a side of a direction field.
        branches: of the tree whose rings are swept.
        leaves: of the scene at which rays are cast.
        size: of its picture [pixels].
        things: leaves of which some are chosen.
    """
    check.require(runs > 0, "--runs", "must be at least 1", runs, "give more")
    cases = []
    for side in sides:
        cases += _time_density(side, _VIEWS[128] if side > 64 else _VIEWS[64], runs)
    cases += _time_field(cells, runs) + _time_rings(branches, runs)
    return cases + _time_rays(leaves, size, runs) + _time_cover(things, runs)


def _time_density(side: int, yaws: tuple[float, ...], runs: int) -> list[Case]:
    """The fit alone against SciPy's, then the whole call from exact mattes."""
    shares, depths = _crown(side, yaws)
    device = devices.pick_device()

    def relative(fitted: NDArray[np.float32]) -> bool:
        if fitted.ndim == 3:  # blocks of heights
            fitted = fitted.swapaxes(0, 1).reshape(fitted.shape[1], -1)[:, :side]
        rest = [m @ fitted - d for m, d in zip(shares, depths, strict=True)]
        reached = np.linalg.norm(np.concatenate(rest)) <= RESIDUAL * np.linalg.norm(np.concatenate(depths))
        return bool(reached and (fitted >= 0).all())

    stop = {"iterations": _ROUNDS, "tolerance": RESIDUAL}
    singles = [d.astype(np.float32) for d in depths]
    fits = {
        "flowtree": lambda: fit_depths(shares, singles, least=0.0, device=device, **stop),
        "scipy": lambda: fit_depths_scipy(shares, singles, **stop),
    }
    cases = time_programs("fit_depths", side, fits, validate=relative, runs=runs)

    columns = depths[0].shape[0]
    pictures = [-np.expm1(-d).T[::-1].astype(np.float32) for d in depths]
    mattes = [Matte(p, np.zeros((*p.shape, 3), np.uint8), "exact") for p in pictures]
    cameras = [Camera(yaw, 1.0 / side, (columns / 2, float(side)), columns, side) for yaw in yaws]

    def whole(volume: DensityVolume) -> bool:
        """The volume may be a voxel wider than the crown, at equal voxels."""
        nx, ny, nz = volume.density.shape
        centres = volume.origin[0] + (np.arange(nx) + 0.5) * volume.voxel
        grid = {"left": -columns / 2 / side, "cell": 1.0 / side, "columns": columns}
        flat = volume.density.transpose(0, 2, 1).reshape(nx * nz, ny)[:, :side].astype(np.float64)
        rest = [
            footprint_matrix(centres.astype(np.float64), centres.astype(np.float64), yaw, **grid) @ flat - d
            for yaw, d in zip(yaws, depths, strict=True)
        ]
        reached = np.linalg.norm(np.concatenate(rest)) <= RESIDUAL * np.linalg.norm(np.concatenate(depths))
        return bool(reached and (volume.density >= 0).all())

    params = DensityParams(resolution=side, tolerance=RESIDUAL)
    call = {"flowtree": lambda: solve_density(mattes, cameras, params=params)}
    return cases + time_programs("solve_density", side, call, validate=whole, runs=runs)


def _crown(side: int, yaws: tuple[float, ...]) -> tuple[list[Any], list[NDArray[np.float64]]]:
    """Shares and depths of a loose crown that fills a cube of ``side`` voxels of edge 1 / side."""
    centres = (np.arange(side) + 0.5 - side / 2) / side
    columns = 2 * int(np.ceil(side / 2 * np.sqrt(2.0))) + 2
    grid = {"left": -columns / 2 / side, "cell": 1.0 / side, "columns": columns}
    shares = [footprint_matrix(centres, centres, yaw, **grid) * side for yaw in yaws]
    x, z, y = np.meshgrid(centres, centres, centres, indexing="ij")
    inside = np.hypot(np.hypot(x, z), y) < 0.5
    rng = np.random.default_rng(0)
    depth = np.where(inside & (rng.random(x.shape) < 0.6), 5.0 / side, 0.0)
    depth[side // 2, side // 2, -1] = 1.0  # the top is seen
    return shares, [m @ depth.reshape(side * side, side) for m in shares]


def _time_field(cells: int, runs: int) -> list[Case]:
    """A direction field, the nearest segment of each cell found by the kernel or by SciPy's k-d tree."""
    tree = _branches(400, nodes=2)
    graph = AttractorGraph(tree.parent, np.ascontiguousarray(tree.points[:, :2]))
    camera, params = Camera(0.0, 0.01, (0.0, 0.0), 1, 1), FieldParams(resolution=cells)
    expected = build_direction_field(graph, camera, params=params)

    def by_tree(centres: Any, starts: Any, ends: Any, device: str) -> NDArray[np.int64]:
        """Of the 8 pieces whose middles are nearest the nearest: pieces are short, so it is hardly missed."""
        del device
        length = np.linalg.norm(ends - starts, axis=1)
        number = np.maximum(1, np.ceil(length / (0.008 * np.ptp(ends, axis=0).max()))).astype(int)
        owner = np.repeat(np.arange(len(starts)), number)
        step = np.arange(len(owner)) - np.repeat(np.cumsum(number) - number, number)
        low, high = ((step + k) / number[owner] for k in (0, 1))
        along = (ends - starts)[owner]
        low, high = starts[owner] + low[:, None] * along, starts[owner] + high[:, None] * along
        _, near = cKDTree(0.5 * (low + high)).query(centres, k=8)
        _, place = nearest_on_segments(centres[:, None], low[near], high[near])
        best = ((place - centres[:, None]) ** 2).sum(axis=2).argmin(axis=1)
        return np.asarray(owner[near[np.arange(len(near)), best]])

    def with_tree() -> DirectionField:
        with patch("flowtree.attraction.build_direction_field._search", by_tree):
            return build_direction_field(graph, camera, params=params)

    def same(field: DirectionField) -> bool:
        """Halfway between two branches either may be the nearest."""
        return bool((np.abs(field.vectors - expected.vectors).max(axis=2) < 1e-3).mean() > 0.99)

    programs = {
        "flowtree": lambda: build_direction_field(graph, camera, params=params),
        "scipy": with_tree,
    }
    return time_programs("direction_field", cells * cells, programs, validate=same, runs=runs)


def _time_rings(branches: int, runs: int) -> list[Case]:
    """The wood's surface, its frames and vertices by kernels or by NumPy; the rest of it is NumPy in both."""
    skeleton = _branches(branches)
    wood = sweep_rings(skeleton)

    def numpy_rings() -> TreeMesh:
        with patch("flowtree.meshing.sweep_rings._place", place_numpy):
            return sweep_rings(skeleton)

    def same(mesh: TreeMesh) -> bool:
        parts = ("positions", "normals", "uvs", "tangents", "triangles")
        return all(np.allclose(getattr(mesh, p), getattr(wood, p), atol=1e-5) for p in parts)

    programs = {"flowtree": lambda: sweep_rings(skeleton), "numpy": numpy_rings}
    return time_programs("sweep_rings", branches, programs, validate=same, runs=runs)


def _branches(count: int, nodes: int = 6) -> Skeleton:
    """A trunk and branches of ``nodes`` nodes on branches, in three orders."""
    rng = np.random.default_rng(0)
    orders = [1, 1 + count // 500, 1 + count // 20]
    orders.append(max(1, count - sum(orders)))
    parent, points, radius = [np.array([-1])], [np.zeros((1, 3))], [np.array([0.3])]
    low, high = 0, 1  # the nodes of the order before
    for order, number in enumerate(orders):
        base = rng.integers(low, high, number)
        first = high + nodes * np.arange(number)
        before = first[:, None] + np.arange(-1, nodes - 1)
        before[:, 0] = base
        steps = rng.normal(size=(number, 1, 3)) + 0.3 * rng.normal(size=(number, nodes, 3)) + [0, 1, 0]
        place = np.concatenate(points)[base][:, None] + np.cumsum(steps * 0.3 / 2**order, axis=1)
        thick = 0.3 / 4**order * np.linspace(1.0, 0.6, nodes)
        parent.append(before.ravel())
        points.append(place.reshape(-1, 3))
        radius.append(np.tile(thick, number))
        low, high = high, high + nodes * number
    n = high
    return Skeleton(
        np.concatenate(parent).astype(np.int32),
        np.concatenate(points).astype(np.float32),
        np.concatenate(radius).astype(np.float32),
        np.ones(n, np.int32),
        np.zeros(n, np.int32),
        np.zeros(n, np.bool_),
    )


def _time_rays(leaves: int, size: int, runs: int) -> list[Case]:
    """Rays at leaves with holes and a few large triangles, by the kernel or by a rasteriser in NumPy."""
    scene = _leaves(leaves)
    view = ParallelView(np.eye(3), 1.0 / size, (size / 2, float(size)), size, size, 2)
    corner, side = cast_scene(scene, view).corner, 2 * size
    expected = cast_rays_numpy(scene, corner, side, side, 2)

    def same(hits: RayHits | NDArray[np.int32]) -> bool:
        """Float32 may place a ray on the other side of an edge that it almost meets."""
        hit = hits.hit if isinstance(hits, RayHits) else hits
        return bool((hit == expected).mean() > 0.999 and expected.any())

    programs = {
        "flowtree": lambda: cast_scene(scene, view),
        "numpy": lambda: cast_rays_numpy(scene, corner, side, side, 2),
    }
    return time_programs("cast_rays", len(scene.triangles), programs, validate=same, runs=runs)


def _leaves(count: int) -> Scene:
    """Squares of about 13 mm in a ball of 1 m, a third of their texture holes, and ten solid triangles."""
    rng = np.random.default_rng(0)
    middle = rng.normal(size=(count, 3))
    middle *= 0.45 * rng.random((count, 1)) ** (1 / 3) / np.linalg.norm(middle, axis=1, keepdims=True)
    across, along = 0.0065 * rng.normal(size=(2, count, 3))
    square = [middle + i * across + j * along for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    large = rng.uniform(-0.4, 0.4, (30, 3))
    positions = np.concatenate([large, np.stack(square, axis=1).reshape(-1, 3)]) + np.array([0, 0.5, 0])
    of_large = np.arange(30).reshape(10, 3)
    of_leaves = 30 + 4 * np.arange(count)[:, None, None] + np.array([[0, 1, 2], [0, 2, 3]])
    uvs = np.concatenate([np.zeros((30, 2)), np.tile([[0, 0], [1, 0], [1, 1], [0, 1]], (count, 1))])
    return Scene(
        positions=positions.T.astype(np.float32),
        normals=np.zeros((3, len(positions)), np.float32),
        uvs=uvs.astype(np.float32),
        colors=np.ones((len(positions), 3), np.float32),
        triangles=np.concatenate([of_large, of_leaves.reshape(-1, 3)]).astype(np.int32),
        wood_vertices=30,
        wood_triangles=10,
        bark=Material("bark", np.zeros((1, 1, 3), np.uint8)),
        leaf=None,
        alpha=(np.arange(64).reshape(8, 8) % 3 > 0).astype(np.float32),
        cutoff=0.5,
    )


def _time_cover(things: int, runs: int) -> list[Case]:
    """Which of many leaves stay, so that two views show what their mattes want."""
    random = np.random.default_rng(7)
    side, metres = 256, 10.0
    cameras = [Camera(yaw, metres / side, (side / 2, float(side)), side, side) for yaw in (0.0, 90.0)]
    rows, columns = np.indices((side, side)) / side
    alpha = np.where((rows - 0.45) ** 2 + (columns - 0.5) ** 2 < 0.16, 0.75 - 0.5 * rows, 0.0)
    canvases = [lay_canvas(alpha.astype(np.float32), None, camera, cell=metres / 64) for camera in cameras]
    centre = random.uniform((-4.0, 1.5, -4.0), (4.0, 9.5, 4.0), (things, 3))
    along, across = random.normal(0.0, 0.08, (2, things, 3))
    area = np.full(things, 0.5 * 0.16**2)
    covers = [canvas.patch_covers(centre, along, across, area, samples=(4, 3)) for canvas in canvases]
    given = {"batch": random.integers(0, 32, things), "chance": random.random(things)}
    chosen = choose_cover(canvases, covers, **given)

    def same(kept: NDArray[np.bool_]) -> bool:
        # Sums in another order decide otherwise about few, and later ones see those.
        return bool((kept != chosen).mean() < _OTHERWISE)

    programs = {
        "flowtree": lambda: choose_cover(canvases, covers, **given),
        "scipy": lambda: choose_cover_scipy(canvases, covers, **given),
    }
    return time_programs("choose_cover", things, programs, validate=same, runs=runs)
