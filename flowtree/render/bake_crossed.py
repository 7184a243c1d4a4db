"""An impostor of a few upright cards that cross, for any engine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.geometry.octahedral_map import level_axes
from flowtree.model.asset import Card
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from flowtree.render.assemble_scene import Scene, corner_points
from flowtree.render.bake_pictures import (
    CUTOFF,
    LEAST,
    MARGIN,
    CardPicture,
    bake_pictures,
    lay_cards,
    scene_to_bake,
)
from flowtree.render.cast_scene import ParallelView, cast_scene
from flowtree.render.keep_coverage import keep_coverage
from flowtree.render.pack_pictures import pack_pictures
from flowtree.render.render_mask import pixel_share
from flowtree.render.resample_picture import resample_picture
from flowtree.render.share_cards import share_cards
from flowtree.render.space_planes import space_planes

Floats = NDArray[np.float64]

_YAWS = (0.0, 60.0, 120.0)  # [degrees], to which the cards are turned
_CELLS = 64  # along the height, in which the cards' density is shared out
_AROUND: Floats = 15.0 * np.arange(12, dtype=np.float64)  # [degrees], half a turn of views, from which it is
_SHARING_SAMPLES = 6  # rays along a cell's side


class _Cells:
    """The grid of square cells, rows from the top, columns about the y axis, in which density is shared out.

    Attributes:
        cell: side of a cell [m].
        width: columns.
        height: rows.
        foot: (x, y) [cells] of the world's origin.
    """

    def __init__(self, points: NDArray[np.float32], device: str | None) -> None:
        """Covers the points (3, n) [m] from all sides."""
        bottom, tall = float(points[1].min()), float(np.ptp(points[1]))
        reach = float(np.sqrt((points[0] ** 2 + points[2] ** 2).max()))
        self._device = device
        self.cell = max(tall, reach) / _CELLS
        self.width, self.height = 2 * (int(reach / self.cell) + 1), int(tall / self.cell) + 1
        self.foot = (0.5 * self.width, self.height + bottom / self.cell)

    def look(self, scene: Scene, axes: Floats) -> Floats:
        """The share of each cell that a scene covers."""
        view = ParallelView(axes, self.cell, self.foot, self.width, self.height, _SHARING_SAMPLES)
        hit = cast_scene(scene, view, any_hit=True, device=self._device).hit
        return pixel_share(hit, _SHARING_SAMPLES).astype(np.float64)

    def look_around(self, scene: Scene) -> list[Floats]:
        """The same of a scene from all sides."""
        around = [_level_axes(yaw) for yaw in _AROUND]
        return devices.side_by_side(lambda axes: self.look(scene, axes), around)

    def enlarge(self, cover: Floats, picture: CardPicture) -> NDArray[np.float32]:
        """What a picture's pixels are to cover: between the cells' centres."""
        view = picture.view(1)
        ratio = view.metres_per_pixel / self.cell
        down = (np.arange(view.height) + 0.5 - view.foot[1]) * ratio + self.foot[1] - 0.5
        across = (np.arange(view.width) + 0.5 - view.foot[0]) * ratio + self.foot[0] - 0.5
        shown = resample_picture(cover.astype(np.float32), down, across)
        shown[(down < -0.5) | (down > self.height - 0.5)] = 0.0  # below the foot nothing goes on
        return shown


def bake_crossed(tree: TreeModel, *, cards: int = 11, size: int = 2048, device: str | None = None) -> Card:
    """Upright cards that cross: some of them one behind the other, at each of the yaws 0, 60 and 120.

    Every leaf and every piece of wood is shown by the nearest card of each yaw, so it is seen near its place
    from all sides; one card of each yaw stands in the trunk (see `space_planes`). Each card shows so much
    that all together hide what the tree does (see `share_cards`). The texture has colours without light,
    alpha for an alpha test at 0.5 (see `keep_coverage`), and normals in each card's own tangent space (see
    `bake_pictures`). Seen from behind a card shows the same. From far away, too, the texture itself is to be
    sampled, not smaller copies of it (`Material.mipmaps`).

    Args:
        tree: world frame [m].
        cards: of each yaw; those that would show nothing are left out.
        size: side of the texture at most [pixels].
        device: to run on.

    Raises:
        InputError: a tree that has nothing to show, broken arrays, a texture too small for the pictures.
    """
    scene = scene_to_bake(tree)
    place, weight = _pieces(tree, scene)
    axes, places, parts = [], [], []
    for yaw in _YAWS:
        turned = _level_axes(yaw)
        along = (turned[2][:, None] * place).sum(axis=0)  # a matrix product rounds as its threads share it
        planes, nearest = space_planes(along, weight, cards, _trunk_along(tree.skeleton, turned[2]))
        for plane, where in enumerate(planes):
            if (nearest == plane).any():
                axes.append(turned)
                places.append(float(where))
                parts.append(_part(scene, nearest == plane))
    pictures, shape = _arrange(axes, places, parts, size)
    material = replace(bake_pictures(pictures, shape, "impostor_crossed", device=device), mipmaps=False)
    mesh = lay_cards(pictures, shape)
    whole = material.base_color[:, :, 3].astype(np.float32) / np.float32(255.0)

    def keep(picture: CardPicture, cover: Floats) -> None:
        alpha = keep_coverage(whole[picture.area], cells.enlarge(cover, picture), CUTOFF)
        material.base_color[picture.area][:, :, 3] = np.rint(255.0 * alpha)

    def show(covers: Floats) -> list[Floats]:
        devices.side_by_side(keep, pictures, covers)
        return cells.look_around(_cards_alone(mesh, material))

    cells = _Cells(corner_points(scene), device)
    own = devices.side_by_side(lambda each: cells.look(each.scene, each.axes), pictures)
    yaws = np.degrees([np.arctan2(each.axes[2, 0], each.axes[2, 2]) for each in pictures])
    covers = share_cards(
        np.stack(own), yaws, np.array(places) / cells.cell, cells.look_around(scene), _AROUND, show
    )
    devices.side_by_side(keep, pictures, covers)
    return Card("crossed", mesh, material)


def _pieces(tree: TreeModel, scene: Scene) -> tuple[Floats, Floats]:
    """Where each triangle belongs (3, n) [m], and its area (n,).

    A leaf is in one place; wood is in its axis where its vertices know their nodes: what is seen of a limb
    from two sides is on one card.
    """
    corner = scene.positions[:, scene.triangles].astype(np.float64)
    place = corner.mean(axis=2)
    if tree.wood.node is not None:
        node = tree.wood.node[tree.wood.triangles].max(axis=1)
        upper = tree.skeleton.points[node].astype(np.float64).T
        lower = tree.skeleton.points[np.maximum(tree.skeleton.parent[node], 0)].astype(np.float64).T
        wood, rise = place[:, : scene.wood_triangles], upper - lower
        share = ((wood - lower) * rise).sum(axis=0) / np.maximum((rise * rise).sum(axis=0), 1e-30)
        wood[:] = lower + np.clip(share, 0.0, 1.0) * rise
    if tree.foliage is not None:
        leaves = place[:, scene.wood_triangles :].reshape(3, -1, len(tree.foliage.leaf.triangles))
        leaves[:] = leaves.mean(axis=2, keepdims=True)
    one, other = corner[:, :, 1] - corner[:, :, 0], corner[:, :, 2] - corner[:, :, 0]
    area = 0.5 * np.linalg.norm(np.cross(one, other, axis=0), axis=0)
    return place, area


def _trunk_along(skeleton: Skeleton, toward: Floats) -> float:
    """Where the trunk stands in a direction [m]: the median of its volume's thickest parts."""
    stem = np.flatnonzero((skeleton.level == 0) & (skeleton.parent >= 0))
    lower = skeleton.points[skeleton.parent[stem]].astype(np.float64)
    upper = skeleton.points[stem].astype(np.float64)
    thick = np.linalg.norm(upper - lower, axis=1) * skeleton.radius[stem].astype(np.float64) ** 3
    along = (0.5 * (lower + upper) * toward).sum(axis=1)
    order = np.argsort(along, kind="stable")
    total = np.cumsum(thick[order])
    return float(along[order][np.searchsorted(total, 0.5 * total[-1])]) if len(stem) else 0.0


def _level_axes(yaw: float) -> Floats:
    return level_axes(np.array([np.sin(np.radians(yaw)), 0.0, np.cos(np.radians(yaw))]))


def _part(scene: Scene, kept: NDArray[np.bool_]) -> Scene:
    """Some of its triangles."""
    wood = int(np.count_nonzero(kept[: scene.wood_triangles]))
    return replace(scene, triangles=scene.triangles[kept], wood_triangles=wood)


def _arrange(
    axes: list[Floats], places: list[float], parts: list[Scene], size: int
) -> tuple[list[CardPicture], tuple[int, int]]:
    """Cuts each card close around what it shows; with the texture's rows and columns."""
    middles, sizes = [], []
    for turned, where, part in zip(axes, places, parts, strict=True):
        points = corner_points(part).astype(np.float64)
        plane = (turned[:2, :, None] * points).sum(axis=1)
        low, high = plane.min(axis=1), plane.max(axis=1)
        middles.append(np.append(0.5 * (low + high), where) @ turned)
        wide, tall = np.maximum(high - low, 1e-6) / (1.0 - 2.0 * MARGIN)
        sizes.append((float(wide), float(tall)))
    packing = pack_pictures(sizes, size, least=LEAST)
    frames = zip(packing.columns, packing.rows, packing.left, packing.upper, strict=True)
    pictures = [
        CardPicture(part, turned, middle, 1.0 / packing.scale, *frame)
        for part, turned, middle, frame in zip(parts, axes, middles, frames, strict=True)
    ]
    return pictures, packing.shape


def _cards_alone(mesh: TreeMesh, material: Material) -> Scene:
    """The cards as rays see them."""
    return Scene(
        positions=mesh.positions.T,
        normals=mesh.normals.T,
        uvs=mesh.uvs,
        colors=np.ones_like(mesh.positions),
        triangles=mesh.triangles,
        wood_vertices=0,
        wood_triangles=0,
        bark=material,
        leaf=material,
        alpha=material.base_color[:, :, 3].astype(np.float32) / np.float32(255.0),
        cutoff=CUTOFF,
    )
