"""Textures no larger than asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.srgb import LIGHT_OF_BYTE, encode_srgb_bytes
from flowtree.model.mesh import Material
from flowtree.model.tree import TreeModel


def limit_textures(levels: Sequence[TreeModel], size: int) -> tuple[TreeModel, ...]:
    """Halves the levels' pictures until none is wider or higher than ``size`` pixels.

    Colours are averaged as light, weighed by their alpha; normals as directions. Of a picture that wants no
    smaller copies (`Material.mipmaps`) every second pixel stays. What levels share they still share
    afterwards: the same picture is one array.

    Args:
        levels: of one tree.
        size: [pixels].
    """
    made: dict[int, Material] = {}

    def smaller(material: Material) -> Material:
        if id(material) not in made:
            made[id(material)] = _limit(material, size)
        return made[id(material)]

    def limited(tree: TreeModel) -> TreeModel:
        bark, foliage = smaller(tree.bark), tree.foliage
        if foliage is not None:
            material = smaller(foliage.material)
            foliage = foliage if material is foliage.material else replace(foliage, material=material)
        same = bark is tree.bark and foliage is tree.foliage
        return tree if same else replace(tree, bark=bark, foliage=foliage)

    return tuple(limited(tree) for tree in levels)


def _limit(material: Material, size: int) -> Material:
    color, normal = material.base_color, material.normal
    while max(color.shape[:2]) > size:
        color = _halve_color(color) if material.mipmaps else color[::2, ::2]
    while normal is not None and max(normal.shape[:2]) > size:
        normal = _halve_normal(normal)
    if color is material.base_color and normal is material.normal:
        return material
    return replace(material, base_color=color, normal=normal)


def _halve_color(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    light = LIGHT_OF_BYTE[picture[:, :, :3]]
    if picture.shape[2] == 3:
        return encode_srgb_bytes(_halve(light))
    alpha = picture[:, :, 3:].astype(np.float64)
    # A little weight everywhere keeps the colours beside a leaf, which filters look at.
    weight = alpha + 1e-3
    mean = _halve(light * weight) / _halve(weight)
    return np.concatenate([encode_srgb_bytes(mean), np.rint(_halve(alpha)).astype(np.uint8)], axis=2)


def _halve_normal(picture: NDArray[np.uint8]) -> NDArray[np.uint8]:
    mean = _halve(picture / 127.5 - 1.0)
    length = np.linalg.norm(mean, axis=2, keepdims=True)
    small: NDArray[np.uint8] = np.rint(127.5 * (mean / np.maximum(length, 1e-6) + 1.0)).astype(np.uint8)
    return small


def _halve(picture: NDArray[np.floating[Any]]) -> NDArray[np.float64]:
    """The means of two by two pixels; a last odd row or column counts twice."""
    even = np.pad(picture, [(0, picture.shape[0] % 2), (0, picture.shape[1] % 2), (0, 0)], mode="edge")
    four = even[::2, ::2] + even[1::2, ::2] + even[::2, 1::2] + even[1::2, 1::2]
    return np.asarray(four / 4.0, np.float64)
