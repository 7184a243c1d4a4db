"""An impostor with pictures from the whole upper half of the world."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flowtree import check
from flowtree import device as devices
from flowtree.geometry.octahedral_map import level_axes, square_to_direction
from flowtree.geometry.smallest_ball import smallest_ball
from flowtree.model.asset import Card
from flowtree.model.tree import TreeModel
from flowtree.render.assemble_scene import corner_points
from flowtree.render.bake_pictures import (
    LEAST,
    MARGIN,
    CardPicture,
    bake_pictures,
    lay_cards,
    scene_to_bake,
)
from flowtree.render.cast_scene import cast_scene
from flowtree.render.render_mask import pixel_share

_TWIG_SAMPLES = 6  # along a pixel's side: alpha that is not cut off needs more rays than colours


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

    Colours and normals are as in `bake_pictures`: the normals are (right, up, toward) of their own picture.
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
        frames >= 2 and side >= LEAST,
        "impostor",
        f"needs 2 pictures along a side, of {LEAST} pixels each",
        f"{frames} of {side} pixels",
        "choose fewer frames or a larger size",
    )
    scene = scene_to_bake(tree)
    middle, reach = smallest_ball(corner_points(scene).astype(np.float64))
    pixel = 2.0 * reach / (1.0 - 2.0 * MARGIN) / side
    place = 2.0 * np.arange(frames) / (frames - 1) - 1.0
    column, row = np.meshgrid(np.arange(frames), np.arange(frames))
    toward = square_to_direction(np.stack([place[column.ravel()], place[row.ravel()]], axis=1))
    pictures = [
        CardPicture(scene, level_axes(out), middle, pixel, side, side, int(i) * side, int(j) * side)
        for out, i, j in zip(toward, column.ravel(), row.ravel(), strict=True)
    ]
    whole = (frames * side, frames * side)
    material = bake_pictures(pictures, whole, "impostor_octahedral", depths=True, device=device)
    if scene.leaf is None:

        def refine(picture: CardPicture) -> None:
            hit = cast_scene(scene, picture.view(_TWIG_SAMPLES), any_hit=True, device=device).hit
            material.base_color[picture.area][:, :, 3] = np.rint(255.0 * pixel_share(hit, _TWIG_SAMPLES))

        devices.side_by_side(refine, pictures)
    front = pictures[int(np.argmax(toward[:, 2]))]
    ahead = replace(front, axes=level_axes(np.array([0.0, 0.0, 1.0])))
    return Card("octahedral", lay_cards([ahead], whole), material, frames)
