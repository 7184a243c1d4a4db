"""Pictures of a tree, or of parts of it, in one texture, and the flat pieces that show them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree import device as devices
from flowtree.geometry.srgb import encode_srgb_bytes
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.render.assemble_scene import Scene, assemble_scene
from flowtree.render.cast_scene import ParallelView
from flowtree.render.dilate_colors import dilate_colors
from flowtree.render.view_tree_from import texture_pyramids, view_tree_from

MARGIN = 1.0 / 32.0  # of a picture, kept free on every side: its halved pictures do not show its neighbours
LEAST = 8  # pixels of a picture's sides
CUTOFF = 0.5  # of the alpha test
_SAMPLES = 2  # along a pixel's side
_TWIG_SAMPLES = 3  # of bare trees, whose twigs are thinner than pixels


@dataclass(frozen=True)
class CardPicture:
    """One picture in the texture.

    Attributes:
        scene: what it shows.
        axes: (3, 3), as in `ParallelView`.
        middle: (3,) [m], what is in its centre, in the plane of the piece that shows it.
        pixel: side of a pixel [m].
        columns: width [pixels].
        rows: height [pixels].
        left: its first column in the texture [pixels].
        upper: its first row [pixels].
    """

    scene: Scene
    axes: NDArray[np.float64]
    middle: NDArray[np.float64]
    pixel: float
    columns: int
    rows: int
    left: int
    upper: int

    @property
    def half(self) -> tuple[float, float]:
        """Half of its width and height [m]."""
        return 0.5 * self.pixel * self.columns, 0.5 * self.pixel * self.rows

    @property
    def area(self) -> tuple[slice, slice]:
        """Its rows and columns of the texture."""
        return slice(self.upper, self.upper + self.rows), slice(self.left, self.left + self.columns)

    def view(self, samples: int) -> ParallelView:
        """Its rays, so many along a pixel's side."""
        middle = self.axes @ self.middle
        foot = (0.5 * self.columns - middle[0] / self.pixel, 0.5 * self.rows + middle[1] / self.pixel)
        return ParallelView(self.axes, self.pixel, foot, self.columns, self.rows, samples)


def scene_to_bake(tree: TreeModel) -> Scene:
    """The tree's triangles.

    Raises:
        InputError: a tree that has nothing to show, or broken arrays.
    """
    scene = assemble_scene(tree)
    something = len(scene.triangles) > 0
    check.require(something, "tree", "needs a triangle or a leaf", "neither", "mesh the skeleton first")
    return scene


def bake_pictures(
    pictures: Sequence[CardPicture],
    shape: tuple[int, int],
    name: str,
    *,
    depths: bool = False,
    device: str | None = None,
) -> Material:
    """Paints all pictures into one texture.

    Colours are without light; where nothing is seen they go on (see `dilate_colors`). Alpha is the share of
    each pixel that is tree. Normals are those of the flat piece's tangent space: (right, up, toward the eye).

    Args:
        pictures: at least one; they do not overlap.
        shape: rows and columns of the texture.
        name: of the material.
        depths: whether the normal map's alpha holds how far what is seen lies above the picture's plane, as
            a share of the picture's half width, -1..1 written as 0..1.
        device: to run on.
    """
    pyramids = texture_pyramids(pictures[0].scene)
    color = np.zeros((*shape, 4), np.uint8)
    normal = np.full((*shape, 4 if depths else 3), 128, np.uint8)
    normal[:, :, 2] = 255

    def bake(each: CardPicture) -> None:
        samples = _TWIG_SAMPLES if each.scene.leaf is None else _SAMPLES
        seen = view_tree_from(each.scene, each.view(samples), pyramids, device=device)
        above = (seen.depth - np.float32(each.axes[2] @ each.middle)) / np.float32(each.half[0])
        filled = dilate_colors(
            np.concatenate([seen.color, seen.normal, above[:, :, None]], axis=2), seen.alpha
        )
        length = np.linalg.norm(filled[:, :, 3:6], axis=2, keepdims=True)
        facing = filled[:, :, 3:6] / np.maximum(length, np.float32(1e-6))
        color[each.area][:, :, :3] = encode_srgb_bytes(filled[:, :, :3])
        color[each.area][:, :, 3] = np.rint(255.0 * seen.alpha)
        normal[each.area][:, :, :3] = np.rint(127.5 * (facing + 1.0))
        if depths:
            normal[each.area][:, :, 3] = np.rint(127.5 * (np.clip(filled[:, :, 6], -1.0, 1.0) + 1.0))

    devices.side_by_side(bake, pictures)  # each in its own part of the texture
    return Material(name, color, normal=normal, double_sided=True, alpha_cutoff=CUTOFF)


def lay_cards(pictures: Sequence[CardPicture], shape: tuple[int, int]) -> TreeMesh:
    """A rectangle in the place of each picture, of a texture of so many rows and columns."""
    positions, normals, uvs, triangles, tangents = [], [], [], [], []
    for number, each in enumerate(pictures):
        right, up = each.half[0] * each.axes[0], each.half[1] * each.axes[1]
        positions.append(each.middle + np.stack([-right - up, right - up, right + up, up - right]))
        normals.append(np.tile(each.axes[2], (4, 1)))
        u = (each.left + np.array([0, each.columns, each.columns, 0])) / shape[1]
        v = (each.upper + np.array([each.rows, each.rows, 0, 0])) / shape[0]
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
