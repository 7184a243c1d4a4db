"""Impostors: a few flat cards with pictures of the tree on them."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree import device as devices
from flowtree.geometry.octahedral_map import level_axes, square_to_direction
from flowtree.geometry.srgb import encode_srgb_bytes
from flowtree.model.asset import Card
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.render.assemble_scene import Scene, assemble_scene, corner_points
from flowtree.render.cast_scene import ParallelView, cast_scene
from flowtree.render.dilate_colors import dilate_colors
from flowtree.render.keep_coverage import keep_coverage
from flowtree.render.render_mask import pixel_share
from flowtree.render.share_cards import share_cards
from flowtree.render.view_tree_from import texture_pyramids, view_tree_from

_CUTOFF = 0.5
_MARGIN = 1.0 / 32.0  # of a picture, kept free on every side: its halved pictures do not show its neighbours
_SAMPLES = 2  # along a pixel's side
_TWIG_SAMPLES = 3  # of bare trees, whose twigs are thinner than pixels
_BLEND_SAMPLES = 6  # the same for alpha that is not cut off: colours change less from ray to ray
_SHARING_SAMPLES = 6
_YAWS = (0.0, 45.0, 90.0, 135.0)  # [degrees], of the crossed cards
_COLUMNS = 2  # of their pictures in the texture
_CELLS = 64  # along the height, in which the crossed cards' density is shared out
_VIEWS = 12  # over half a turn, from which it is
_LEAST = 8  # pixels of a picture


@dataclass(frozen=True)
class _Picture:
    """One picture in the texture.

    Attributes:
        axes: (3, 3), as in `ParallelView`.
        middle: (3,) [m], what is in its centre.
        half: half width and half height [m].
        left: column of the texture [pixels].
        upper: row of the texture [pixels].
    """

    axes: NDArray[np.float64]
    middle: NDArray[np.float64]
    half: tuple[float, float]
    left: int
    upper: int


@dataclass(frozen=True)
class _Shares:
    """What each crossed card is to cover.

    Attributes:
        cover: (c, h, w) in 0..1, rows from the top, columns about the y axis.
        cell: side of a cell [m].
        top: height of the first row's upper edge [m].
    """

    cover: NDArray[np.float64]
    cell: float
    top: float

    def at(
        self, card: int, foot: tuple[float, float], pixel: float, shape: tuple[int, ...]
    ) -> NDArray[np.float32]:
        """Between the cells' centres, in a picture's pixels."""
        cover: NDArray[np.float32] = self.cover[card].astype(np.float32)
        height = (foot[1] - np.arange(shape[0]) - 0.5) * pixel
        across = (np.arange(shape[1]) + 0.5 - foot[0]) * pixel
        places = ((self.top - height) / self.cell - 0.5, across / self.cell + 0.5 * cover.shape[1] - 0.5)
        for axis, place in enumerate(places):
            low = np.clip(np.floor(place).astype(np.int64), 0, cover.shape[axis] - 1)
            high = np.minimum(low + 1, cover.shape[axis] - 1)
            part = np.clip(place - low, 0.0, 1.0).astype(np.float32)
            part = part[:, None] if axis == 0 else part[None, :]
            cover = (1 - part) * np.take(cover, low, axis) + part * np.take(cover, high, axis)
        return np.asarray(cover, np.float32)


def bake_crossed(tree: TreeModel, *, size: int = 2048, device: str | None = None) -> Card:
    """Four upright cards that cross in the trunk, seen from yaw 0, 45, 90 and 135.

    The texture shows the pictures in two rows, yaw 0 on the upper left and 45 beside it; seen from behind a
    card shows the same. It has colours without light, alpha for an alpha test at 0.5 (see `keep_coverage`),
    of each card so much that all together hide what the tree does (see `share_cards`), and normals in the
    card's own tangent space. Where nothing is seen the colours go on (see `dilate_colors`).

    Args:
        tree: world frame [m].
        size: longer side of the texture [pixels].
        device: to run on.

    Raises:
        InputError: a tree that has nothing to show, or broken arrays.
    """
    scene, low, high = _bounds(tree)
    spans = []
    for yaw in _YAWS:
        axes = level_axes(np.array([np.sin(np.radians(yaw)), 0.0, np.cos(np.radians(yaw))]))
        across = axes[0].astype(np.float32) @ corner_points(scene)
        spans.append((axes, float(across.min()), float(across.max())))
    tall = float(high[1] - low[1])
    wide = max(right - left for _, left, right in spans)
    lines = len(_YAWS) // _COLUMNS
    pixel = max(_COLUMNS * wide, lines * tall) / (size * (1.0 - 2.0 * _MARGIN))
    columns, rows = (
        max(_LEAST, round(length / pixel / (1.0 - 2.0 * _MARGIN) / 4.0) * 4) for length in (wide, tall)
    )
    pictures = []
    for number, (axes, left, right) in enumerate(spans):
        middle = 0.5 * (left + right) * axes[0] + np.array([0.0, 0.5 * (low[1] + high[1]), 0.0])
        half = (0.5 * pixel * columns, 0.5 * pixel * rows)
        line, column = divmod(number, _COLUMNS)
        pictures.append(_Picture(axes, middle, half, column * columns, line * rows))
    shares = _share(scene, float(low[1]), tall, device)
    whole = (_COLUMNS * columns, lines * rows)
    material = _bake(scene, pictures, (columns, rows), whole, "impostor_crossed", device, shares)
    return Card("crossed", _cards(pictures, (columns, rows), whole), material)


def bake_octahedral(
    tree: TreeModel, *, size: int = 2048, frames: int = 12, device: str | None = None
) -> Card:
    """One card for a shader that turns it to the eye, with pictures from the whole upper half of the world.

    The texture has ``frames`` x ``frames`` square pictures. The one in column i and row j, counted from the
    upper left, is seen from the direction at (2 i / (frames - 1) - 1, 2 j / (frames - 1) - 1) of the
    hemi-octahedral map (`square_to_direction`): the pictures at the border are seen from the horizon. Each
    shows the square of side ``s`` around the point ``c``, across its direction, image-right level
    (`level_axes`); c and s are the middle and the side of the card's mesh, which shows the picture from the
    direction nearest to +z. A shader blends the three nearest pictures: see `look_up_impostor`.

    Colours and normals are as in `bake_crossed`; the normals are (right, up, toward) of their own picture.
    Alpha is the share of each texel that is tree, for a shader that blends or dithers it. The normal map's
    alpha a is how far what is seen lies above the picture's plane, toward its eye: ``(a - 0.5) * s``, as far
    as it goes.

    Args:
        tree: world frame [m].
        size: side of the texture [pixels]; what ``frames`` do not divide is left out.
        frames: pictures along each side.
        device: to run on.

    Raises:
        InputError: a tree that has nothing to show, broken arrays, pictures smaller than 8 pixels.
    """
    side = size // max(frames, 1)
    check.require(
        frames >= 2 and side >= _LEAST,
        "impostor",
        f"needs 2 pictures along a side, of {_LEAST} pixels each",
        f"{frames} of {side} pixels",
        "choose fewer frames or a larger size",
    )
    scene, low, high = _bounds(tree)
    middle = 0.5 * (low + high).astype(np.float64)
    points = corner_points(scene)
    reach = float(np.sqrt(((points - middle[:, None].astype(np.float32)) ** 2).sum(axis=0).max()))
    half = reach / (1.0 - 2.0 * _MARGIN)
    place = 2.0 * np.arange(frames) / (frames - 1) - 1.0
    column, row = np.meshgrid(np.arange(frames), np.arange(frames))
    toward = square_to_direction(np.stack([place[column.ravel()], place[row.ravel()]], axis=1))
    pictures = [
        _Picture(level_axes(out), middle, (half, half), int(i) * side, int(j) * side)
        for out, i, j in zip(toward, column.ravel(), row.ravel(), strict=True)
    ]
    whole = (frames * side, frames * side)
    material = _bake(scene, pictures, (side, side), whole, "impostor_octahedral", device)
    front = pictures[int(np.argmax(toward[:, 2]))]
    ahead = _Picture(level_axes(np.array([0.0, 0.0, 1.0])), middle, front.half, front.left, front.upper)
    return Card("octahedral", _cards([ahead], (side, side), whole), material, frames)


def _bounds(tree: TreeModel) -> tuple[Scene, NDArray[np.float32], NDArray[np.float32]]:
    """The tree's triangles, and the corners (3,) of the box around them."""
    scene = assemble_scene(tree)
    something = len(scene.triangles) > 0
    check.require(something, "tree", "needs a triangle or a leaf", "neither", "mesh the skeleton first")
    points = corner_points(scene)
    return scene, points.min(axis=1), points.max(axis=1)


def _share(scene: Scene, bottom: float, tall: float, device: str | None) -> _Shares:
    """What each card is to cover, from pictures all around that are no finer than that."""
    points = corner_points(scene)
    reach = float(np.sqrt((points[0] ** 2 + points[2] ** 2).max()))
    cell = max(tall, reach) / _CELLS
    width, height = 2 * (int(reach / cell) + 1), int(tall / cell) + 1
    yaws = np.asarray(np.arange(_VIEWS) * (180.0 / _VIEWS), np.float64)
    foot = (0.5 * width, height + bottom / cell)

    def look(yaw: float) -> NDArray[np.float64]:
        axes = level_axes(np.array([np.sin(np.radians(yaw)), 0.0, np.cos(np.radians(yaw))]))
        view = ParallelView(axes, cell, foot, width, height, _SHARING_SAMPLES)
        hit = cast_scene(scene, view, any_hit=True, device=device).hit
        return pixel_share(hit, _SHARING_SAMPLES).astype(np.float64)

    views = devices.side_by_side(look, yaws)
    own = [views[int(np.argmin(np.abs(yaws - yaw)))] for yaw in _YAWS]
    return _Shares(share_cards(own, np.array(_YAWS), views, yaws), cell, bottom + cell * height)


def _bake(
    scene: Scene,
    pictures: list[_Picture],
    picture: tuple[int, int],
    whole: tuple[int, int],
    name: str,
    device: str | None,
    shares: _Shares | None = None,
) -> Material:
    """The texture of all pictures, sizes (columns, rows) [pixels]; with shares it is for an alpha test.

    Without, the normal map has depths in its alpha.
    """
    columns, rows = picture
    bare = scene.leaf is None
    samples = _TWIG_SAMPLES if bare else _SAMPLES
    pyramids = texture_pyramids(scene)
    color = np.zeros((whole[1], whole[0], 4), np.uint8)
    deep = shares is None
    normal = np.empty((whole[1], whole[0], 4 if deep else 3), np.uint8)

    def bake(number: int, each: _Picture) -> None:
        pixel = 2.0 * each.half[0] / columns
        foot = (
            0.5 * columns - float(each.middle @ each.axes[0]) / pixel,
            0.5 * rows + float(each.middle @ each.axes[1]) / pixel,
        )
        view = ParallelView(each.axes, pixel, foot, columns, rows, samples)
        seen = view_tree_from(scene, view, pyramids, device=device)
        height = (seen.depth - np.float32(each.middle @ each.axes[2])) / np.float32(each.half[0])
        filled = dilate_colors(
            np.concatenate([seen.color, seen.normal, height[:, :, None]], axis=2), seen.alpha
        )
        length = np.linalg.norm(filled[:, :, 3:6], axis=2, keepdims=True)
        facing = filled[:, :, 3:6] / np.maximum(length, np.float32(1e-6))
        area = (slice(each.upper, each.upper + rows), slice(each.left, each.left + columns))
        color[area][:, :, :3] = encode_srgb_bytes(filled[:, :, :3])
        alpha = seen.alpha
        if shares is not None:
            alpha = keep_coverage(alpha, _CUTOFF, shares.at(number, foot, pixel, alpha.shape))
        elif bare:
            finer = replace(view, samples=_BLEND_SAMPLES)
            alpha = pixel_share(cast_scene(scene, finer, any_hit=True, device=device).hit, finer.samples)
        color[area][:, :, 3] = np.rint(255.0 * alpha)
        normal[area][:, :, :3] = np.rint(127.5 * (facing + 1.0))
        if deep:
            normal[area][:, :, 3] = np.rint(127.5 * (np.clip(filled[:, :, 6], -1.0, 1.0) + 1.0))

    devices.side_by_side(bake, range(len(pictures)), pictures)  # each in its own part of the texture
    return Material(name, color, normal=normal, double_sided=True, alpha_cutoff=_CUTOFF)


def _cards(pictures: list[_Picture], picture: tuple[int, int], whole: tuple[int, int]) -> TreeMesh:
    """A rectangle in the place of each picture."""
    positions, normals, uvs, triangles, tangents = [], [], [], [], []
    for number, each in enumerate(pictures):
        right, up = each.half[0] * each.axes[0], each.half[1] * each.axes[1]
        positions.append(each.middle + np.stack([-right - up, right - up, right + up, up - right]))
        normals.append(np.tile(each.axes[2], (4, 1)))
        u = (each.left + np.array([0, picture[0], picture[0], 0])) / whole[0]
        v = (each.upper + np.array([picture[1], picture[1], 0, 0])) / whole[1]
        uvs.append(np.stack([u, v], axis=1))
        triangles.append(4 * number + np.array([[0, 1, 2], [0, 2, 3]]))
        tangents.append(np.tile(np.append(each.axes[0], 1.0), (4, 1)))
    return TreeMesh(
        positions=np.concatenate(positions).astype(np.float32),
        normals=np.concatenate(normals).astype(np.float32),
        uvs=np.concatenate(uvs).astype(np.float32),
        triangles=np.concatenate(triangles).astype(np.int32),
        tangents=np.concatenate(tangents).astype(np.float32),
    )
