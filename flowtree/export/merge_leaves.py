"""All leaves as one mesh: what every program draws quickly and no program turns into 100,000 objects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.outward_directions import outward_directions
from flowtree.geometry.rotation_matrices import rotation_matrices
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh


def merge_leaves(foliage: Foliage) -> TreeMesh:
    """Places every leaf and joins them: leaf k owns the k-th run of vertices and of triangles.

    The normals are bent toward the direction that leads out of the crown (`outward_directions`) by
    ``foliage.rounding``, on the side of the leaf that looks there; the other side, whose normal a renderer
    flips, looks outward too when it is seen from outside. So the crown is shaded as one soft body, as a real
    one is by light that passes through its leaves, and single leaves still glitter. A normal never leaves the
    half space of its own side.

    Args:
        foliage: n leaves of m vertices.

    Returns:
        n * m vertices, world frame [m], with colours (leaf's times the shape's own, linear), the leaf's node,
        and its tangents where the shape has any.
    """
    leaf, count = foliage.leaf, len(foliage.position)
    axes = rotation_matrices(foliage.rotation).astype(np.float32)
    positions = _rotate(axes * foliage.scale.astype(np.float32)[:, None, None], leaf.positions)
    positions += foliage.position[:, None, :]
    normals = _rotate(axes, leaf.normals)
    if foliage.rounding and count:
        _bend_outward(normals, _centres(positions), foliage.rounding)
    first = np.arange(count, dtype=np.int32) * np.int32(len(leaf.positions))
    triangles = leaf.triangles[None, :, :] + first[:, None, None]
    colors = np.repeat(foliage.color.astype(np.float32)[:, None, :], len(leaf.positions), axis=1)
    if leaf.colors is not None:
        colors *= leaf.colors
    return TreeMesh(
        positions=positions.reshape(-1, 3),
        normals=normals.reshape(-1, 3),
        uvs=np.tile(leaf.uvs.astype(np.float32), (count, 1)),
        triangles=triangles.reshape(-1, 3).astype(np.int32),
        colors=colors.reshape(-1, 3),
        tangents=None if leaf.tangents is None else _tangents(axes, leaf.tangents),
        node=np.repeat(foliage.node.astype(np.int32), len(leaf.positions)),
    )


def _tangents(axes: NDArray[np.float32], own: NDArray[np.float32]) -> NDArray[np.float32]:
    turned = _rotate(axes, own[:, :3])
    sign = np.broadcast_to(own[None, :, 3:], (*turned.shape[:2], 1))
    return np.concatenate([turned, sign.astype(np.float32)], axis=2).reshape(-1, 4)


def _rotate(matrices: NDArray[np.float32], vectors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Every matrix (n, 3, 3) times every vector (m, 3): (n, m, 3)."""
    # Written out, not left to a matrix product: its rounding would depend on how many cores share the work.
    x, y, z = vectors.astype(np.float32).T
    result = np.empty((len(matrices), len(vectors), 3), np.float32)
    for row in range(3):
        a, b, c = matrices[:, row, :, None].transpose(1, 0, 2)
        result[:, :, row] = a * x + b * y + c * z
    return result


def _centres(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """The middle of each leaf, (n, 3)."""
    middle: NDArray[np.float32] = positions.mean(axis=1, dtype=np.float64).astype(np.float32)
    return middle


def _bend_outward(normals: NDArray[np.float32], centres: NDArray[np.float32], share: float) -> None:
    """Bends the normals (n, m, 3) in place; those of a leaf at the very centre stay."""
    outward = outward_directions(centres)
    if not outward.any():
        return
    own = (normals * outward[:, None, :]).sum(axis=2, dtype=np.float32)
    # The side is chosen for the whole leaf, so that its shading has no break.
    side = np.where(own.sum(axis=1) < 0, np.float32(-1), np.float32(1))
    bent = np.float32(1 - share) * normals + np.float32(share) * (side[:, None] * outward)[:, None, :]
    length = np.linalg.norm(bent, axis=2, keepdims=True)
    np.divide(bent, length, out=normals, where=length > 1e-3)
