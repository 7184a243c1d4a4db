"""Measures levels of detail and impostors: triangles, likeness, size of the default file, times."""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.tree_table import TreeTable, add_options, make_trees
from flowtree.export.write_glb import write_glb
from flowtree.geometry.projection import view_axes
from flowtree.model.asset import Card
from flowtree.model.camera import Camera
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.params import Params
from flowtree.pipeline.build_levels import build_levels
from flowtree.pipeline.equip_tree import equip_tree
from flowtree.pipeline.reconstruct import Reconstruction
from flowtree.render.bake_crossed import bake_crossed
from flowtree.render.bake_octahedral import bake_octahedral
from flowtree.render.fit_camera import fit_camera
from flowtree.render.look_up_impostor import look_up_impostor
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou

_SIZE = 192  # [pixels], of the pictures that are compared
_RUNS = 2  # of which the shorter counts
_YAWS = (0.0, 45.0, 90.0, 160.0)
_BETWEEN = (0.0, 7.0, 20.0, 33.0, 45.0, 66.0, 90.0, 125.0, 200.0, 290.0)  # impostors: beside those baked too
_HEAD = (
    ("tree", "tree"),
    ("triangles", "triangles of levels 0 to 3"),
    ("loss", "matte likeness lost by level 0"),
    ("likeness", "levels 1 to 3 against 0"),
    ("crossed", "crossed cards"),
    ("octahedral", "octahedral card"),
    ("megabytes", "default GLB [MB]"),
    ("level_seconds", "level 0 [s]"),
    ("all_seconds", "levels 0 to 3 [s]"),
    ("crossed_seconds", "crossed [s]"),
    ("octahedral_seconds", "octahedral [s]"),
)


@dataclass(frozen=True)
class LevelRow:
    """What was measured of one tree; likeness is soft IoU.

    Attributes:
        tree: its name.
        triangles: of each level, from level 0 on.
        loss: mean soft IoU with the mattes that level 0 has less than the whole tree.
        likeness: of each coarser level with level 0, mean over yaws.
        crossed: of the crossed cards with level 0, mean over yaws beside those that are baked, too.
        octahedral: of the octahedral card, as its shader would show it.
        megabytes: of the GLB file written by default, 10^6 bytes.
        level_seconds: to make level 0 alone, as all times the shortest of some runs.
        all_seconds: to make four levels.
        crossed_seconds: to bake the crossed cards.
        octahedral_seconds: to bake the octahedral card.
    """

    tree: str
    triangles: tuple[int, ...]
    loss: float
    likeness: tuple[float, ...]
    crossed: float
    octahedral: float
    megabytes: float
    level_seconds: float
    all_seconds: float
    crossed_seconds: float
    octahedral_seconds: float


def main(argv: list[str]) -> int:
    """Measures and prints a table in Markdown, then what it was measured on."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks levels", description=__doc__)
    add_options(parser)
    options = parser.parse_args(argv)
    trees = make_trees(options)
    table = TreeTable(_HEAD, _cell)
    for name, result in trees:
        table.add(measure_levels(name, result))
    table.end(options.json)
    return 0


def measure_levels(name: str, result: Reconstruction) -> LevelRow:
    """Builds levels and impostors of a reconstruction and compares them."""
    tree, asked, meshing = result.tree, Params().asset.max_triangles, Params().meshing

    def build(count: int) -> tuple[TreeModel, ...]:
        return build_levels(tree, max_triangles=asked, count=count, meshing=meshing)

    (first,), alone = _least_time(lambda: build(1))
    levels, every = _least_time(lambda: build(4))
    cameras = [fit_camera(tree, yaw, _SIZE) for yaw in _YAWS]
    masks = [[render_mask(level, camera) for camera in cameras] for level in levels]
    mattes = [
        (matte.alpha, camera, _smaller(camera))
        for matte, camera in zip(result.mattes, result.cameras, strict=True)
    ]

    def fidelity(shown: TreeModel) -> float:
        return float(
            np.mean(
                [
                    soft_iou(render_mask(shown, small), small, alpha, camera, height=tree.height)
                    for alpha, camera, small in mattes
                ]
            )
        )

    crossed, crossing = _least_time(lambda: bake_crossed(first))
    octahedral, baking = _least_time(lambda: bake_octahedral(first))
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "tree.glb"
        write_glb(equip_tree(tree), file)
        size = file.stat().st_size
    return LevelRow(
        tree=name,
        triangles=tuple(_triangles(level) for level in levels),
        loss=fidelity(tree) - fidelity(first),
        likeness=tuple(_mean_iou(masks[0], other, cameras, tree.height) for other in masks[1:]),
        crossed=_crossed_iou(first, crossed),
        octahedral=_octahedral_iou(first, octahedral),
        megabytes=size / 1e6,
        level_seconds=alone,
        all_seconds=every,
        crossed_seconds=crossing,
        octahedral_seconds=baking,
    )


def _least_time(work: Callable[[], Any]) -> tuple[Any, float]:
    seconds = []
    for _ in range(_RUNS):
        start = time.perf_counter()
        result = work()
        seconds.append(time.perf_counter() - start)
    return result, min(seconds)


def _mean_iou(
    ones: Sequence[NDArray[np.float32]],
    others: Sequence[NDArray[np.float32]],
    cameras: Sequence[Camera],
    height: float,
) -> float:
    pairs = zip(ones, others, cameras, strict=True)
    return float(
        np.mean([soft_iou(one, camera, other, camera, height=height) for one, other, camera in pairs])
    )


def _crossed_iou(tree: TreeModel, card: Card) -> float:
    """The cards are drawn as one leaf of a tree without wood."""
    none, one = np.zeros((0, 3), np.float32), np.ones(1, np.float32)
    turn, place = np.array([[0, 0, 0, 1]], np.float32), np.zeros((1, 3), np.float32)
    alone = replace(
        tree,
        wood=TreeMesh(none, none, np.zeros((0, 2), np.float32), np.zeros((0, 3), np.int32)),
        foliage=Foliage(card.mesh, card.material, place, turn, one, place + 1, np.zeros(1, np.int32)),
    )
    cameras = [fit_camera(tree, yaw, _SIZE) for yaw in _BETWEEN]
    masks = [[render_mask(shown, camera) for camera in cameras] for shown in (tree, alone)]
    return _mean_iou(masks[0], masks[1], cameras, tree.height)


def _octahedral_iou(tree: TreeModel, card: Card) -> float:
    places = card.mesh.positions.astype(np.float64)
    pixel = float(np.ptp(places[:, 0])) / _SIZE
    middle = places.mean(axis=0)
    cameras, masks, shown = [], [], []
    for yaw in _BETWEEN:
        right, _, toward = view_axes(yaw)
        foot = (_SIZE / 2 - float(middle @ right) / pixel, _SIZE / 2 + float(middle[1]) / pixel)
        cameras.append(Camera(yaw, pixel, foot, _SIZE, _SIZE))
        masks.append(render_mask(tree, cameras[-1]))
        shown.append(np.clip(look_up_impostor(card, toward, _SIZE)[:, :, 3], 0.0, 1.0))
    return _mean_iou(masks, shown, cameras, tree.height)


def _smaller(camera: Camera) -> Camera:
    """The same view in a picture of 512 pixels at most: soft IoU looks no closer."""
    ratio = max(1.0, max(camera.width, camera.height) / 512.0)
    width, height = (max(1, int(np.ceil(side / ratio))) for side in (camera.width, camera.height))
    foot = (camera.foot[0] / ratio, camera.foot[1] / ratio)
    scale = camera.metres_per_pixel * ratio
    return replace(camera, metres_per_pixel=scale, foot=foot, width=width, height=height)


def _triangles(tree: TreeModel) -> int:
    leaves = 0 if tree.foliage is None else len(tree.foliage.position) * len(tree.foliage.leaf.triangles)
    return len(tree.wood.triangles) + leaves


def _cell(value: str | float | tuple[float, ...]) -> str:
    if isinstance(value, tuple):
        return ", ".join(_cell(each) for each in value)
    return f"{value:.3f}" if isinstance(value, float) else f"{value:,}" if isinstance(value, int) else value
