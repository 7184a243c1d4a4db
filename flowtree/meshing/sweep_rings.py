"""The wood's surface: rings swept along every branch and joined by triangles."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.kernels import sweep_rings as kernels
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.check_skeleton import check_skeleton
from flowtree.meshing.map_bark import BarkMap, map_bark
from flowtree.meshing.place_rings import Rings, place_rings
from flowtree.meshing.transport_frames import transport_frames
from flowtree.model.mesh import TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

_GOLDEN_ANGLE = np.pi * (3.0 - 5.0**0.5)
_SPLIT_FROM = 512  # rows of vertices


def sweep_rings(
    skeleton: Skeleton, *, params: MeshingParams = MeshingParams(), device: str | None = None
) -> TreeMesh:
    """Covers every branch with a closed tube of rings perpendicular to it (Particle Flows, section 8).

    The paper connects discs along the branch and gives no more detail. Here:

    - A branch continues into its thickest child. Every other child is a tube of its own that begins on its
      parent's axis with a ring inside the parent, never thicker than it: no gap shows, and the surface is a
      union of closed pieces (not one boolean union; pieces overlap inside the wood).
    - Each piece is watertight once `close_seams` has merged the vertices that differ in texture coordinates
      alone: each edge then belongs to two triangles. The positions of such twins are equal to the last bit.
    - Rings are carried along the branch by rotation-minimising frames, so the bark does not twist. The foot
      stands flat on the ground and flares; thick branches have a collar; tips are domes, twigs are points.
    - The bark has one scale, close to `params.bark_scale` [m] a repeat, is finer on thin branches, is not
      stretched and has no seam: see `map_bark`. Tangents point around the branch, bitangents to its tip (up
      the texture, against v), as glTF's normal maps want it.

    Repairs, none of which is an error: radii below 1e-5 of the tree's extent are raised to it; nodes closer
    than a third of the radius share a ring; branches of no length are left out.

    Args:
        skeleton: world frame [m].
        params: sides of the thickest ring, root flare, bark scale.
        device: to run on; None takes the best there is.

    Returns: triangles in the world frame, one tube behind the other, the trunk first.

    Raises:
        InputError: fewer than two nodes; lengths that differ; a parent that does not come before its child;
            NaN; a negative radius; all nodes in one place.
    """
    check_skeleton(skeleton)
    rings = place_rings(skeleton, params)
    bark = map_bark(rings, params.bark_scale)
    sides = rings.sides[rings.chain[bark.ring]]
    # A ring's last column repeats its first, where the texture ends; an apex has one corner a side.
    columns = np.where(np.isneginf(rings.slope)[bark.ring], sides, sides + 1)
    offset = np.concatenate(([0], np.cumsum(columns)))
    positions, normals, uvs, tangents = _place(rings, bark, sides, offset, devices.pick_device(device))
    return TreeMesh(
        positions,
        normals,
        uvs,
        _triangles(rings, bark.ring, offset),
        tangents=tangents,
        node=np.repeat(rings.node[bark.ring], columns).astype(np.int32),
    )


def _place(
    rings: Rings, bark: BarkMap, sides: Ints, offset: Ints, device: str
) -> tuple[NDArray[np.float32], ...]:
    """Positions [m], normals, texture coordinates and tangents of all rows of vertices."""
    one, two = transport_frames(rings.center, rings.tangent, rings.chain, device=device)
    # Blades lie all ways round, or from one side all of them would be seen by their edges.
    turn = np.where(rings.sides == 2, _GOLDEN_ANGLE * np.arange(len(rings.sides)), 0.0)[rings.chain][:, None]
    one, two = np.cos(turn) * one + np.sin(turn) * two, np.cos(turn) * two - np.sin(turn) * one

    def up(values: Floats | Ints, kind: Any) -> Any:
        return devices.upload(values.astype(np.int32 if kind is wp.int32 else np.float64), kind, device)

    vectors = [up(a, wp.vec3d) for a in (rings.center, rings.tangent, one, two)]
    numbers = [up(a, wp.float64) for a in (rings.radius, rings.slope)]
    rows = [up(a, wp.int32) for a in (bark.ring, sides, offset, bark.repeats)]
    kinds = (wp.vec3, wp.vec3, wp.vec2, wp.vec4)
    outputs = [devices.empty(int(offset[-1]), kind, device) for kind in kinds]
    inputs = [*vectors, *numbers, *rows, up(bark.start, wp.vec2d)]
    devices.launch(kernels.place_vertices, len(sides), inputs, outputs, device=device, split_from=_SPLIT_FROM)
    return tuple(a.numpy() for a in outputs)


def _triangles(rings: Rings, ring_of_row: Ints, offset: Ints) -> NDArray[np.int32]:
    """Two triangles a side between rings of a branch, one a side at its apex, a fan that closes its base."""
    chain = rings.chain[ring_of_row]
    # Rows on the same ring differ in texture alone: between them there is nothing to cover.
    lower = np.flatnonzero((chain[1:] == chain[:-1]) & (ring_of_row[1:] != ring_of_row[:-1]))
    sides = rings.sides[chain[lower]]
    row = np.repeat(lower, sides)
    side = np.arange(len(row)) - np.repeat(np.cumsum(sides) - sides, sides)
    low, high = offset[row] + side, offset[row + 1] + side
    wall = np.stack([low, low + 1, high, low + 1, high + 1, high], axis=1).reshape(-1, 3)
    to_apex = np.isneginf(rings.slope)[ring_of_row[row + 1]]
    wall = wall[np.stack([np.ones_like(to_apex), ~to_apex], axis=1).ravel()]

    first = np.flatnonzero(np.diff(chain, prepend=-1))
    fan = rings.sides - 2
    base = np.repeat(offset[first], fan)
    corner = np.arange(len(base)) - np.repeat(np.cumsum(fan) - fan, fan) + 1
    floor = np.stack([base, base + corner + 1, base + corner], axis=1)
    return np.concatenate([wall, floor]).astype(np.int32)
