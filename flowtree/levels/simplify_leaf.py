"""A leaf of few triangles in the place of a finer one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.model.mesh import Material, TreeMesh

Floats = NDArray[np.float64]

_FAINT = 0.5  # of the cut-off: texels of less alpha are not seen even between others
_LEAST = 1e-3  # half width of a corner, in texture widths: a strip must not close


def simplify_leaf(leaf: TreeMesh, material: Material, *, bands: int = 1, pieces: int = 1) -> TreeMesh:
    """Covers what the texture shows of a leaf with strips of ``bands`` trapezoids, flat across.

    A strip runs along the texture's v, no wider than what is seen there, and lies where the leaf's own midrib
    lies: places are looked up on the leaf, and beyond it on the plane of the nearest triangle.

    Args:
        leaf: in the frame of `Foliage`.
        material: its texture; where alpha is below the cut-off nothing is seen.
        bands: trapezoids along the leaf; two triangles each.
        pieces: strips at most. A leaf of more connected pieces, such as crossed planes, keeps the largest;
            what it loses of its area must be made up for by its size.

    Returns: a mesh of ``2 * bands`` triangles a piece, or the leaf itself where it has no more or shows
        nothing.
    """
    found = leaf_pieces(leaf)
    size = [float(_areas(leaf, part).sum()) for part in found]
    chosen = sorted(np.argsort(-np.array(size), kind="stable")[:pieces])
    if len(leaf.triangles) <= 2 * bands * len(chosen):
        return leaf
    strips = [strip for k in chosen if (strip := _strip(leaf, material, found[k], bands)) is not None]
    if not strips:
        return leaf
    rows = 2 * (bands + 1)
    positions, normals, uvs = (np.concatenate([strip[k] for strip in strips]) for k in range(3))
    low = np.arange(0, rows - 2, 2)
    faces = np.stack([low, low + 1, low + 3, low, low + 3, low + 2], axis=1).reshape(-1, 3)
    triangles = np.concatenate([faces + rows * k for k in range(len(strips))])
    return TreeMesh(
        positions=positions.astype(np.float32),
        normals=(normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        uvs=uvs.astype(np.float32),
        triangles=triangles.astype(np.int32),
        colors=None if leaf.colors is None else np.tile(leaf.colors.mean(axis=0), (len(uvs), 1)),
    )


def leaf_pieces(leaf: TreeMesh) -> list[NDArray[np.int32]]:
    """The leaf's triangles (m, 3), those that common vertices join in one array."""
    label = np.arange(len(leaf.positions))
    while True:
        least = label[leaf.triangles].min(axis=1)
        after = label.copy()
        np.minimum.at(after, leaf.triangles.ravel(), np.repeat(least, 3))
        if np.array_equal(after, label):
            break
        label = after
    of = label[leaf.triangles[:, 0]]
    return [leaf.triangles[of == each] for each in np.unique(of)]


def _areas(leaf: TreeMesh, triangles: NDArray[np.int32]) -> Floats:
    a, b, c = (leaf.positions[triangles[:, k]].astype(np.float64) for k in range(3))
    area: Floats = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return area


def _strip(
    leaf: TreeMesh, material: Material, triangles: NDArray[np.int32], bands: int
) -> tuple[Floats, Floats, Floats] | None:
    """Positions, normals and texture coordinates of a piece's strip, from the stalk on, left before right."""
    uvs = leaf.uvs.astype(np.float64)
    low, high = uvs[triangles].min(axis=(0, 1)), uvs[triangles].max(axis=(0, 1))
    v, left, right = _seen_rows(material, low, high)
    if not len(v):
        return None
    half_row = 0.5 / material.base_color.shape[0]
    bottom, top = float(v.max()) + half_row, float(v.min()) - half_row
    middle = 0.5 * float(left.min() + right.max())
    reach = np.maximum(middle - left, right - middle)
    place = (bottom - v) / max(bottom - top, 1e-9)
    corners = np.linspace(0.0, 1.0, bands + 1)
    half = _half_widths(corners, place, reach)
    u = np.stack([middle - half, middle + half], axis=1)
    uv = np.stack([u, np.repeat((bottom + corners * (top - bottom))[:, None], 2, axis=1)], axis=2)
    uv = np.clip(uv.reshape(-1, 2), 0.0, 1.0)
    positions, normals = _look_up(leaf, triangles, uv)
    # Both edges of a folded leaf rise: laid flat, it lies where its midrib is.
    midrib, _ = _look_up(leaf, triangles, np.repeat(uv.reshape(-1, 2, 2).mean(axis=1), 2, axis=0))
    edges = positions.reshape(-1, 2, 3)
    across = 0.5 * (edges[:, 1] - edges[:, 0])
    flat = midrib + np.stack([-across, across], axis=1).reshape(-1, 3)
    return flat, normals, uv


def _seen_rows(material: Material, low: Floats, high: Floats) -> tuple[Floats, Floats, Floats]:
    """Of the texture's rows in which something is seen between two corners: v, and u from and to."""
    picture = material.base_color
    rows, columns = picture.shape[:2]
    v, u = (np.arange(rows) + 0.5) / rows, (np.arange(columns) + 0.5) / columns
    inside = ((v >= low[1]) & (v <= high[1]))[:, None] & ((u >= low[0]) & (u <= high[0]))
    if picture.shape[2] == 4 and material.alpha_cutoff is not None:
        inside &= picture[:, :, 3] >= 255.0 * _FAINT * material.alpha_cutoff
    seen = inside.any(axis=1)
    first = np.argmax(inside[seen], axis=1)
    last = columns - np.argmax(inside[seen, ::-1], axis=1)
    return v[seen], first / columns, last / columns


def _half_widths(corners: Floats, place: Floats, reach: Floats) -> Floats:
    """Half widths at places 0..1 along a strip that holds every row's reach, each as small as the others let.

    One after the other is lowered, once from the stalk and once from the tip on; the lesser area counts.
    """
    found = []
    for order in (np.arange(len(corners)), np.arange(len(corners))[::-1]):
        half = np.full(len(corners), float(reach.max()))
        for k in order:
            own = np.interp(place, corners, np.eye(len(corners))[k])
            rest = np.interp(place, corners, np.where(np.arange(len(corners)) == k, 0.0, half))
            need = np.divide(reach - rest, own, out=np.zeros_like(reach), where=own > 1e-9)
            half[k] = max(float(need.max()), _LEAST)
        found.append(half)
    return min(found, key=lambda one: float(np.sum((one[1:] + one[:-1]) * np.diff(corners))))


def _look_up(leaf: TreeMesh, triangles: NDArray[np.int32], uv: Floats) -> tuple[Floats, Floats]:
    """Position and normal (n, 3) of the leaf's surface at texture coordinates (n, 2)."""
    a, b, c = (leaf.uvs[triangles[:, k]].astype(np.float64) for k in range(3))
    b, c = b - a, c - a
    area = b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0]
    flat = np.abs(area) < 1e-12
    away = uv[:, None, :] - a[None]
    over = 1.0 / np.where(flat, 1.0, area)
    second = (away[:, :, 0] * c[:, 1] - away[:, :, 1] * c[:, 0]) * over
    third = (b[:, 0] * away[:, :, 1] - b[:, 1] * away[:, :, 0]) * over
    weight = np.stack([1.0 - second - third, second, third], axis=2)
    # The triangle that holds the point, or the one of which it lies least outside.
    inner = np.where(flat, -np.inf, weight.min(axis=2))
    best = np.argmax(inner, axis=1)
    share = weight[np.arange(len(uv)), best][:, :, None]
    corner = triangles[best]
    position: Floats = np.sum(share * leaf.positions[corner], axis=1)
    normal: Floats = np.sum(np.clip(share, 0.0, 1.0) * leaf.normals[corner], axis=1)
    return position, normal
