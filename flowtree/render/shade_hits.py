"""The light that comes from where rays meet a tree."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.params import RenderParams
from flowtree.render.assemble_scene import Scene, corner_points
from flowtree.render.cast_scene import ParallelView, RayHits, cast_scene
from flowtree.render.interpolate_hits import (
    corner_weights,
    look_up_texture,
    ray_places,
    spread_values,
    texture_level,
)
from flowtree.render.sample_texture import build_normal_pyramid, build_pyramid

_SUN_COLOR = np.array([1.0, 0.93, 0.80], np.float32)
_SKY_COLOR = np.array([0.78, 0.90, 1.10], np.float32)
_GROUND_COLOR = np.array([0.20, 0.22, 0.13], np.float32)
# Light that has passed a green leaf is yellow-green and weaker (Poorter et al. 1995: a leaf passes about as
# much as it scatters back, mostly between 530 and 600 nm); a petal lets through all of its colour.
_PASSED = np.array([0.75, 0.80, 0.35], np.float32)
_PASSED_PLAIN = np.float32(0.75)
_GLOW = 2.0  # the sun is a small source: where it shines through, a leaf glows more than it darkens the rest
_LEAF_WRAP = 0.25  # a blade is curved and its neighbours' light fills in: its terminator is soft
_RELIEF_SKY = 0.5  # how much brighter the sky makes bark that the relief turns up
_SHADOW_SIZE = 1024  # rays along the longer side of the sun's picture, at most


@dataclass(frozen=True)
class Lighting:
    """What lights a scene, whoever looks at it.

    Attributes:
        toward_sun: (3,) unit vector.
        sky: (2, 4, n), as `gather_sky_light` gives it.
        sun_view: the picture that the sun sees.
        sun_near: what of the scene is nearest to the sun in it [m], -inf where nothing is.
    """

    toward_sun: NDArray[np.float64]
    sky: NDArray[np.float32]
    sun_view: ParallelView
    sun_near: NDArray[np.float32]


def light_scene(
    scene: Scene,
    sky: NDArray[np.float32],
    toward_sun: NDArray[np.float64],
    *,
    finest: float,
    device: str | None = None,
) -> Lighting:
    """Lets the sun look at the scene: what it does not see lies in shadow.

    Args:
        scene: the triangles.
        sky: as `gather_sky_light` gives it.
        toward_sun: (3,) unit vector, above the horizon.
        finest: smallest size worth resolving [m].
        device: to run on.
    """
    right = np.cross([0.0, 1.0, 0.0], toward_sun)
    length = float(np.linalg.norm(right))
    right = right / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    axes = np.stack([right, np.cross(toward_sun, right), toward_sun])
    points = corner_points(scene)
    flat = np.stack([(axis.astype(np.float32)[:, None] * points).sum(axis=0) for axis in axes[:2]])
    low, high = flat.min(axis=1), flat.max(axis=1)
    scale = max(finest, float((high - low).max()) / _SHADOW_SIZE, 1e-6)
    width, height = (int(n) for n in np.ceil((high - low) / scale).astype(int) + 3)
    view = ParallelView(axes, scale, (1.5 - low[0] / scale, 1.5 + high[1] / scale), width, height, 1)
    hits = cast_scene(scene, view, device=device)
    return Lighting(toward_sun, sky, view, np.where(hits.hit > 0, hits.near, np.float32(-np.inf)))


def shade_hits(
    scene: Scene, view: ParallelView, hits: RayHits, lighting: Lighting, params: RenderParams
) -> tuple[NDArray[np.intp], NDArray[np.float32]]:
    """Lights what the rays met: sun with shadows, sky and ground through the crown, translucent leaves.

    Light is gathered at the vertices and spread between them; texture and shadow are looked up for every ray.

    Args:
        scene: the triangles.
        view: the rays.
        hits: what they met.
        lighting: of the scene.
        params: brightness of sun and sky.

    Returns: the rays that met something, as flat indices, and their colours (n, 3), linear, in 0..1.
    """
    ray = np.flatnonzero(hits.hit)
    triangle = hits.hit.ravel()[ray] - 1
    x, y = ray_places(ray, hits.hit.shape[1], view.samples)
    corners = np.take(scene.triangles, triangle, axis=0).T
    weight = corner_weights(hits.corner, corners, x, y)
    visible = _sun_share(view, lighting, x, y, hits.near.ravel()[ray])
    indirect, direct = _light_vertices(scene, view.axes[2], lighting, params)
    spread = spread_values(np.concatenate([indirect, direct, scene.uvs], axis=1), corners, weight)
    uv = spread[:, 6:]
    level = texture_level(scene, hits.corner)[triangle]
    wood = triangle < scene.wood_triangles
    if scene.tangents is not None and wood.any():
        facing = _bark_facing(scene, lighting, corners[:, wood], weight[:, wood], uv[wood], level[wood])
        spread[wood, :3] *= facing[:, 1:]
        spread[wood, 3:6] *= facing[:, :1]
    color = spread[:, :3] + visible[:, None] * spread[:, 3:6]
    for chosen, material in ((wood, scene.bark), (~wood, scene.leaf)):
        if material is not None and chosen.any():
            color[chosen] *= look_up_texture(build_pyramid(material.base_color), uv[chosen], level[chosen])
    return ray, _compress(color)


def _light_vertices(
    scene: Scene, toward_eye: NDArray[np.float64], lighting: Lighting, params: RenderParams
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """What each vertex (n, 3) scatters toward the eye of sky and ground, and of the sun where it shines."""
    wood = slice(0, scene.wood_vertices)
    leaf = slice(scene.wood_vertices, None)
    eye, sun = toward_eye.astype(np.float32), lighting.toward_sun.astype(np.float32)
    normals = scene.normals.copy()
    # Of a leaf the eye sees the side that is turned to it.
    normals[:, leaf] *= np.where(
        (eye[:, None] * normals[:, leaf]).sum(axis=0) < 0, np.float32(-1), np.float32(1)
    )
    mean = lighting.sky[:, 0]
    tilt = 2 * (lighting.sky[:, 1:] * normals).sum(axis=1)
    tints = np.stack([_SKY_COLOR * params.sky, _GROUND_COLOR * (params.sky + 0.5 * params.sun)])
    front, back = (
        (np.maximum(mean + sign * tilt, 0)[:, :, None] * tints.astype(np.float32)[:, None]).sum(axis=0)
        for sign in (1, -1)
    )
    facing = (sun[:, None] * normals).sum(axis=0)[:, None]
    indirect, direct = np.empty_like(scene.colors), np.empty_like(scene.colors)
    indirect[wood] = front[wood]
    # A normal map tells later, ray by ray, how far bark faces the sun.
    direct[wood] = (1 if scene.tangents is not None else np.maximum(facing[wood], 0)) * _SUN_COLOR
    share = np.float32(0.0 if scene.leaf is None else scene.leaf.translucency)
    passed = share * _passed_light(scene.colors[leaf])
    indirect[leaf] = (1 - share) * front[leaf] + back[leaf] * passed
    softened = (np.stack([facing[leaf], -facing[leaf]]) + _LEAF_WRAP) / (1 + _LEAF_WRAP)
    on, through = np.maximum(softened, 0)
    direct[leaf] = (on + np.float32(_GLOW) * through * passed) * _SUN_COLOR
    return indirect * scene.colors, direct * scene.colors * np.float32(params.sun)


def _bark_facing(
    scene: Scene,
    lighting: Lighting,
    corners: NDArray[np.int32],
    weight: NDArray[np.float32],
    uv: NDArray[np.float32],
    level: NDArray[np.float32],
) -> NDArray[np.float32]:
    """How far the bark under rays faces the sun, and by what its relief changes the sky's light: (n, 2).

    Args:
        scene: with tangents.
        lighting: of the scene.
        corners: (3, n) of the rays' triangles, all of the wood.
        weight: (3, n) of the corners.
        uv: (n, 2).
        level: (n,) as `texture_level` gives it.
    """
    assert scene.tangents is not None
    assert scene.bark.normal is not None
    normal = scene.normals[:, : scene.wood_vertices].T
    right = scene.tangents[:, :3]
    axes = (right, np.cross(normal, right) * scene.tangents[:, 3:], normal)
    up = np.array([0.0, 1.0, 0.0], np.float32)
    lights = [lighting.toward_sun.astype(np.float32), up]
    there = np.stack([(axis * light).sum(axis=1) for light in lights for axis in axes], axis=1)
    seen = spread_values(there.astype(np.float32), corners, weight)
    relief = look_up_texture(build_normal_pyramid(scene.bark.normal), uv, level)
    sun = np.maximum((relief * seen[:, :3]).sum(axis=1), 0)
    sky = 1 + np.float32(_RELIEF_SKY) * ((relief * seen[:, 3:]).sum(axis=1) - seen[:, 5])
    return np.stack([sun, np.clip(sky, 0.4, 1.6)], axis=1)


def _passed_light(color: NDArray[np.float32]) -> NDArray[np.float32]:
    """How much of each colour of light (n, 3) goes on through leaves of these colours (n, 3), linear."""
    green = np.clip(2 * (color[:, 1] - color[:, 2]) / (color[:, 1] + color[:, 2] + np.float32(1e-6)), 0, 1)
    return np.asarray(_PASSED_PLAIN + green[:, None] * (_PASSED - _PASSED_PLAIN), np.float32)


def _sun_share(
    view: ParallelView,
    lighting: Lighting,
    x: NDArray[np.float32],
    y: NDArray[np.float32],
    near: NDArray[np.float32],
) -> NDArray[np.float32]:
    """The share 0..1 of the four rays of the sun around each point (rays, rays, metres) that reach it.

    The points are foreshortened as the view's eye sees them.
    """
    to_sun = lighting.sun_view.axes @ view.axes.T
    scale = view.metres_per_pixel / view.samples
    across = (x - np.float32(view.foot[0] * view.samples)) * np.float32(scale)
    up = (np.float32(view.foot[1] * view.samples) - y) * np.float32(scale)
    if math.isfinite(view.distance):
        shrink = (1 / (1 + near / np.float32(view.distance))).astype(np.float32)
        eye = np.float32(view.eye)
        across, up, near = across * shrink, eye + (up - eye) * shrink, near * shrink
    there = [(to_sun[k, 0] * across + to_sun[k, 1] * up + to_sun[k, 2] * near) for k in range(3)]
    texel = lighting.sun_view.metres_per_pixel
    column = lighting.sun_view.foot[0] + there[0] / texel - 0.5
    row = lighting.sun_view.foot[1] - there[1] / texel - 0.5
    left = np.clip(np.floor(column), 0, lighting.sun_view.width - 2).astype(np.int64)
    upper = np.clip(np.floor(row), 0, lighting.sun_view.height - 2).astype(np.int64)
    flat = lighting.sun_near.ravel()
    # A surface is as near to the sun as itself: it must be clearly behind another one to lie in its shadow.
    reach = (there[2] + 2.5 * texel).astype(np.float32)
    share = np.zeros(len(x))
    for down in (0, 1):
        for aside in (0, 1):
            weight = np.abs(1 - down - (row - upper)) * np.abs(1 - aside - (column - left))
            lit = flat[(upper + down) * lighting.sun_view.width + left + aside] <= reach
            share += weight * lit
    return np.clip(share, 0, 1).astype(np.float32)


def _compress(color: NDArray[np.float32]) -> NDArray[np.float32]:
    """Brings any brightness into 0..1, as film does (Reinhard et al. 2002, equation 4, white at 2.5)."""
    bright = np.maximum(color, 0)
    shown: NDArray[np.float32] = np.minimum(bright * (1 + bright / np.float32(2.5**2)) / (1 + bright), 1)
    return shown
