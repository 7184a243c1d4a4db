"""The wood's surface as one closed mesh of quads (Manifold Ramifications, Ma et al.)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.catmull_clark import ROUND, subdivide_corners, subdivide_quads
from flowtree.geometry.parent_array import depths
from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.branch_curves import BranchCurves, trace_curves
from flowtree.meshing.build_tubes import (
    BASE,
    CLOSED,
    FOOT,
    ControlMesh,
    RingCorners,
    build_tubes,
    drift_left,
    drifted,
    place_corners,
    turns_of,
)
from flowtree.meshing.check_skeleton import check_skeleton
from flowtree.meshing.classify_ramifications import (
    ADDITIONAL,
    CONNECTABLE,
    LATER,
    TRUNK,
    Ramifications,
    classify_ramifications,
)
from flowtree.meshing.find_exits import Exits, leave_wood
from flowtree.meshing.find_hosts import find_faces, find_holes
from flowtree.meshing.lay_rings import ControlRings, lay_rings
from flowtree.meshing.open_faces import Openings, open_faces
from flowtree.meshing.paste_ramifications import fill_face, open_vertices, paste_subdivided
from flowtree.meshing.place_units import Units, place_units, shape_collars
from flowtree.meshing.relax_creases import relax_creases
from flowtree.model.mesh import QuadMesh
from flowtree.model.skeleton import Skeleton
from flowtree.params import MeshingParams

_EMPTY = (((0, 3), float), ((0,), int), ((0, 4), int), ((0, 4, 2), float), ((0,), int), ((0,), int))
_LIFT = 0.3  # radii by which a start boundary is lifted from the face, where little smoothing follows
_RISE = 1.0  # radii by which the crotch of a branch along its host is filled
_RISE_LIFTED = 0.3  # the same where the boundary is lifted
# Square tubes turn by 90 degrees at their edges, octagons by 45.
_SHARP_BEFORE, _SHARP = 105.0, 58.0  # [degrees], creases that are rounded before and after the last step
_ROUNDS_BEFORE, _ROUNDS = 15, 160
_THIN = 0.25  # of the host's radius: thinner branches fit into one face of it, once subdivided


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
    work = _Work(exits, curves.host, made, units, rings, corners, targets, depth, steps)
    none = ControlMesh(*(np.zeros(shape, kind) for shape, kind in _EMPTY))
    mesh = _grown(work, 0, none)
    for step in range(1, steps + 1):
        if step == steps:
            mesh = _relaxed(mesh, _SHARP_BEFORE, _ROUNDS_BEFORE)
        mesh = _subdivided(mesh)
        mesh = _pasted(work, step - 1, mesh)
        mesh = _grown(work, step, mesh)
    if steps:
        mesh = _relaxed(mesh, _SHARP, _ROUNDS)
    return _finished(mesh, float(skeleton.points[0, 1]))


@dataclass(frozen=True)
class _Work:
    """What is known of all branches before the first quad is made."""

    exits: Exits
    host: Ints
    made: Ramifications
    units: Units
    rings: ControlRings
    corners: RingCorners
    target: Floats  # (c, 3) [m], where on its host's surface each begins
    depth: Ints  # (c,) branches between each and branch 0
    steps: int  # subdivisions of the whole

    def openings(self, branch: Ints, vertex: Ints) -> Openings:
        """What is asked of the hosts of branches (p,) whose rings begin at vertices (r,)."""
        ring = self.corners.first[branch]
        exits = self.exits
        # What sees one subdivision more gets its fillet from that.
        last = self.made.birth[branch] + 1 >= self.steps
        lift = np.where(last, _LIFT, 0.0) * exits.radius[branch]
        rise = np.where(last, _RISE_LIFTED, _RISE) * exits.radius[branch] * exits.lean[branch]
        return Openings(
            base=vertex[ring],
            start=self.corners.corner[ring],
            target=self.target[branch],
            along=exits.host_along[branch],
            half=exits.half[branch],
            lift=lift[:, None] * exits.way[branch],
            rise=rise,
        )

    def main_faces(self, branch: Ints, quad: Ints) -> Ints:
        """The quads (p,) of their hosts' units that connectable branches (p,) leave through.

        Args:
            branch: (p,).
            quad: (r,) the quad of side 0 above each ring.
        """
        row = np.empty(len(self.host), np.int64)
        row[self.units.owner] = np.arange(len(self.units.owner))
        owner = self.made.unit[branch]
        ring = self.rings.start[row[owner]]
        quarter = 0.5 * np.pi
        main = np.rint((self.made.angle[owner] - self.rings.turn[ring]) / quarter)
        aside = np.rint((self.made.angle[branch] - self.made.angle[owner]) / quarter)
        return np.asarray(quad[ring] + (main + aside).astype(np.int64) % 4, np.int64)


def _targets(curves: BranchCurves, exits: Exits, made: Ramifications) -> Floats:
    """Where on their hosts' surfaces branches begin: at the middle of a unit, or where they come out."""
    unit = np.where(made.kind == CONNECTABLE, made.unit, np.arange(len(made.unit)))
    axis, radius, _ = curves.at(np.maximum(curves.host, 0), made.middle[unit])
    place: Floats = axis + radius[:, None] * exits.outward
    return place


def _grown(work: _Work, step: int, mesh: ControlMesh) -> ControlMesh:
    """The mesh with the branches that are made after so many subdivisions."""
    made = work.made
    branches = np.flatnonzero(made.birth == step)
    if not len(branches):
        return mesh
    capped = (made.kind == TRUNK) | (made.kind == ADDITIONAL)
    tubes, vertex, quad = build_tubes(work.rings, work.corners, branches, capped)
    vertex, quad = vertex + len(mesh.positions), quad + len(mesh.quads)
    mesh = mesh.joined(tubes)

    main = np.full(len(work.host), -1, np.int64)
    planted = branches[made.kind[branches] == CONNECTABLE]
    main[planted] = work.main_faces(planted, quad)
    mesh.kind[main[planted]] = CLOSED  # kept for them
    # From hosts to what leaves them: where a host was moved, its branches begin where it is now.
    depth = work.depth[branches]
    for level in np.unique(depth):
        now = branches[depth == level]
        mesh = _put_in(work, step, mesh, now[made.kind[now] == LATER], vertex)
        planted = now[made.kind[now] == CONNECTABLE]
        mesh = open_faces(mesh, main[planted], work.openings(planted, vertex))
        _follow(work, mesh, planted, vertex)
    return mesh


def _put_in(work: _Work, step: int, mesh: ControlMesh, later: Ints, vertex: Ints) -> ControlMesh:
    """The mesh with branches (p,) joined to quads of their hosts that nobody has kept for them."""
    if not len(later):
        return mesh
    thick = work.exits.radius[later] >= _THIN * work.exits.host_radius[later]
    wide = later[thick & (work.made.birth[work.host[later]] < step)]
    hole = find_holes(mesh, work.host[wide], work.target[wide], work.exits.radius[wide])
    found = hole[:, 0] >= 0
    mesh = open_vertices(mesh, hole[found], work.openings(wide[found], vertex))
    _follow(work, mesh, wide[found], vertex)
    later = later[~np.isin(later, wide[found])]
    while len(later):
        face = find_faces(mesh, work.host[later], work.target[later], work.exits.radius[later])
        put = face >= 0
        mesh = open_faces(mesh, face[put], work.openings(later[put], vertex))
        _follow(work, mesh, later[put], vertex)
        later = later[~put]
    return mesh


def _follow(work: _Work, mesh: ControlMesh, branch: Ints, vertex: Ints) -> None:
    """Moves the first rings of branches (p,), and what leaves them, to where hosts have let them begin."""
    corners, exits = work.corners, work.exits
    first = corners.first[branch]
    base = mesh.positions[vertex[first][:, None] + np.arange(4)].mean(axis=1)
    asked = work.openings(branch, vertex)
    aside = asked.lift + 0.5 * asked.rise[:, None] * asked.along
    off = np.zeros((len(corners.first), 3))
    off[branch] = base - aside - corners.corner[first].mean(axis=1)
    chosen = np.zeros(len(off), np.bool_)
    chosen[branch] = True
    chain = work.rings.chain
    ring = np.flatnonzero(chosen[chain])
    on = chain[ring]
    away = work.rings.arc[ring] - work.rings.arc[corners.first[on]]
    rows = vertex[ring][:, None] + np.arange(4)
    corner = mesh.positions[rows]
    based = ring == corners.first[on]
    corner[based] = corners.corner[ring[based]]
    center = corner.mean(axis=1)
    moved = drifted(on, away, off, exits.radius)
    turn = turns_of(on, center, center + moved)
    corner = (center + moved)[:, None] + np.einsum("rij,rkj->rki", turn, corner - center[:, None])
    mesh.positions[rows[~based]] = corner[~based]
    follower = np.flatnonzero(chosen[work.host] & (work.host >= 0))
    host = work.host[follower]
    away = work.made.middle[follower] - work.rings.arc[corners.first[host]]
    work.target[follower] += drift_left(away, off[host], exits.radius[host])


def _pasted(work: _Work, step: int, mesh: ControlMesh) -> ControlMesh:
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


def _relaxed(mesh: ControlMesh, limit: float, rounds: int) -> ControlMesh:
    """The mesh with its creases of more than a limit [degrees] rounded."""
    return replace(mesh, positions=relax_creases(mesh, limit=limit, rounds=rounds, kept=(BASE, FOOT)))


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
