"""The wood's surface: rings swept along every branch and joined by triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.meshing.place_rings import Floats, Ints, Rings, place_rings
from flowtree.meshing.transport_frames import transport_frames
from flowtree.model.mesh import TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

_GOLDEN = 0.6180339887498949


def sweep_rings(skeleton: Skeleton, *, params: MeshingParams = MeshingParams()) -> TreeMesh:
    """Covers every branch with a closed tube of rings perpendicular to it (Particle Flows, section 8).

    The paper connects discs along the branch and gives no more detail. Here:

    - A branch continues into its thickest child. Every other child is a tube of its own that begins on its
      parent's axis with a ring inside the parent, never thicker than it: no gap shows, and the surface is a
      union of closed pieces (not one boolean union; pieces overlap inside the wood).
    - Each piece is watertight once `close_seams` has merged the vertices that differ in texture coordinates
      alone: each edge then belongs to two triangles. The positions of such twins are equal to the last bit.
    - Rings are carried along the branch by rotation-minimising frames, so the bark does not twist. The foot
      stands flat on the ground and flares; thick branches have a collar; tips are domes, twigs are points.
    - The bark has one scale everywhere, `params.bark_scale` [m] a repeat, along and around. Around a branch u
      runs out and back again, meeting itself at a line below the branch (on upright ones: behind), so there
      is no seam at any circumference, and a tapering branch neither stretches nor shrinks its bark.

    Repairs, none of which is an error: radii below 1e-5 of the tree's extent are raised to it; nodes closer
    than a third of the radius share a ring; branches of no length are left out.

    Args:
        skeleton: world frame [m].
        params: sides of the thickest ring, root flare, bark scale.

    Returns: triangles in the world frame, one tube behind the other, the trunk first.

    Raises:
        InputError: fewer than two nodes; lengths that differ; a parent that does not come before its child;
            NaN; a negative radius; all nodes in one place.
    """
    _check(skeleton)
    rings = place_rings(skeleton, params)
    one, two = transport_frames(rings.center, rings.tangent, rings.chain)

    sides = rings.sides[rings.chain]
    apex = np.isneginf(rings.slope)
    columns = np.where(apex, sides, sides + 1)  # a ring's last repeats its first: it ends the texture
    offset = np.concatenate(([0], np.cumsum(columns)))
    row = np.repeat(np.arange(len(columns)), columns)
    column = np.arange(offset[-1]) - offset[row]
    # The twin's angle is computed from the same number, so that its position is the same float.
    angle = 2.0 * np.pi * (column % sides[row]) / sides[row]
    outward = np.cos(angle)[:, None] * one[row] + np.sin(angle)[:, None] * two[row]
    return TreeMesh(
        positions=(rings.center[row] + rings.radius[row, None] * outward).astype(np.float32),
        normals=_normals(outward, rings, row),
        uvs=_uvs(rings, row, (column + 0.5 * apex[row]) / sides[row], params.bark_scale),
        triangles=_triangles(rings, offset),
    )


def _normals(outward: Floats, rings: Rings, row: Ints) -> NDArray[np.float32]:
    apex = np.isneginf(rings.slope)
    lean = np.where(apex, 1.0, -rings.slope)
    normal = outward * np.where(apex, 0.0, 1.0)[row, None] + lean[row, None] * rings.tangent[row]
    unit: NDArray[np.float32] = (normal / np.linalg.norm(normal, axis=1, keepdims=True)).astype(np.float32)
    return unit


def _uvs(rings: Rings, row: Ints, around: Floats, scale: float) -> NDArray[np.float32]:
    """Texture coordinates; v falls toward the tip, because pictures count rows from above.

    Every branch starts elsewhere in the picture, or neighbours would look alike.
    """
    width = np.pi * _settled(rings)[row] / scale
    out_and_back = 1.0 - np.abs(2.0 * around - 1.0)
    branch = rings.chain[row] + 1
    u = (out_and_back - 0.5) * width + (branch * _GOLDEN) % 1.0
    v = (branch * _GOLDEN**2) % 1.0 - rings.arc[row] / scale
    return np.stack([u, v], axis=1).astype(np.float32)


def _settled(rings: Rings) -> Floats:
    """(k,) [m] the bark's radius, its steps at forks spread over the rings beside them.

    Where the radius falls at once, bark that follows it would slant; three binomial passes halve that.
    """
    radius = rings.bark_radius.copy()
    same_before = np.concatenate(([False], rings.chain[1:] == rings.chain[:-1]))
    same_after = np.append(same_before[1:], False)
    for _ in range(3):
        before = np.where(same_before, np.roll(radius, 1), radius)
        after = np.where(same_after, np.roll(radius, -1), radius)
        radius = 0.25 * before + 0.5 * radius + 0.25 * after
    return radius


def _triangles(rings: Rings, offset: Ints) -> NDArray[np.int32]:
    """Two triangles a side between rings of a branch, one a side at its apex, a fan that closes its base."""
    follows = np.flatnonzero(rings.chain[1:] == rings.chain[:-1])
    sides = rings.sides[rings.chain[follows]]
    ring = np.repeat(follows, sides)
    side = np.arange(len(ring)) - np.repeat(np.cumsum(sides) - sides, sides)
    low, high = offset[ring] + side, offset[ring + 1] + side
    wall = np.stack([low, low + 1, high, low + 1, high + 1, high], axis=1).reshape(-1, 3)
    to_apex = np.isneginf(rings.slope)[ring + 1]
    wall = wall[np.stack([np.ones_like(to_apex), ~to_apex], axis=1).ravel()]

    first = np.flatnonzero(np.diff(rings.chain, prepend=-1))
    fan = rings.sides - 2
    base = np.repeat(offset[first], fan)
    corner = np.arange(len(base)) - np.repeat(np.cumsum(fan) - fan, fan) + 1
    floor = np.stack([base, base + corner + 1, base + corner], axis=1)
    return np.concatenate([wall, floor]).astype(np.int32)


def _check(skeleton: Skeleton) -> None:
    n = len(skeleton.parent)
    check.require(n >= 2, "skeleton", "needs two nodes or more", n, "trace more particles")
    check.array(skeleton.points, "skeleton points", shape=(n, 3))
    check.array(skeleton.radius, "skeleton radius", shape=(n,), low=0.0)
    check.array(skeleton.particles, "skeleton particles", shape=(n,), dtype=np.int32)
    parent = check.array(skeleton.parent, "skeleton parent", shape=(n,), dtype=np.int32)
    before = parent[0] == -1 and bool(np.all((parent[1:] >= 0) & (parent[1:] < np.arange(1, n))))
    check.require(
        before,
        "skeleton parent",
        "must be -1 at node 0 alone and come before its child",
        "another order",
        "sort the nodes from the root to the tips",
    )
