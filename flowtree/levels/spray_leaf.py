"""A spray of leaves on one card: many small leaves for the triangles of one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.srgb import LIGHT_OF_BYTE, encode_srgb_bytes
from flowtree.model.mesh import Material, TreeMesh

Floats = NDArray[np.float64]
_FULL = 0.8  # of the card that leaves would cover if none lay over another
_OUT, _PLAIN = 0.26, 5  # how far side twigs reach, and leaves that need none
_SHADES = 0.22  # by which the leaves of a spray differ in brightness


def spray_leaf(material: Material, aspect: float, count: int) -> tuple[TreeMesh, Material]:
    """Paints ``count`` leaves, one above the other on both sides of a twig, into the picture of one card.

    Fewer leaves of a level of detail would have to be as much larger; cards with sprays are, and the leaves
    on them stay as small as they were.

    Args:
        material: of a single leaf; its picture shows the stalk's end at the bottom.
        aspect: width of that picture over its height.
        count: leaves of the spray.

    Returns: a square card 1 m high in the frame of `Foliage`, of two triangles, and its material.
    """
    length = min(0.5, _FULL / np.sqrt(count * aspect))
    rows = material.base_color.shape[0]
    size = int(min(512, max(128, 32 * round(0.6 * rows / length / 32))))
    x, y = np.meshgrid((np.arange(size) + 0.5) / size - 0.5, 1.0 - (np.arange(size) + 0.5) / size)
    color, alpha = np.zeros((size, size, 3)), np.zeros((size, size))
    share = np.arange(count) / max(count - 1, 1)
    # From the tip down: the upper leaves lie over the lower ones.
    for number in reversed(range(count)):
        up = share[number] * (1.0 - length)
        side = 0 if number == count - 1 else 1 - 2 * (number % 2)
        angle = side * 0.95 * (1.0 - 0.45 * share[number])
        # Every second pair of many stands on side twigs.
        out = side * _OUT * (1.0 - share[number]) * (count > _PLAIN) * (number // 2 % 2)
        right, along = np.cos(angle), np.sin(angle)
        u = 0.5 + (((x - out) * right - (y - up) * along) / length) / aspect
        v = 1.0 - (x * along + (y - up) * right) / length
        picture = _sample(material.base_color, u, v)
        shade = 1.0 + _SHADES * np.cos(2.4 * number)
        free = (1.0 - alpha)[:, :, None] * picture[:, :, 3:]
        color += free * shade * picture[:, :, :3]
        alpha += free[:, :, 0]
    mean = color.sum(axis=(0, 1)) / max(float(alpha.sum()), 1e-9)
    seen = alpha[:, :, None] > 1e-3
    light = np.where(seen, color / np.maximum(alpha[:, :, None], 1e-3), mean)
    texture = np.concatenate(
        [encode_srgb_bytes(light), np.rint(255.0 * alpha)[:, :, None].astype(np.uint8)], 2
    )
    card = TreeMesh(
        positions=np.array([[-0.5, 0, 0], [0.5, 0, 0], [0.5, 1, 0], [-0.5, 1, 0]], np.float32),
        normals=_unit(np.array([[-0.5, -0.3, 1], [0.5, -0.3, 1], [0.5, 0.3, 1], [-0.5, 0.3, 1]])),
        uvs=np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
    name = f"{material.name}_spray"
    # Averaged from afar, hardly any of its leaves would pass the alpha test.
    return card, replace(material, name=name, base_color=texture, normal=None, mipmaps=False)


def _unit(vectors: Floats) -> NDArray[np.float32]:
    scaled: NDArray[np.float32] = (vectors / np.linalg.norm(vectors, axis=1, keepdims=True)).astype(
        np.float32
    )
    return scaled


def _sample(picture: NDArray[np.uint8], u: Floats, v: Floats) -> Floats:
    """Linear light and alpha (h, w, 4) in 0..1 of the texels around places (h, w); 0 outside the picture."""
    rows, columns = picture.shape[:2]
    texels = np.zeros((rows + 2, columns + 2, 4))
    texels[1:-1, 1:-1, :3] = LIGHT_OF_BYTE[picture[:, :, :3]]
    texels[1:-1, 1:-1, 3] = picture[:, :, 3] / 255.0 if picture.shape[2] == 4 else 1.0
    x, y = np.clip(u * columns + 0.5, 0.0, columns + 0.999), np.clip(v * rows + 0.5, 0.0, rows + 0.999)
    left, upper = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - left)[:, :, None], (y - upper)[:, :, None]
    top = (1 - fx) * texels[upper, left] + fx * texels[upper, left + 1]
    bottom = (1 - fx) * texels[upper + 1, left] + fx * texels[upper + 1, left + 1]
    found: Floats = (1 - fy) * top + fy * bottom
    return found
