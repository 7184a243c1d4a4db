"""The wood's surface as one closed mesh of quads (Manifold Ramifications, Ma et al.)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.catmull_clark import ROUND, subdivide_corners, subdivide_quads
from flowtree.geometry.parent_array import depths
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.branch_curves import BranchCurves, trace_curves
from flowtree.meshing.build_tubes import BASE, FOOT, ControlMesh, place_corners
from flowtree.meshing.check_skeleton import check_skeleton
from flowtree.meshing.classify_ramifications import (
    ADDITIONAL,
    CONNECTABLE,
    Ramifications,
    classify_ramifications,
)
from flowtree.meshing.find_exits import Exits, leave_wood
from flowtree.meshing.find_hosts import find_faces, find_holes
from flowtree.meshing.free_edges import free_edges
from flowtree.meshing.grow_branches import Growth, grow_branches
from flowtree.meshing.lay_rings import lay_rings
from flowtree.meshing.paste_ramifications import fill_face, paste_subdivided
from flowtree.meshing.place_units import place_units, shape_collars
from flowtree.meshing.relax_creases import relax_creases
from flowtree.meshing.spread_creases import spread_creases
from flowtree.meshing.unfold_creases import unfold_creases
from flowtree.model.mesh import QuadMesh
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

_EMPTY = (((0, 3), float), ((0,), int), ((0, 4), int), ((0, 4, 2), float), ((0,), int), ((0,), int))
# Square tubes turn by 90 degrees at their edges, octagons by 45.
_SHARP_BEFORE, _SHARP = 105.0, 58.0  # [degrees], creases that are rounded before and after the last step
_ROUNDS_BEFORE, _ROUNDS = 15, 10
_SHARPEST = 59.5  # [degrees], what is left of them is spread


def connect_ramifications(
    skeleton: Skeleton,
    *,
    params: MeshingParams = MeshingParams(),
    all_additional: bool = False,
    device: str | None = None,
) -> QuadMesh:
    """Covers all branches with one closed surface of quads, smooth at forks (Manifold Ramifications).

    1. Branches are followed to where they leave their hosts (`leave_wood`); connectable ones get a unit of
       their host, a stretch whose main face faces them (`classify_ramifications`, `place_units`).
    2. The control mesh is square tubes through the units' boundaries (`lay_rings`, `build_tubes`), wider than
       the branches by what subdivision takes. A connectable branch begins in the main face (`open_faces`).
    3. After a Catmull-Clark subdivision the additional ramifications are cut and pasted (`find_holes`,
       `paste_subdivided`); thin branches are put in then, too, so that they do not get a trunk's sides.

    The surface is closed by construction: every branch begins as a piece of a sphere of its own, takes the
    place of quads that no other branch takes, and is joined to their edge quad by quad. So whatever the
    skeleton it is one closed, consistently oriented two-manifold with Euler characteristic 2. Where there is
    no room the geometry gives way, not the topology: units are pushed along their branch, a branch without a
    unit is pasted, one without four free quads around a vertex gets a single quad (of six quads' filling),
    and one without a free quad nearby gets one of those around a branch that was put in before it. Rings that
    would cut each other are turned to one plane. Surfaces of different branches may still pass through each
    other where the skeleton's branches do.

    Unlike the paper, in short: subdivision rounds a little more (`ROUND`); thin branches are made later; a
    child may leave its host off the middle of a face; branches that leave at a few degrees do so where they
    have come out of the host's wood.

    Repairs, none of which is an error: those of `trace_curves`; a child thicker than its host begins as wide
    as the host's face; a branch that ends inside its host is continued out of it by 1.5 radii.

    Args:
        skeleton: world frame [m].
        params: how often to subdivide, root flare, bark scale.
        all_additional: connect no branch before the first subdivision, as in the paper's figure 10.
        device: to run on; None takes the best there is.

    Returns: quads with texture coordinates; as many vertices as quads and two more.

    Raises:
        InputError: what `check_skeleton` refuses; all nodes in one place.
    """
    check_skeleton(skeleton)
    steps = params.subdivisions
    curves, exits = leave_wood(trace_curves(skeleton, device=device))
    made = classify_ramifications(curves, exits, subdivisions=steps, all_additional=all_additional)
    collars = shape_collars(curves, exits, made.birth, max(steps - 1, 0))
    made, units = place_units(curves, exits, made, collars, subdivisions=steps)
    targets = _targets(curves, exits, made)
    drift = targets - curves.at(np.arange(len(targets)), exits.begin)[0]
    drift[0] = 0.0
    rings = lay_rings(curves, exits, made, units, collars, drift)
    corners = place_corners(curves, exits, rings, drift, steps - made.birth, params)
    depth = depths(curves.host).astype(np.int64)
    work = Growth(exits, curves.host, made, units, rings, corners, targets, depth, steps)
    none = ControlMesh(*(np.zeros(shape, kind) for shape, kind in _EMPTY))
    mesh = grow_branches(work, 0, none)
    for step in range(1, steps + 1):
        if step == steps:
            mesh = _rounded(mesh)
        mesh = _subdivided(mesh)
        mesh = _pasted(work, step - 1, mesh)
        mesh = grow_branches(work, step, mesh)
    if steps:
        mesh = replace(mesh, positions=_smooth(mesh))
    return _finished(mesh, float(skeleton.points[0, 1]))


def _targets(curves: BranchCurves, exits: Exits, made: Ramifications) -> Floats:
    """Where on their hosts' surfaces branches begin: at the middle of a unit, or where they come out."""
    unit = np.where(made.kind == CONNECTABLE, made.unit, np.arange(len(made.unit)))
    axis, radius, _ = curves.at(np.maximum(curves.host, 0), made.middle[unit])
    place: Floats = axis + radius[:, None] * exits.outward
    return place


def _pasted(work: Growth, step: int, mesh: ControlMesh) -> ControlMesh:
    """The mesh with the additional ramifications that were made before the last subdivision joined to it."""
    branch = np.flatnonzero((work.made.kind == ADDITIONAL) & (work.made.birth == step))
    if not len(branch):
        return mesh
    hole = find_holes(mesh, work.host[branch], work.target[branch], work.exits.radius[branch])
    found = hole[:, 0] >= 0
    mesh = paste_subdivided(mesh, hole[found], _bases(mesh, branch[found]))
    left = branch[~found]
    while len(left):
        face = find_faces(mesh, work.host[left], work.target[left], work.exits.radius[left])
        put = face >= 0
        mesh = fill_face(mesh, face[put], _bases(mesh, left[put]))
        left = left[~put]
    return mesh


def _bases(mesh: ControlMesh, branch: Ints) -> Ints:
    """The four quads (p, 4) that close the bases of branches (p,), as one quad became them."""
    base = np.flatnonzero(mesh.kind == BASE)
    base = base[np.argsort(mesh.branch[base], kind="stable")]
    at = np.searchsorted(mesh.branch[base], branch)
    rows: Ints = base[at[:, None] + np.arange(4)]
    return rows


def _rounded(mesh: ControlMesh) -> ControlMesh:
    """The mesh before its last subdivision, its sharpest edges rounded."""
    edges, limit, rounds = free_edges(mesh, (BASE, FOOT)), _SHARP_BEFORE, _ROUNDS_BEFORE
    return replace(
        mesh, positions=relax_creases(mesh.positions, mesh.quads, edges, limit=limit, rounds=rounds)
    )


def _smooth(mesh: ControlMesh) -> Floats:
    """The finished mesh's positions without creases: most are rounded, the rest spread, folds laid anew."""
    quads, edges = mesh.quads, free_edges(mesh, (BASE, FOOT))
    positions = relax_creases(mesh.positions, quads, edges, limit=_SHARP, rounds=_ROUNDS)
    positions = spread_creases(positions, quads, edges, limit=_SHARPEST)
    return unfold_creases(positions, quads, edges, limit=_SHARPEST)


def _subdivided(mesh: ControlMesh) -> ControlMesh:
    """After one more step of Catmull and Clark's scheme."""
    positions, quads, edges = subdivide_quads(mesh.positions, mesh.quads, rounding=ROUND)
    uvs = subdivide_corners(mesh.quads, mesh.uvs, rounding=ROUND)
    node = np.concatenate([mesh.node, mesh.node[edges].max(axis=1), mesh.node[mesh.quads].max(axis=1)])
    return ControlMesh(
        positions,
        node,
        quads,
        uvs,
        np.repeat(mesh.branch, 4),
        np.repeat(mesh.kind, 4),
    )


def _finished(mesh: ControlMesh, ground: float) -> QuadMesh:
    """The mesh without vertices that nothing uses, its foot flat."""
    used = np.zeros(len(mesh.positions), np.bool_)
    used[mesh.quads] = True
    positions = mesh.positions
    foot = mesh.quads[mesh.kind == FOOT]
    positions[foot.ravel(), 1] = ground
    return QuadMesh(
        positions=_apart(positions[used].astype(np.float32)),
        quads=(np.cumsum(used) - 1)[mesh.quads].astype(np.int32),
        node=mesh.node[used].astype(np.int32),
        uvs=mesh.uvs.astype(np.float32),
    )


def _apart(positions: NDArray[np.float32]) -> NDArray[np.float32]:
    """The same places, where rounding has put two vertices in one moved to the next number.

    A texture seam splits vertices; they are told from others by their place (`close_seams`).
    """
    positions = positions + np.float32(0.0)  # of two zeros one
    while True:
        bits = positions.view(np.uint32).astype(np.uint64)
        key = (bits * np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], np.uint64)).sum(
            axis=1
        )
        ordered = np.sort(key)
        if not (ordered[1:] == ordered[:-1]).any():
            return positions
        order = np.argsort(key, kind="stable")
        twin = order[1:][key[order[1:]] == key[order[:-1]]]
        positions[twin, 0] = np.nextafter(positions[twin, 0], np.float32(np.inf))
