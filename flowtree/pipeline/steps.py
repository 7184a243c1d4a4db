"""Fits the stages' functions to the table, from the values on the board to their arguments: from placing on.

To import them takes as long as to cut out two photographs: that is done meanwhile (see `load_steps`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.bend_direction_field import bend_direction_field
from flowtree.attraction.build_direction_field import build_direction_field
from flowtree.attraction.build_limb_field import build_limb_field
from flowtree.attraction.clear_painted import clear_painted, lead_painted
from flowtree.attraction.judge_habit import judge_habit
from flowtree.attraction.lift_graphs import lift_graphs
from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.branches.bound_radii import bound_radii
from flowtree.branches.build_skeleton import build_skeleton
from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.branches.fit_exponent import fit_exponent
from flowtree.branches.grow_twigs import grow_twigs
from flowtree.branches.measure_trunk import measure_trunk
from flowtree.branches.patch_skeleton import Patch, patch_skeleton
from flowtree.branches.shape_twigs import TwigShapes
from flowtree.branches.turn_twigs import turn_twigs
from flowtree.density.look_between import look_between
from flowtree.density.solve_density import solve_density
from flowtree.flow.trace_particles import trace_particles
from flowtree.foliage.patch_leaves import patch_leaves
from flowtree.foliage.pick_leaf import pick_leaf
from flowtree.foliage.place_leaves import place_leaves
from flowtree.foliage.spread_colors import spread_colors
from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.geometry.read_color import read_color
from flowtree.matting.judge_leafy import judge_leafy
from flowtree.matting.paint_matte import paint_matte
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.light_bark import light_bark
from flowtree.meshing.load_bark import load_bark
from flowtree.meshing.measure_bark import measure_bark
from flowtree.meshing.paint_bark import paint_bark
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.asset import TreeAsset
from flowtree.model.attractor import AttractorGraph, Habit, LimbTree
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import DirectionField, LimbField
from flowtree.model.foliage import Foliage
from flowtree.model.guessed_view import GuessedView
from flowtree.model.marks import ViewMarks
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.model.skeleton import Skeleton
from flowtree.model.traces import FlowTraces
from flowtree.model.tree import TreeModel
from flowtree.model.volume import DensityVolume
from flowtree.photos.complete_mattes import complete_mattes
from flowtree.photos.place_views import place_views
from flowtree.photos.straighten_lines import straighten_lines
from flowtree.photos.straighten_view import straighten_view
from flowtree.pipeline.compare_views import check_same_tree
from flowtree.pipeline.cut_trunk import cut_trunk
from flowtree.pipeline.equip_tree import equip_tree
from flowtree.pipeline.photo_steps import Polylines
from flowtree.pipeline.register_views import register_views
from flowtree.pipeline.stage import Job
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou

_WIDER = 1.4  # views of one trunk differ less
_MASK_HEIGHT = 256  # [pixels]


def run_placing(
    job: Job,
    photos: tuple[Photo, ...],
    mattes: tuple[Matte, ...],
    marks: tuple[ViewMarks, ...],
    yaws: tuple[float, ...],
    heights: tuple[float, ...],
) -> tuple[Placement, ...]:
    """Where the tree stands in each photograph, from all of them together."""
    return place_views(photos, mattes, marks, yaws=yaws, height=heights[0], params=job.params.align)


def run_registering(
    job: Job, mattes: tuple[Matte, ...], placements: tuple[Placement, ...], heights: tuple[float, ...]
) -> tuple[Placement, ...]:
    """The same, corrected until the views agree."""
    return register_views(mattes, placements, height=heights[0], device=job.device)


def run_framing(
    job: Job,
    photo: Photo,
    matte: Matte,
    edit: PaintedEdit,
    placement: Placement,
) -> tuple[Photo, Matte, PaintedEdit, Camera]:
    """One view's level, parallel picture of the tree."""
    del job
    return *straighten_view(photo, matte, edit, placement), placement.camera


def run_lines(
    job: Job, strokes: Polylines, marks: ViewMarks, placement: Placement
) -> tuple[Polylines, ViewMarks]:
    """What was drawn and pointed at, in that picture."""
    del job
    return straighten_lines(strokes, marks, placement)


def run_completing(
    job: Job, mattes: tuple[Matte, ...], placements: tuple[Placement, ...]
) -> tuple[Matte, ...]:
    """Mattes with what their photographs' frames cut off."""
    del job
    return complete_mattes(mattes, placements)


def run_retouching(job: Job, matte: Matte, edit: PaintedEdit) -> Matte:
    """One matte with what a person painted."""
    del job
    return paint_matte(matte, edit)


def run_density(
    job: Job,
    photos: tuple[Photo, ...],
    mattes: tuple[Matte, ...],
    bare: tuple[Matte, ...],
    cameras: tuple[Camera, ...],
    placements: tuple[Placement, ...],
    heights: tuple[float, ...],
) -> DensityVolume:
    """The volume that all views agree on."""
    check_same_tree([photo.name for photo in photos], mattes, cameras, height=heights[0])
    return solve_density(
        mattes,
        cameras,
        habits=bare,
        height=heights[0],
        loose=any(placement.open for placement in placements),
        params=job.params.density,
        device=job.device,
    )


def run_between(
    job: Job, volume: DensityVolume, cameras: tuple[Camera, ...], placements: tuple[Placement, ...]
) -> tuple[GuessedView, ...]:
    """How the volume looks from between the photographs."""
    del job
    return look_between(volume, cameras, loose=any(placement.open for placement in placements))


def run_attraction(
    job: Job,
    photo: Photo,
    matte: Matte,
    camera: Camera,
    strokes: Polylines,
    marks: ViewMarks,
    leafy: bool,
    habit: Habit,
) -> AttractorGraph:
    """The attractor graph of one view, steered by what was drawn and pointed at."""
    return trace_attractor_graph(
        photo,
        matte,
        camera,
        strokes=strokes,
        seeds=marks.seeds,
        target=marks.fork,
        leafy=leafy,
        habit=habit,
        params=job.params.attraction,
        seed=job.seed,
    )


def run_limbs(
    job: Job,
    graphs: tuple[AttractorGraph, ...],
    cameras: tuple[Camera, ...],
    volume: DensityVolume,
    edits: tuple[PaintedEdit, ...],
) -> LimbTree:
    """The limbs in space that look like the graphs in all views, but where another direction is painted."""
    del job
    return clear_painted(lift_graphs(graphs, cameras, volume), cameras, edits)


def run_fields(job: Job, graph: AttractorGraph, camera: Camera, edit: PaintedEdit) -> DirectionField:
    """The direction field of one view, bent by painted directions."""
    field = build_direction_field(graph, camera, params=job.params.field, device=job.device)
    return bend_direction_field(field, camera, edit)


def run_limb_field(
    job: Job,
    limbs: LimbTree,
    volume: DensityVolume,
    cameras: tuple[Camera, ...],
    edits: tuple[PaintedEdit, ...],
    habit: Habit,
) -> LimbField:
    """The direction field in space around the limbs, but where another direction is painted."""
    field = build_limb_field(limbs, volume, habit=habit, params=job.params.field)
    return lead_painted(field, cameras, edits)


def run_habit(job: Job, mattes: tuple[Matte, ...], cameras: tuple[Camera, ...], leafy: bool) -> Habit:
    """Which way the branches grow."""
    return judge_habit(mattes, cameras, leafy=leafy, params=job.params.attraction)


def run_flow(
    job: Job, volume: DensityVolume, fields: tuple[DirectionField, ...], limb_field: LimbField
) -> FlowTraces:
    """The particles' joined paths."""
    params = job.params.flow
    return trace_particles(volume, fields, limbs=limb_field, params=params, seed=job.seed, device=job.device)


def run_branches(
    job: Job,
    traces: FlowTraces,
    limbs: LimbTree,
    mattes: tuple[Matte, ...],
    bare: tuple[Matte, ...],
    cameras: tuple[Camera, ...],
    edits: tuple[PaintedEdit, ...],
    leafy: bool,
    between: tuple[GuessedView, ...],
) -> Skeleton:
    """The skeleton with radii: limbs where the graphs run, and as wide as the mattes show."""
    params = job.params.thickness
    # What is erased changes the crown there, and not which branches bear it elsewhere.
    either = [
        replace(one, alpha=np.maximum(one.alpha, two.alpha)) for one, two in zip(bare, mattes, strict=True)
    ]
    crown = tuple(zip(either, cameras, strict=True)) if leafy else ()
    branches = build_skeleton(
        traces, limbs=limbs, crown=crown, edits=edits, between=between, params=job.params.branches
    )
    trunk = _agreed_radius([measure_trunk(m, c) for m, c in zip(mattes, cameras, strict=True)])
    bounds = bound_radii(branches, limbs)
    if not leafy and params.exponent is None:
        exponent = fit_exponent(branches, mattes, cameras, trunk_radius=trunk, bounds=bounds, params=params)
        params = params.model_copy(update={"exponent": exponent})
    return da_vinci_radii(branches, trunk_radius=trunk, bounds=bounds, params=params)


def _agreed_radius(seen: list[float | None]) -> float | None:
    """The trunk's radius from all views: their median, without views that see it far wider than another does.

    A view whose foot is cropped or grown over measures a fork or a bush instead, which is never narrower.
    """
    radii = np.array([radius for radius in seen if radius is not None])
    if not len(radii):
        return None
    return float(np.median(radii[radii <= _WIDER * radii.min()]))


def run_leafiness(job: Job, mattes: tuple[Matte, ...], cameras: tuple[Camera, ...]) -> bool:
    """Whether the tree bears leaves."""
    bear = job.params.leaves.bear
    return judge_leafy(mattes, cameras) if bear == "auto" else bear == "always"


def run_twigs(
    job: Job,
    branches: Skeleton,
    volume: DensityVolume,
    mattes: tuple[Matte, ...],
    cameras: tuple[Camera, ...],
    between: tuple[GuessedView, ...],
    edits: tuple[PaintedEdit, ...],
    leafy: bool,
    sketched: TwigShapes | None,
    heights: tuple[float, ...],
) -> Skeleton:
    """The skeleton with twigs, its thin branches turned to where the mattes show them."""
    params, height, seed = job.params.twigs, heights[0], job.seed
    if leafy:  # the leaves come near the volume, and hide twigs that do not
        between = ()
    branches = turn_twigs(
        branches,
        volume,
        mattes,
        cameras,
        between=between,
        height=height,
        leafy=leafy,
        edits=edits,
        params=params,
        seed=seed,
    )
    return grow_twigs(
        branches,
        volume,
        mattes,
        cameras,
        between=between,
        height=height,
        leafy=leafy,
        shapes=sketched,
        params=params,
        seed=seed,
    )


def run_patching(
    job: Job,
    painted: Skeleton,
    plain: Skeleton | None,
    cameras: tuple[Camera, ...],
    edits: tuple[PaintedEdit, ...],
    heights: tuple[float, ...],
) -> tuple[Skeleton, Patch | None]:
    """The skeleton that the paint has changed where it is; and where its nodes come from."""
    del job
    if plain is None:
        return painted, None
    patch = patch_skeleton(plain, painted, cameras, edits, height=heights[0])
    return patch.skeleton, patch


def run_leaf_patching(
    job: Job,
    painted: Foliage | None,
    plain: Foliage | None,
    patch: Patch | None,
    cameras: tuple[Camera, ...],
    edits: tuple[PaintedEdit, ...],
) -> Foliage | None:
    """The same for leaves."""
    del job
    if patch is None:
        return painted
    return patch_leaves(plain, painted, cameras, edits, of_plain=patch.plain, of_painted=patch.painted)


def run_meshing(job: Job, skeleton: Skeleton) -> TreeMesh:
    """The wood's surface."""
    params = job.params.meshing
    if params.surface == "quads":
        from flowtree.meshing.connect_ramifications import connect_ramifications  # few ask for it
        from flowtree.meshing.unwrap_quads import unwrap_quads

        return unwrap_quads(connect_ramifications(skeleton, params=params, device=job.device))
    return sweep_rings(skeleton, params=params, device=job.device)


def run_bark(
    job: Job,
    branches: Skeleton,
    mattes: tuple[Matte, ...],
    cameras: tuple[Camera, ...],
    habit: Habit,
    picture: Path | None,
    sources: tuple[Path | Photo, ...],
    photos: tuple[Photo, ...],
    placements: tuple[Placement, ...],
    mirrored: tuple[bool, ...],
) -> Material:
    """The given bark, or one cut from photos that show it well, or painted in the trunk's colour."""
    if picture is not None:
        return load_bark(picture)
    params, seed = job.params.meshing, job.seed
    if params.bark_style == "auto" and params.bark_color == "auto":
        cut = cut_trunk(
            branches,
            sources,
            photos,
            placements,
            mattes,
            cameras,
            mirrored,
            scale=params.bark_scale,
            seed=seed,
            params=job.params.photos,
        )
        if cut is not None:
            return cut
    if params.bark_color == "auto":
        color = light_bark(measure_bark(branches, mattes, cameras))
    else:
        color = read_color(params.bark_color, "bark color")
    return paint_bark(color, style=params.bark_style, growth=habit, seed=seed)


def run_leaf(
    job: Job, mattes: tuple[Matte, ...], cameras: tuple[Camera, ...], leafy: bool, picture: Path | None
) -> tuple[TreeMesh, Material] | None:
    """One leaf, if the tree has any; its picture is an input so that a new one makes a new leaf."""
    del picture
    return pick_leaf(mattes, cameras, params=job.params.leaves, seed=job.seed) if leafy else None


def run_colors(job: Job, matte: Matte, camera: Camera, leafy: bool) -> NDArray[np.float32]:
    """The leaves' colours around every pixel of one view; none of a bare tree."""
    del job
    return spread_colors(matte, camera) if leafy else np.zeros((0, 0, 3), np.float32)


def run_foliage(
    job: Job,
    skeleton: Skeleton,
    volume: DensityVolume,
    mattes: tuple[Matte, ...],
    cameras: tuple[Camera, ...],
    between: tuple[GuessedView, ...],
    leaf: tuple[TreeMesh, Material] | None,
    colors: tuple[NDArray[np.float32], ...],
    heights: tuple[float, ...],
) -> Foliage | None:
    """The leaves, if the tree has any."""
    if leaf is None:
        return None
    return place_leaves(
        skeleton,
        volume,
        mattes,
        cameras,
        between=between,
        height=heights[0],
        leaf=leaf,
        colors=colors,
        params=job.params.leaves,
        seed=job.seed,
    )


def run_assembly(
    job: Job,
    skeleton: Skeleton,
    wood: TreeMesh,
    bark: Material,
    foliage: Foliage | None,
    heights: tuple[float, ...],
) -> TreeModel:
    """Everything together."""
    del job
    return TreeModel(name="tree", height=heights[0], skeleton=skeleton, wood=wood, bark=bark, foliage=foliage)


def run_equipping(job: Job, tree: TreeModel) -> TreeAsset:
    """The tree made ready for an engine."""
    return equip_tree(tree, params=job.params, seed=job.seed, device=job.device)


def run_closing(job: Job, wood: TreeMesh) -> bool:
    """Whether the wood's surface is closed."""
    del job
    return is_watertight(close_seams(wood)[1])


def run_fidelity(job: Job, asset: TreeAsset, matte: Matte, camera: Camera) -> float:
    """Soft IoU of what is written with one view's matte (see `soft_iou`), from a picture just fine enough."""
    tree, small = asset.levels[0], _smaller(camera)
    mask = render_mask(tree, small, device=job.device)
    return soft_iou(mask, small, matte.alpha, camera, height=tree.height)


def _smaller(camera: Camera) -> Camera:
    """The same view, ``_MASK_HEIGHT`` pixels high: four a cell of the measure, and more rays in each."""
    scale = min(1.0, _MASK_HEIGHT / camera.height)
    return replace(
        camera,
        metres_per_pixel=camera.metres_per_pixel / scale,
        foot=(camera.foot[0] * scale, camera.foot[1] * scale),
        width=math.ceil(camera.width * scale),
        height=math.ceil(camera.height * scale),
    )
