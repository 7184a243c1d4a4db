"""Livewire attractor graphs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from scipy.spatial import cKDTree
from skimage.graph import MCP_Geometric

from flowtree import check
from flowtree.attraction.attach_strokes import attach_strokes
from flowtree.attraction.choose_seeds import choose_seeds
from flowtree.attraction.cover_limbs import cover_limbs
from flowtree.attraction.cut_working_grid import cut_working_grid
from flowtree.attraction.grow_paths import grow_paths
from flowtree.attraction.growing_tree import GrowingTree
from flowtree.attraction.measure_limbs import measure_limbs
from flowtree.attraction.outline_crown import CrownOutline, outline_crown
from flowtree.attraction.shape_branches import shape_branches
from flowtree.attraction.stem_likeness import stem_likeness
from flowtree.attraction.weigh_habit import weigh_habit
from flowtree.attraction.weigh_structures import weigh_structures
from flowtree.geometry.polylines import drop_repeats, subdivide_polyline
from flowtree.geometry.projection import pixels_to_plane
from flowtree.model.attractor import AttractorGraph, Habit
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.params import AttractionParams

_CROWDED = 0.03  # of the height: an automatic seed this near to a drawn branch would only double it
_STUB = 0.055  # of the height: shorter automatic branches are noise of the outline
_WOOD = 0.8  # likeness to the stem's colour from which a thin part of a leafy tree is a limb
_THIN = 0.02  # of the height: half width up to which it is thin
_LIMB = 0.0035  # of the height: half width of the thinnest limb followed
_LONE = 0.002  # of the height: the same of a limb with nothing around it, with its leaves
_AROUND = 0.03  # of the height: sigma of what counts as around it
_OPEN = 0.35  # mean alpha around, up to which it stands alone
_UPRIGHT_MERGING = 0.4  # times the merging: limbs of an upright crown stay apart
_GROUND = 0.06  # of the height: no limb ends lower
_BARRED = 10.0  # times dearer: beside the stem below a given first fork
_TOUCHED = 1.0  # cells: a node as near as this to a brush stroke lies on it
_CLOSED = 1e4  # times dearer: that stem itself, so that no other path joins it

_Array = NDArray[np.float64]


def trace_attractor_graph(
    photo: Photo,
    matte: Matte,
    camera: Camera,
    *,
    strokes: Sequence[ArrayLike] = (),
    seeds: ArrayLike | None = None,
    target: tuple[float, float] | None = None,
    leafy: bool = True,
    habit: Habit = "spreading",
    params: AttractionParams = AttractionParams(),
    seed: int = 0,
) -> AttractorGraph:
    """Traces the main branches visible in one view by livewire (Particle Flows, section 4).

    Unlike the paper, the seeds are spread over the silhouette (``params.seed_mode`` "random" is the paper's
    way), later paths are drawn to earlier ones, and the graph is smoothed: a path of pixels turns by 45
    degrees at every step. Where picture and matte show no branches the crown's depth and a weak random
    disturbance decide, which gives a plain skeleton of that crown.

    Args:
        photo: the picture.
        matte: of the same size.
        camera: of the view; only its foot and scale are used.
        strokes: polylines (k, 2) [working pixels] that become branches exactly as drawn, those of a brush
            (k, 3) with its width, which is then the branch's. With ``params.automatic`` off they and
            ``seeds``, where there are any, are the whole graph.
        seeds: (n, 2) [working pixels], besides the ``params.seed_count`` automatic ones.
        target: (x, y) [working pixels] of the stem's first fork, to which all paths lead; the stem from the
            foot passes exactly through it. None is the foot.
        leafy: whether the tree bears leaves. Limbs that show are all traced, those of a bare tree by the
            matte alone, of a leafy one where they are thin and have the stem's colour or nothing around them.
        habit: a conifer has one straight leader, a palm one shoot; an upright crown's limbs part low; a
            weeping crown's climb before they hang.
        params: see `AttractionParams`.
        seed: of the random seeds and the disturbance; same seed, same bytes.

    Returns: nodes at most about 1.5 % of the tree's height apart; the root at (0, 0).

    Raises:
        InputError: an empty matte, a size that differs from the photo's, a stroke of one point, seeds or
            target outside the picture, a target not above the foot, NaN, nothing to trace at all.
    """
    drawn = [_line(stroke, k) for k, stroke in enumerate(strokes)]
    lines = [line[:, :2] for line in drawn]
    given = _inside(np.zeros((0, 2)) if seeds is None else seeds, camera, "seeds")
    fork = None if target is None else _inside([target], camera, "target")[0]
    if fork is not None:
        check.require(
            fork[1] < camera.foot[1],
            "target",
            f"must lie above the foot (row {camera.foot[1]:g})",
            f"a first fork in row {fork[1]:g}",
            "give another, or the foot, too",
        )
    by_hand = bool(lines) or len(given) > 0
    automatic = params.seed_count if params.automatic or not by_hand else 0
    check.require(
        by_hand or automatic > 0,
        "seeds",
        "need at least one seed or stroke",
        "none",
        "raise attraction.seed_count, or draw a stroke",
    )
    rng = np.random.default_rng(seed)
    marks = np.concatenate([[camera.foot], given, *lines, *([] if fork is None else [fork[None, :]])])
    grid = cut_working_grid(photo, matte, marks, params.grid_height)
    foot = grid.to_cells([camera.foot])[0]
    tree = GrowingTree(grid, foot)
    root = tree.cell_of(foot)
    crown = outline_crown(grid, root[0])
    wood = stem_likeness(grid, crown)
    widths = measure_limbs(matte, grid.tall / grid.scale)
    middle, half = widths.on_grid(grid)
    # Of a leafy tree only what has the stem's colour and is thin is sure to be no leaves.
    thin = (half > 0.0) & (half < _THIN)
    shown = (wood > _WOOD) & (half < _THIN) if leafy else np.ones(wood.shape, np.bool_)
    cost = weigh_structures(grid, crown, rng, wood, None if leafy else (middle, half))
    cost *= weigh_habit(grid, crown, habit, foot[0]) if leafy else 1.0
    goal = root
    if fork is not None:
        place = grid.to_cells(fork[None, :])[0]
        goal = tree.cell_of(place)
        cost = _raise_stem(tree, cost, root, place, grid.tall)
    attach_strokes(tree, cost, [grid.to_cells(line) for line in lines], tall=grid.tall)
    if automatic > 0:
        # What begins at the ground is grass or roots.
        above = np.arange(grid.alpha.shape[0])[:, None] < root[0] - _GROUND * grid.tall
        limb = shown & above & (middle > 0.0)
        thick = half > _LIMB
        if leafy:  # among leaves only what has the stem's colour is a limb, but before the sky every strand
            lone = thin & above & (ndimage.gaussian_filter(grid.alpha, _AROUND * grid.tall) < _OPEN)
            limb, thick = limb | lone, np.where(lone, half > _LONE, thick)
        cover_limbs(tree, cost, np.where(limb & thick, middle, 0.0), limb, target=goal, tall=grid.tall)
    found = choose_seeds(
        grid, crown, count=automatic, mode=params.seed_mode, rng=rng, hanging=habit == "weeping"
    )
    found = _away_from_strokes(found, tree, _CROWDED * grid.tall)
    main = 1 if habit in ("conifer", "palm") else _limb_count(crown)
    merging = params.merging * (_UPRIGHT_MERGING if habit == "upright" else 1.0)
    for cells, shortest in ((grid.cell_at(grid.to_cells(given)), 0.0), (found, _STUB)):
        grow_paths(
            tree,
            cost,
            cells,
            target=goal,
            tall=grid.tall,
            limbs=main,
            merging=merging,
            shortest=shortest,
        )
    if len(tree.parent) == 1:  # a tree of so few pixels that no path is long enough: a stem without branches
        tree.add(0, foot - [0.0, grid.tall], drawn=False)
    # A path may run a cell beside the limb that it follows.
    beside = ndimage.binary_dilation(thin, np.ones((3, 3), np.bool_))
    parent, points = shape_branches(tree, grid.tall, lowest=int(tree.node_at[goal]), shown=beside)
    pixels = grid.to_pixels(points)
    plane = pixels_to_plane(pixels, camera).astype(np.float32)
    plane[0] = 0.0  # exactly: rounding is no part of the foot
    width = np.where(shown[tuple(grid.cell_at(points).T)], widths.at(pixels), np.nan)
    width = _brushed(width, pixels, drawn, _TOUCHED / grid.scale)
    return AttractorGraph(parent, plane, (width * camera.metres_per_pixel).astype(np.float32))


def _line(stroke: ArrayLike, number: int) -> _Array:
    thing = f"stroke {number}"
    columns = 3 if np.ndim(stroke) == 2 and np.shape(stroke)[1] == 3 else 2
    line = drop_repeats(check.array(stroke, thing, shape=(None, columns), dtype=np.float64))
    check.require(
        len(line) >= 2, thing, "needs two different points", f"{len(line)}", "draw it longer or leave it out"
    )
    return line


def _brushed(width: _Array, pixels: _Array, drawn: Sequence[_Array], near: float) -> _Array:
    """The half widths (n,) [pixels], those of brush strokes where nodes (n, 2) [pixels] lie on one."""
    for line in drawn:
        if line.shape[1] > 2:
            path = subdivide_polyline(line[:, :2], near)
            distance, _ = cKDTree(path).query(pixels)
            width = np.where(distance <= near, 0.5 * line[0, 2], width)
    return width


def _inside(points: ArrayLike, camera: Camera, thing: str) -> _Array:
    flat = check.array(points, thing, shape=(None, 2), dtype=np.float64)
    inside = ((flat >= 0.0) & (flat <= (camera.width, camera.height))).all(axis=1)
    check.require(
        bool(inside.all()),
        thing,
        f"must lie inside the picture of {camera.width} x {camera.height} pixels",
        flat[~inside][:1].tolist(),
        "give (x, y) in pixels of the working picture",
    )
    return np.asarray(flat, np.float64)


def _limb_count(crown: CrownOutline) -> int:
    """A spire has one leader; the rounder a crown, the more main limbs."""
    return 1 if crown.narrowness > 0.5 else 4


def _raise_stem(tree: GrowingTree, cost: _Array, root: tuple[int, int], fork: _Array, tall: float) -> _Array:
    """Joins the first fork to the foot and returns the costs that keep other paths off this stem."""
    goal = tree.cell_of(fork)
    search = MCP_Geometric(cost)
    search.find_costs([root], [goal])
    path = search.traceback(goal)
    node = tree.add_path(path[:-1])
    if goal != root:
        tree.add(node, fork, drawn=True)
    stem = np.zeros(cost.shape, np.bool_)
    stem[tuple(np.array(path).T)] = True
    rows, columns = np.indices(cost.shape)
    from_fork = np.hypot(rows - goal[0], columns - goal[1])
    near = (ndimage.distance_transform_edt(~stem) < 0.03 * tall) & (from_fork > 0.03 * tall)
    stem[goal] = False
    return np.where(stem, _CLOSED, np.where(near, _BARRED, 1.0)) * cost


def _away_from_strokes(seeds: NDArray[np.intp], tree: GrowingTree, apart: float) -> NDArray[np.intp]:
    drawn = np.array(tree.points)[1:][tree.drawn[1:]]
    if len(drawn) == 0 or len(seeds) == 0:
        return seeds
    distance = np.linalg.norm((seeds[:, None, ::-1] + 0.5) - drawn[None, :, :], axis=2).min(axis=1)
    return np.asarray(seeds[distance > apart])
