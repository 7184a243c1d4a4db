"""Bark and leaf in one picture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel

_GUTTER = 8  # pixels around the leaf: halved three times, it still does not touch its neighbours
_WIDE = 0.7  # repeats: so wide are the hidden floors of branches alone
_JUST = 1e-4  # of a repeat: u that is a whole number up to rounding
_FLAT = (128, 128, 255)


@dataclass(frozen=True)
class _Layout:
    """Where things lie in the atlas: sizes in pixels.

    Attributes:
        width: of the atlas.
        height: of the atlas: a whole number of bark tiles.
        strip: width of the bark, from the left.
        tile: (rows, columns) of a bark tile.
        leaf: (rows, columns) of the leaf.
    """

    width: int
    height: int
    strip: int
    tile: tuple[int, int]
    leaf: tuple[int, int]


def pack_atlas(levels: Sequence[TreeModel]) -> tuple[TreeModel, ...]:
    """Lays the bark's and the leaf's textures into one, shared by all levels.

    On the left a strip of bark, as high as the atlas: along a branch, v, it repeats with the atlas; around
    it, u, the wood's triangles are moved to where the strip holds them, so the strip is a tile wide and as
    much more as the widest triangle needs. Vertices that triangles then want in two places are doubled, with
    equal positions. On the right the leaf, with a gutter of its own colours.

    Args:
        levels: of one tree, all of the same bark. Those of the same leaf share an atlas; those that show
            sprays of leaves have their own.

    Returns: the levels with one picture for wood and leaves, and one normal map for those that have any; as
        they are where there is no leaf.
    """
    groups: dict[int, list[TreeModel]] = {}
    for level in levels:
        if level.foliage is not None:
            groups.setdefault(id(level.foliage.material), []).append(level)
    packed: dict[int, TreeModel] = {}
    for group in groups.values():
        packed |= {id(level): made for level, made in zip(group, _pack_group(group), strict=True)}
    return tuple(packed.get(id(level), level) for level in levels)


def _pack_group(levels: list[TreeModel]) -> tuple[TreeModel, ...]:
    """The levels, all with leaves of one material, with one atlas."""
    foliage = levels[0].foliage
    assert foliage is not None
    bark, leaf = levels[0].bark, foliage.material
    widest = max((_reach(level.wood) for level in levels), default=1.0)
    tile = bark.base_color.shape[:2]
    strip = int(np.ceil(min(widest, 2.0) * tile[1]))
    rows, columns = leaf.base_color.shape[:2]
    repeats = -(-(rows + 2 * _GUTTER) // tile[0])
    width = -(-(strip + columns + 2 * _GUTTER) // 4) * 4
    layout = _Layout(width, repeats * tile[0], strip, (tile[0], tile[1]), (rows, columns))
    color, normal = _paint(bark, leaf, layout)
    # Where the leaf has no relief its half of the map is flat, and its mesh has no tangents to read it by.
    trunk, blade = (
        replace(
            each,
            base_color=color,
            normal=None if each.normal is None else normal,
            alpha_cutoff=leaf.alpha_cutoff,
            repeats=True,
        )
        for each in (bark, leaf)
    )
    return tuple(
        replace(
            level,
            wood=_move_wood(level.wood, layout),
            bark=trunk,
            foliage=None
            if level.foliage is None
            else replace(level.foliage, leaf=_move_leaf(level.foliage.leaf, layout), material=blade),
        )
        for level in levels
    )


def _shifts(wood: TreeMesh) -> NDArray[np.int64]:
    """(m,) the whole number by which each triangle's u is too large."""
    least = wood.uvs[wood.triangles][:, :, 0].min(axis=1)
    whole: NDArray[np.int64] = np.floor(least + _JUST).astype(np.int64)
    return whole


def _reach(wood: TreeMesh) -> float:
    """How far u goes from 0 on when every triangle is moved there [repeats], but for the widest ones."""
    u = wood.uvs[wood.triangles][:, :, 0]
    largest = (u.max(axis=1) - _shifts(wood))[np.ptp(u, axis=1) < _WIDE]
    return float(max(largest.max(initial=1.0), 1.0))


def _move_wood(wood: TreeMesh, layout: _Layout) -> TreeMesh:
    shift = np.repeat(_shifts(wood), 3)
    vertex = wood.triangles.ravel().astype(np.int64)
    least = int(shift.min(initial=0))
    span = int(shift.max(initial=0)) - least + 1
    key, place = np.unique(vertex * span + shift - least, return_inverse=True)
    source, moved = key // span, key % span + least
    # What the strip does not hold, of hidden floors, ends at its edge.
    u = np.clip((wood.uvs[source, 0] - moved) * layout.tile[1], 0.0, layout.strip) / layout.width
    v = wood.uvs[source, 1] * (layout.tile[0] / layout.height)
    return TreeMesh(
        positions=wood.positions[source],
        normals=wood.normals[source],
        uvs=np.stack([u, v], axis=1).astype(np.float32),
        triangles=place.reshape(-1, 3).astype(np.int32),
        colors=None if wood.colors is None else wood.colors[source],
        tangents=None if wood.tangents is None else wood.tangents[source],
        node=None if wood.node is None else wood.node[source],
    )


def _move_leaf(leaf: TreeMesh, layout: _Layout) -> TreeMesh:
    corner = np.array([layout.strip + _GUTTER, _GUTTER])
    size = np.array([layout.leaf[1], layout.leaf[0]])
    uvs = (corner + leaf.uvs * size) / np.array([layout.width, layout.height])
    return replace(leaf, uvs=uvs.astype(np.float32))


def _paint(
    bark: Material, leaf: Material, layout: _Layout
) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    color = np.zeros((layout.height, layout.width, 4), np.uint8)
    normal = np.full((layout.height, layout.width, 3), _FLAT, np.uint8)
    times = (layout.height // layout.tile[0], 2, 1)
    color[:, : layout.strip, :3] = np.tile(bark.base_color[:, :, :3], times)[:, : layout.strip]
    color[:, : layout.strip, 3] = 255
    rows, columns = layout.leaf
    frame = [(_GUTTER, _GUTTER), (_GUTTER, _GUTTER), (0, 0)]
    wide = (slice(0, rows + 2 * _GUTTER), slice(layout.strip, layout.strip + columns + 2 * _GUTTER))
    inner = (slice(_GUTTER, _GUTTER + rows), slice(layout.strip + _GUTTER, layout.strip + _GUTTER + columns))
    color[wide][:, :, :3] = np.pad(leaf.base_color[:, :, :3], frame, mode="edge")
    opaque = leaf.base_color.shape[2] == 3
    color[inner][:, :, 3] = 255 if opaque else leaf.base_color[:, :, 3]
    if bark.normal is not None:
        normal[:, : layout.strip] = np.tile(bark.normal, times)[:, : layout.strip]
    if leaf.normal is not None:
        normal[inner] = leaf.normal
    return color, None if bark.normal is None and leaf.normal is None else normal
