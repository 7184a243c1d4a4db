"""How the views stand around the tree, and their attractor graphs on the photos."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import plane_to_pixels
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.photos.straighten_lines import move_places
from flowtree.studio.layers.layer import Layer, json_layer


def cameras_layer(
    photos: Sequence[Photo], placements: Sequence[Placement], mirrored: Sequence[bool]
) -> Layer:
    """Every view's camera and what it was made from, in pixels of the upright photos.

    Args:
        photos: the views' photos as they were read.
        placements: one a view.
        mirrored: whether a view is its photo's mirror image.
    """
    views = [
        _view(number, photo, placement, mirror)
        for number, (photo, placement, mirror) in enumerate(zip(photos, placements, mirrored, strict=True))
    ]
    return json_layer("cameras", views)


def graph_layer(number: int, graph: AttractorGraph, photo: Photo, placement: Placement) -> Layer:
    """A view's attractor graph as polylines on its upright photo."""
    camera = placement.camera
    pixels = plane_to_pixels(graph.points, camera)
    places = move_places(_warp(placement), pixels) / photo.scale
    half = np.zeros(len(graph.parent)) if graph.half_width is None else np.nan_to_num(graph.half_width)
    scale = _pixels_per_metre(camera, photo)
    chains = _chains(graph.parent)
    return json_layer(
        f"graph/{number}",
        {
            "lines": [np.round(places[chain], 1).tolist() for chain in chains],
            "widths": [round(float(2.0 * np.median(half[chain])) * scale, 1) for chain in chains],
        },
    )


def _chains(parent: NDArray[np.int32]) -> list[list[int]]:
    """The branches of a rooted tree, each from the node that it leaves to its tip."""
    children: list[list[int]] = [[] for _ in parent]
    for node, above in enumerate(parent.tolist()):
        if above >= 0:
            children[above].append(node)
    chains = []
    starts = [(0, child) for child in children[0]] if children else []
    while starts:
        fork, node = starts.pop()
        chain = [fork, node]
        while len(children[chain[-1]]) == 1:
            chain.append(children[chain[-1]][0])
        starts += [(chain[-1], child) for child in children[chain[-1]]]
        chains.append(chain)
    return chains


def _view(number: int, photo: Photo, placement: Placement, mirrored: bool) -> dict[str, Any]:
    camera = placement.camera
    estimates = {estimate.name: estimate for estimate in placement.estimates}
    rows = {"foot", "top"}
    return {
        "photo": 0 if mirrored else number,
        "mirrored": bool(mirrored),
        "yaw": camera.yaw,
        "metres_per_pixel": camera.metres_per_pixel,
        "foot": [float(x) for x in camera.foot],
        "distance": camera.distance if math.isfinite(camera.distance) else None,
        "eye": camera.eye,
        "width": camera.width,
        "height": camera.height,
        "frame": [size / photo.scale for size in reversed(photo.rgb.shape[:2])],
        "warp": (np.diag([1.0 / photo.scale, 1.0 / photo.scale, 1.0]) @ _warp(placement)).tolist(),
        "placed": {
            f"{name}_row" if name in rows else name: estimate.value / (photo.scale if name in rows else 1.0)
            for name, estimate in estimates.items()
        },
        "origins": {name: estimate.origin for name, estimate in estimates.items()},
        "missing": list(placement.missing),
        "warnings": list(placement.warnings),
    }


def _warp(placement: Placement) -> NDArray[np.float64]:
    return np.eye(3) if placement.warp is None else placement.warp


def _pixels_per_metre(camera: Camera, photo: Photo) -> float:
    return 1.0 / (camera.metres_per_pixel * photo.scale)
