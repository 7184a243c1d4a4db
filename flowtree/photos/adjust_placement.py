"""Small corrections of where a tree stands in its photograph."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.model.placement import Estimate, Placement
from flowtree.photos.straighten_lines import move_places


def adjust_placement(
    placement: Placement, turns: Mapping[str, tuple[float, float]], *, height: float
) -> Placement:
    """The placement with corrections, each with its deviation, noted as estimates.

    Args:
        placement: of the photograph.
        turns: by name: "foot" and "top", how much higher in the plane they are seen [tree heights]; "roll"
            and "yaw" [degrees].
        height: of the tree [m].
    """
    if not any(value for value, _ in turns.values()):
        return placement
    plain = {name: value for name, (value, _) in turns.items()}
    to_pixels = plane_to_pixels(placement)
    old = np.eye(3) if placement.warp is None else placement.warp
    warp = old @ to_pixels @ adjustment(plain, height) @ np.linalg.inv(to_pixels)
    yaw = placement.camera.yaw + plain.get("yaw", 0.0)
    corrected = replace(placement, warp=warp, camera=replace(placement.camera, yaw=yaw))
    foot, top = view_ends(corrected, height)
    tall = float(abs(foot[1] - top[1]))
    rolled = next((e.value for e in placement.estimates if e.name == "roll"), 0.0)
    values = {
        "foot": (float(foot[1]), "pixels", tall),
        "top": (float(top[1]), "pixels", tall),
        "roll": (rolled + plain.get("roll", 0.0), "degrees", 1.0),
        "yaw": (yaw, "degrees", 1.0),
    }
    found = {
        name: Estimate(name, values[name][0], values[name][1], "estimated", values[name][2] * spread)
        for name, (_, spread) in turns.items()
    }
    kept = tuple(found.pop(estimate.name, estimate) for estimate in placement.estimates)
    return replace(corrected, estimates=(*kept, *found.values()))


def adjustment(turns: Mapping[str, float], height: float) -> NDArray[np.float64]:
    """(3, 3) from a corrected view's plane [m] to the plane that it was taken for."""
    foot, top = turns.get("foot", 0.0), turns.get("top", 0.0)
    scale, angle = 1.0 + top - foot, math.radians(turns.get("roll", 0.0))
    sine, cosine = scale * math.sin(angle), scale * math.cos(angle)
    return np.array([[cosine, sine, 0.0], [-sine, cosine, foot * height], [0.0, 0.0, 1.0]])


def plane_to_pixels(placement: Placement) -> NDArray[np.float64]:
    """(3, 3) from the plane of a view [m] to the pixels of its straightened picture."""
    camera = placement.camera
    per = 1.0 / camera.metres_per_pixel
    return np.array([[per, 0.0, camera.foot[0]], [0.0, -per, camera.foot[1]], [0.0, 0.0, 1.0]])


def view_ends(placement: Placement, height: float) -> NDArray[np.float64]:
    """Foot and top (2, 2) [pixels of the photograph]."""
    camera = placement.camera
    ends = np.array([camera.foot, (camera.foot[0], camera.foot[1] - height / camera.metres_per_pixel)])
    return ends if placement.warp is None else move_places(placement.warp, ends)
