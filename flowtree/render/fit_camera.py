"""A camera that sees a whole tree."""

from __future__ import annotations

from flowtree import check
from flowtree.geometry.projection import Viewpoint, to_plane
from flowtree.model.camera import Camera
from flowtree.model.tree import TreeModel
from flowtree.render.assemble_scene import assemble_scene, corner_points

_MARGIN = 0.05  # of the picture, kept free on every side


def fit_camera(tree: TreeModel, yaw: float, size: int) -> Camera:
    """An orthographic camera whose square picture holds the whole tree with a margin.

    Args:
        tree: the tree, world frame [m].
        yaw: where the camera stands [degrees].
        size: height and width of the picture [pixels].

    Raises:
        InputError: the tree has neither a triangle nor a leaf.
    """
    corners = corner_points(assemble_scene(tree)).T
    check.require(
        len(corners) > 0, "tree", "needs a triangle or a leaf", "neither", "mesh the skeleton first"
    )
    plane = to_plane(corners, Viewpoint(yaw))
    low, high = plane.min(axis=0), plane.max(axis=0)
    low[1] = min(low[1], 0.0)
    side = max(float((high - low).max()), 1e-3)
    scale = side / (size * (1.0 - 2.0 * _MARGIN))
    middle = (low + high) / 2.0
    foot_x = size / 2.0 - middle[0] / scale
    foot_y = size * (1.0 - _MARGIN) + low[1] / scale
    return Camera(yaw, scale, (float(foot_x), float(foot_y)), size, size)
