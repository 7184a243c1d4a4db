"""Makes the two loose pictures that ``flowtree demo`` starts from.

A tree grown by an unrelated method is photographed twice, as somebody who walks around it would: not
quite from the front and the side, from other distances, at other exposures, the second picture a little
aslant.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.colonise_space import colonise_space
from benchmarks.paint_backdrop import Stand, paint_backdrop
from flowtree.foliage.make_leaf import make_leaf
from flowtree.geometry.projection import view_axes
from flowtree.geometry.srgb import encode_srgb
from flowtree.meshing.paint_bark import paint_bark
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.camera import Camera
from flowtree.model.foliage import Foliage
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from flowtree.params import RenderParams
from flowtree.render.render_view import render_view
from flowtree.render.write_picture import write_picture

_FOLDER = Path(__file__).parents[1] / "flowtree" / "cli" / "demo"
_SUN_AZIMUTH, _SUN_ELEVATION = 40.0, 50.0  # [degrees], of the world: it stands still between the pictures
_SEED = 7
_LEAVES = 8  # on a shoot of 0.13 m
_GOLDEN = 2.399963
_SHADOW_CELL, _SHADOW_CELLS = 0.06, 400


@dataclass(frozen=True)
class Shot:
    """One picture: where from, how bright, how straight, under which clouds."""

    yaw: float
    stand: Stand
    exposure: float
    tilt: float
    warmth: float
    weather: int


_SHOTS = (
    Shot(-4.0, Stand(24.0, 1.6, 84.0, (446.0, 1030.0), 900, 1120), 1.0, 0.0, 1.0, 25),
    Shot(93.0, Stand(29.0, 1.7, 74.0, (530.0, 918.0), 1000, 1000), 1.08, 0.9, 1.03, 20),
)


def main(argv: list[str]) -> int:
    """Writes photo_0.jpg and photo_1.jpg."""
    parser = argparse.ArgumentParser(prog="demo_pair", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=_FOLDER)
    folder = parser.parse_args(argv).output
    folder.mkdir(parents=True, exist_ok=True)
    tree = build_tree(_SEED)
    for number, shot in enumerate(_SHOTS):
        path = folder / f"photo_{number}.jpg"
        write_picture(take_photo(tree, shot), path, quality=88)
        print(f"demo_pair.photo_{number}.size {path.stat().st_size / 1000:.0f} kB")
    return 0


def build_tree(seed: int) -> TreeModel:
    """The tree that both pictures show."""
    skeleton = colonise_space(seed)
    bark = paint_bark((118, 104, 90), seed=seed)
    return TreeModel(
        name="demo",
        height=float(skeleton.points[:, 1].max()),
        skeleton=skeleton,
        wood=sweep_rings(skeleton),
        bark=bark,
        foliage=_leaf_out(skeleton, seed),
    )


def _leaf_out(skeleton: Skeleton, seed: int) -> Foliage:
    """Leaves in a spiral around all thin shoots, hanging a little, turned to the light."""
    rng = np.random.default_rng(seed)
    leaf, material = make_leaf("broad", seed=seed)
    thin = np.flatnonzero((skeleton.radius < 0.016) & (skeleton.parent >= 0))
    node = np.repeat(thin, _LEAVES)
    count = len(node)
    start, end = skeleton.points[skeleton.parent[node]], skeleton.points[node]
    along = (end - start) / np.maximum(np.linalg.norm(end - start, axis=1, keepdims=True), 1e-6)
    side = np.cross(along, [0.31, 0.2, 0.93])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    turn = (_GOLDEN * np.arange(count) + rng.normal(0, 0.3, count))[:, None]
    out = np.cos(turn) * side + np.sin(turn) * np.cross(along, side)
    blade = out + 0.5 * along + rng.normal(0, 0.3, (count, 3)) - [0, 0.25, 0]
    blade /= np.linalg.norm(blade, axis=1, keepdims=True)
    upper = np.array([0.0, 1.0, 0.0]) + rng.normal(0, 0.55, (count, 3))
    upper -= (upper * blade).sum(axis=1, keepdims=True) * blade
    upper /= np.linalg.norm(upper, axis=1, keepdims=True)
    frame = np.stack([np.cross(blade, upper), blade, upper], axis=2)
    tone = rng.normal(0, 1, (count, 1)) + np.repeat(rng.normal(0, 0.6, (len(thin), 1)), _LEAVES, axis=0)
    color = np.array([0.165, 0.285, 0.050]) * np.exp(tone * [0.17, 0.10, 0.15])
    return Foliage(
        leaf=leaf,
        material=material,
        position=(start + rng.random((count, 1)) * (end - start)).astype(np.float32),
        rotation=Rotation.from_matrix(frame).as_quat().astype(np.float32),
        scale=rng.uniform(0.085, 0.13, count).astype(np.float32),
        color=np.clip(color, 0, 1).astype(np.float32),
        node=node.astype(np.int32),
    )


def take_photo(tree: TreeModel, shot: Shot) -> NDArray[np.uint8]:
    """The tree over its backdrop, as a camera saves it: (h, w, 3) uint8."""
    stand = shot.stand
    aside = _SUN_AZIMUTH - shot.yaw
    sun = RenderParams(samples=4, sun_azimuth=aside, sun_elevation=_SUN_ELEVATION, sun=3.0, sky=0.95)
    near = _foreshorten(tree, shot.yaw, stand)
    camera = Camera(shot.yaw, 1 / stand.scale, stand.foot, stand.width, stand.height)
    drawn = render_view(near, camera, params=sun).astype(np.float32) / 255
    behind = paint_backdrop(
        stand, _cast_shadow(tree, shot.yaw, aside), _SHADOW_CELL, np.sign(aside), shot.weather
    )
    alpha = drawn[:, :, 3:]
    picture = drawn[:, :, :3] * alpha + encode_srgb(behind * np.float32(0.92)) * (1 - alpha)
    picture = _plant_blades(picture, stand, shot.weather)
    turn = cv2.getRotationMatrix2D(stand.foot, shot.tilt, 1.0 + 0.02 * abs(shot.tilt))
    size = (stand.width, stand.height)
    picture = cv2.warpAffine(picture, turn, size, flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    picture = cv2.GaussianBlur(picture, (0, 0), 0.45)
    picture = picture * shot.exposure * np.array([shot.warmth, 1.0, 1 / shot.warmth])
    picture += np.random.default_rng(shot.weather).normal(0, 0.004, picture.shape[:2])[:, :, None]
    return np.rint(255 * np.clip(picture, 0, 1)).astype(np.uint8)


def _plant_blades(picture: NDArray[np.float32], stand: Stand, seed: int) -> NDArray[np.float32]:
    """Blades of grass before the trunk's foot, in the colours of the meadow under them."""
    rng = np.random.default_rng(seed)
    drawn = np.ascontiguousarray(picture)
    for away in np.sort(rng.uniform(-1.0, 1.0, 300)):
        x = stand.foot[0] + stand.scale * rng.normal(0, 0.4)
        y = stand.foot[1] + 0.05 * stand.scale * (1 + away) + 1
        beside = picture[int(y) + 6, int(np.clip(x + rng.normal(0, 30), 0, stand.width - 1))]
        tall = stand.scale * rng.uniform(0.04, 0.12)
        ends = [(x, y), (x + rng.normal(0, 0.35) * tall, y - tall)]
        start, end = ([round(16 * part) for part in point] for point in ends)
        color = (beside * rng.uniform(0.72, 1.06)).tolist()
        cv2.line(drawn, start, end, color, 1, cv2.LINE_AA, shift=4)
    return drawn


def _foreshorten(tree: TreeModel, yaw: float, stand: Stand) -> TreeModel:
    """Bends space so that an orthographic picture of it shows the tree in perspective."""
    axes = np.stack(view_axes(yaw))
    eye = np.array([0.0, stand.eye, 0.0])

    def bend(points: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        seen = (points - eye) @ axes.T
        nearer = stand.distance / (stand.distance - seen[:, 2])
        seen[:, :2] *= nearer[:, None]
        return seen @ axes + eye, nearer

    assert tree.foliage is not None
    wood, _ = bend(tree.wood.positions)
    leaves, nearer = bend(tree.foliage.position)
    foliage = replace(
        tree.foliage,
        position=leaves.astype(np.float32),
        scale=(tree.foliage.scale * nearer).astype(np.float32),
    )
    return replace(tree, wood=replace(tree.wood, positions=wood.astype(np.float32)), foliage=foliage)


def _cast_shadow(tree: TreeModel, yaw: float, sun_aside: float) -> NDArray[np.float32]:
    """The share of sunlight on the ground, (n, n): columns to image-right, rows away from the camera."""
    assert tree.foliage is not None
    around, high = np.radians(sun_aside), np.radians(_SUN_ELEVATION)
    corners = tree.wood.positions[tree.wood.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 4
    points = np.concatenate([corners.mean(axis=1), tree.foliage.position])
    weight = np.concatenate([area / 2, 0.30 * tree.foliage.scale**2]) * 0.8
    right, _, toward = view_axes(yaw)
    length = points[:, 1] / np.tan(high)
    aside = points @ right - length * np.sin(around)
    away = -(points @ toward) + length * np.cos(around)
    place = np.stack([away, aside], axis=1) / _SHADOW_CELL + _SHADOW_CELLS / 2
    inside = ((place >= 0) & (place < _SHADOW_CELLS)).all(axis=1)
    row, column = place[inside].astype(int).T
    flat = row * _SHADOW_CELLS + column
    depth = np.bincount(flat, weight[inside], minlength=_SHADOW_CELLS**2).reshape(_SHADOW_CELLS, -1)
    depth = cv2.GaussianBlur(depth / _SHADOW_CELL**2 / np.sin(high), (0, 0), 1.6)
    return np.exp(-depth).astype(np.float32)
