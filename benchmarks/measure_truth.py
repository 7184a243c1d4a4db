"""How alike a known tree and the tree made from two of its pictures are, from all sides."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.density.project_density import project_density
from flowtree.export.write_glb import encode_glb
from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.meshing.close_seams import close_seams
from flowtree.model.camera import Camera
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo
from flowtree.model.skeleton import Skeleton
from flowtree.model.traces import FlowTraces
from flowtree.model.tree import TreeModel
from flowtree.model.volume import DensityVolume
from flowtree.params import Params
from flowtree.photos.load_photo import load_photo
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou

#: Yaws [degrees] of the pictures a tree is made from, and of those it is only compared with.
INPUTS, HELD_OUT = (0, 90), (45, 135)

# Rays along a pixel's side. A cell of the measure is 11 pixels wide here: 484 rays are in it.
_SAMPLES = 2


@dataclass(frozen=True)
class Truth:
    """A tree of which everything is known.

    Attributes:
        name: of its folder.
        height: [m].
        photos: by yaw [degrees]: parallel projections.
        alphas: by yaw [degrees]: (h, w) in 0..1, exact.
        cameras: by yaw [degrees]: exact.
    """

    name: str
    height: float
    photos: dict[int, Photo]
    alphas: dict[int, NDArray[np.float32]]
    cameras: dict[int, Camera]


@dataclass(frozen=True)
class Measured:
    """What came out of a known tree.

    Attributes:
        made: from the pictures at `INPUTS`.
        of_tree: soft IoU by yaw.
        of_volume: soft IoU by yaw of the density volume alone.
        faults: what is wrong with the tree, in words; empty for a valid one.
        digest: of its GLB: equal for equal trees.
        seconds: that the stages took together.
    """

    made: Reconstruction
    of_tree: dict[int, float]
    of_volume: dict[int, float]
    faults: tuple[str, ...]
    digest: str
    seconds: float

    @property
    def tree(self) -> TreeModel:
        """The made tree."""
        return self.made.tree


def load_truth(folder: Path) -> Truth:
    """Reads ``truth.json`` and the four parallel projections.

    Raises:
        InputError: a file is missing or no picture with an alpha channel.
    """
    file = folder / "truth.json"
    check.require(
        file.is_file(), str(file), "must be a known tree's file", "none", "name the data folder with --data"
    )
    known = json.loads(file.read_text(encoding="utf-8"))
    photos, alphas, cameras = {}, {}, {}
    for view in known["views"]:
        if view["projection"] != "orthographic":
            continue
        photo = load_photo(folder / view["file"])
        if photo.alpha is None:
            check.fail(photo.name, "needs an alpha channel", "none", "fetch the data folder anew")
        rows, columns = photo.rgb.shape[:2]
        x, y = (at * photo.scale for at in view["foot_pixel"])
        yaw = int(view["yaw"])
        photos[yaw], alphas[yaw] = photo, photo.alpha
        cameras[yaw] = Camera(float(yaw), view["metres_per_pixel"] / photo.scale, (x, y), columns, rows)
    return Truth(known["name"], float(known["height"]), photos, alphas, cameras)


def measure_truth(
    truth: Truth, *, params: Params = Params(), seed: int = 0, cache: StageCache | None = None
) -> Measured:
    """Makes a tree from the exact mattes at `INPUTS`, and compares it with the known one from every side.

    Foot and top are given, so that the cameras are the true ones and what is measured is the tree, not how
    well its foot was found.

    Args:
        truth: the known tree.
        params: of all stages.
        seed: of the run.
        cache: results of earlier runs.
    """
    made = reconstruct(
        [truth.photos[yaw] for yaw in INPUTS],
        yaws=INPUTS,
        height=truth.height,
        marks=[mark_ends(truth.cameras[yaw], truth.height) for yaw in INPUTS],
        params=params,
        seed=seed,
        cache=cache,
    )
    return Measured(
        made=made,
        of_tree={yaw: _compare(truth, yaw, made.tree) for yaw in truth.cameras},
        of_volume={yaw: _compare(truth, yaw, made.volume) for yaw in truth.cameras},
        faults=tuple(find_faults(made.tree, made.traces)),
        digest=hashlib.sha256(encode_glb(made.tree)).hexdigest()[:16],
        seconds=sum(made.report["seconds"].values()),
    )


def mean_over(scores: dict[int, float], yaws: tuple[int, ...]) -> float:
    """Mean of the scores at some yaws."""
    return float(np.mean([scores[yaw] for yaw in yaws]))


def mark_ends(camera: Camera, height: float) -> ViewMarks:
    """Where foot and top are in a picture."""
    return ViewMarks(foot=camera.foot, top=camera.foot[1] - height / camera.metres_per_pixel)


def _compare(truth: Truth, yaw: int, made: TreeModel | DensityVolume) -> float:
    """Soft IoU in the true camera of a view."""
    camera, alpha = truth.cameras[yaw], truth.alphas[yaw]
    seen = (
        project_density(made, camera)
        if isinstance(made, DensityVolume)
        else render_mask(made, camera, samples=_SAMPLES)
    )
    return soft_iou(seen, camera, alpha, camera, height=truth.height)


def find_faults(tree: TreeModel, traces: FlowTraces) -> list[str]:
    """Why a tree's scores would not count."""
    faults = []
    if not is_watertight(close_seams(tree.wood)[1]):
        faults.append("the wood is not watertight")
    lines: tuple[tuple[str, FlowTraces | Skeleton], ...] = (("traces", traces), ("skeleton", tree.skeleton))
    for name, line in lines:
        count = np.arange(len(line.parent))
        if line.parent[0] != -1 or (line.parent[1:] < 0).any() or (line.parent[1:] >= count[1:]).any():
            faults.append(f"the {name} are no tree with one root")
    if faults:
        return faults
    arriving = np.bincount(traces.parent[1:], traces.particles[1:], len(traces.parent))
    if (arriving > traces.particles).any():
        faults.append("particles are lost on the way to the foot")
    if tree.skeleton.particles[0] != traces.particles[0]:
        faults.append(f"{traces.particles[0]} particles, {tree.skeleton.particles[0]} at the foot")
    return faults
