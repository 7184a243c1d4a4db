"""A picture of a tree."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.projection import view_axes
from flowtree.geometry.srgb import encode_srgb
from flowtree.model.camera import Camera
from flowtree.model.tree import TreeModel
from flowtree.params import RenderParams
from flowtree.render.assemble_scene import Scene, assemble_scene
from flowtree.render.camera_bands import camera_bands
from flowtree.render.cast_scene import cast_scene
from flowtree.render.gather_sky_light import gather_sky_light
from flowtree.render.shade_hits import light_scene, shade_hits


def render_view(
    tree: TreeModel, camera: Camera, *, params: RenderParams = RenderParams(), device: str | None = None
) -> NDArray[np.uint8]:
    """Renders a tree in daylight, as a camera sees it.

    The sun stands at ``params.sun_azimuth`` from the viewer's back and casts shadows; sky and ground light
    the crown through its own leaves; leaves have two sides and let light pass.

    Args:
        tree: the tree, world frame [m].
        camera: of the picture, ``camera.width`` x ``camera.height`` pixels.
        params: rays in a pixel, sun and sky.
        device: to run on; the best one by default.

    Returns: (height, width, 4) uint8 sRGB with alpha, the share of each pixel that is tree; colours are not
        multiplied with it.

    Raises:
        InputError: a tree with NaN or wrong indices, a camera without a picture.
    """
    scene = assemble_scene(tree)
    return render_scene(scene, gather_sky_light(scene), camera, params=params, device=device)


def render_scene(
    scene: Scene,
    sky: NDArray[np.float32],
    camera: Camera,
    *,
    params: RenderParams,
    device: str | None = None,
) -> NDArray[np.uint8]:
    """`render_view` of a scene and its sky light, which are the same for all views."""
    right, up, toward = view_axes(camera.yaw)
    around, high = np.radians(params.sun_azimuth), np.radians(params.sun_elevation)
    sun = np.cos(high) * (np.sin(around) * right + np.cos(around) * toward) + np.sin(high) * up
    samples, lighting = params.samples, None
    picture = np.zeros((camera.height, camera.width, 4), np.uint8)
    for rows, view in camera_bands(camera, samples):
        if not len(scene.triangles):
            break
        if lighting is None:
            lighting = light_scene(scene, sky, sun, finest=camera.metres_per_pixel, device=device)
        hits = cast_scene(scene, view, device=device)
        ray, color = shade_hits(scene, view, hits, lighting, params)
        row, column = np.divmod(ray, hits.hit.shape[1])
        pixel = row // samples * view.width + column // samples
        size = view.width * view.height
        count = np.bincount(pixel, minlength=size)
        total = np.stack([np.bincount(pixel, part, minlength=size) for part in color.T], axis=1)
        mean = encode_srgb(total / np.maximum(count, 1)[:, None])
        shaded = np.concatenate([mean, (count / samples**2)[:, None]], axis=1)
        picture[rows] = np.rint(255.0 * shaded).astype(np.uint8).reshape(view.height, view.width, 4)
    return picture
