"""What a reconstruction says about itself: ``report.json``."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from flowtree import __version__
from flowtree.model.asset import TreeAsset
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from flowtree.pipeline.compare_views import compare_views

# Measured with `compare_views`: parallel views of one tree 0.83 and more, loose photos of one tree that crop
# it 0.65 and more, views of different trees 0.23 to 0.86 with a quarter below 0.58.
_ALIKE = 0.55
# Shares of the picture below and above which a matte looks like a mistake.
_LEAST_COVER, _MOST_COVER = 0.01, 0.9
# Mean alpha along an edge of the picture from which on the crown is cut off there.
_MOST_ON_EDGE = 0.1
# What the sides of a picture at which a crown may leave it are called.
_EDGES = {"left": "left", "right": "right", "top": "upper"}


def build_report(
    *,
    photos: Sequence[Photo],
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    placements: Sequence[Placement],
    soft_ious: Sequence[float],
    tree: TreeModel,
    watertight: bool,
    seconds: Mapping[str, float],
    seed: int,
    device: str,
    warnings: Sequence[str],
) -> dict[str, Any]:
    """The report of DESIGN's form, of plain numbers, texts, lists and mappings.

    Args:
        photos: one a view.
        mattes: one a view.
        cameras: one a view.
        placements: one a view: what the cameras were made from.
        soft_ious: of what is written with each view's matte.
        tree: the result.
        watertight: whether its wood's surface is closed.
        seconds: that each stage took.
        seed: of the run.
        device: that kernels ran on.
        warnings: what the caller already found; those about the mattes are added.
    """
    views = [
        {
            "file": photo.name,
            "yaw": camera.yaw,
            "soft_iou": round(score, 4),
            "matte": {
                "method": matte.method,
                "cover": round(float(matte.alpha.mean()), 4),
                "width": camera.width,
                "height": camera.height,
                "metres_per_pixel": camera.metres_per_pixel,
                "foot_pixel": [float(camera.foot[0]), float(camera.foot[1])],
            },
            "alignment": _alignment(placement),
        }
        for photo, matte, camera, placement, score in zip(
            photos, mattes, cameras, placements, soft_ious, strict=True
        )
    ]
    warnings = [*warnings, *_view_warnings(photos, mattes, cameras, placements, tree.height)]
    return {
        "version": __version__,
        "seed": seed,
        "device": device,
        "seconds": _rounded(seconds),
        "peak_memory_mb": peak_memory_mb(),
        "views": views,
        **_tree_figures(tree, watertight),
        "warnings": warnings,
    }


def growth_report(
    *,
    tree: TreeModel,
    watertight: bool,
    seconds: Mapping[str, float],
    seed: int,
    device: str,
    warnings: Sequence[str],
) -> dict[str, Any]:
    """The same of a tree that was grown on a skeleton: there are no views.

    Args:
        tree: the result.
        watertight: whether its wood's surface is closed.
        seconds: that each stage took.
        seed: of the run.
        device: that kernels ran on.
        warnings: what was repaired.
    """
    return {
        "version": __version__,
        "seed": seed,
        "device": device,
        "seconds": _rounded(seconds),
        "peak_memory_mb": peak_memory_mb(),
        "height_m": round(tree.height, 4),
        **_tree_figures(tree, watertight),
        "warnings": [*warnings],
    }


def asset_figures(asset: TreeAsset) -> dict[str, Any]:
    """What the tree's file holds: levels, cards, wind, solid bodies."""
    figures: dict[str, Any] = {
        "levels": [
            {
                "triangles": len(level.wood.triangles) + leaves * per_leaf,
                "wood_triangles": len(level.wood.triangles),
                "leaves": leaves,
            }
            for level, (leaves, per_leaf) in ((level, _leaf_counts(level)) for level in asset.levels)
        ],
        "cards": [card.name for card in asset.cards],
    }
    if asset.winds:
        armature = asset.winds[0].armature
        figures["joints"] = 0 if armature is None else len(armature.parent)
        figures["wind_channels"] = sorted(asset.winds[0].wood)
    if asset.collision is not None:
        figures["capsules"] = len(asset.collision.capsule_radius)
        figures["hull_triangles"] = len(asset.collision.hull_triangles)
    return figures


def _leaf_counts(tree: TreeModel) -> tuple[int, int]:
    """Leaves, and triangles of each."""
    foliage = tree.foliage
    return (0, 0) if foliage is None else (len(foliage.position), len(foliage.leaf.triangles))


def _rounded(seconds: Mapping[str, float]) -> dict[str, float]:
    return {name: round(took, 3) for name, took in seconds.items()}


def _tree_figures(tree: TreeModel, watertight: bool) -> dict[str, Any]:
    return {
        "skeleton": _skeleton_figures(tree.skeleton),
        "mesh": {
            "triangles": len(tree.wood.triangles),
            "vertices": len(tree.wood.positions),
            "watertight": watertight,
        },
        "leaves": 0 if tree.foliage is None else len(tree.foliage.position),
    }


def _alignment(placement: Placement) -> dict[str, Any]:
    """What is known of how the photograph was taken, and where from."""
    known: dict[str, Any] = {
        estimate.name: {
            "value": round(estimate.value, 3),
            "unit": estimate.unit,
            "from": estimate.origin,
            **({} if estimate.deviation is None else {"deviation": round(estimate.deviation, 3)}),
        }
        for estimate in placement.estimates
    }
    return {**known, "straightened": placement.warp is not None, "leaves_picture_at": [*placement.missing]}


def report_bytes(report: Mapping[str, Any]) -> bytes:
    """The report as it stands in a file."""
    return (json.dumps(report, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()


def peak_memory_mb() -> float | None:
    """The most memory this process ever held [MB]; None where the system does not say (Windows)."""
    try:
        import resource
    except ImportError:
        return None
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(most / (1e6 if sys.platform == "darwin" else 1e6 / 1024.0), 1)


def _skeleton_figures(skeleton: Skeleton) -> dict[str, Any]:
    parent = skeleton.parent
    children = np.bincount(parent[1:], minlength=len(parent))
    length = np.linalg.norm(skeleton.points[1:] - skeleton.points[parent[1:]], axis=1)
    return {
        "nodes": len(parent),
        "tips": int((children == 0).sum()),
        "branches": 1 + int(np.maximum(children - 1, 0).sum()),
        "total_length_m": round(float(length.sum()), 3),
        "trunk_radius_m": round(float(skeleton.radius[0]), 4),
        "particles": int(skeleton.particles[0]),
    }


def _view_warnings(
    photos: Sequence[Photo],
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    placements: Sequence[Placement],
    height: float,
) -> list[str]:
    warnings = [warning for placement in placements for warning in placement.warnings]
    for photo, matte, placement in zip(photos, mattes, placements, strict=True):
        cover = float(matte.alpha.mean())
        if cover < _LEAST_COVER:
            warnings.append(f"{photo.name}: only {cover:.1%} of the picture was taken for tree")
        if cover > _MOST_COVER:
            warnings.append(f"{photo.name}: {cover:.0%} of the picture was taken for tree")
        if placement.warp is None:
            edges = {"left": matte.alpha[:, 0], "right": matte.alpha[:, -1], "upper": matte.alpha[0]}
            cut = [side for side, edge in edges.items() if float(edge.mean()) > _MOST_ON_EDGE]
        else:  # the straightened picture's edges are not the photograph's
            cut = [_EDGES[side] for side in placement.missing if side in _EDGES]
        if cut:
            warnings.append(f"{photo.name}: the tree leaves the picture at the {' and '.join(cut)} edge")
    for a, b in combinations(range(len(photos)), 2):
        alike = compare_views(mattes[a], cameras[a], mattes[b], cameras[b], height=height)
        if alike < _ALIKE:
            warnings.append(
                f"{photos[a].name} and {photos[b].name} do not look like one tree: "
                f"their profiles over height agree to {alike:.0%}"
            )
    return warnings
