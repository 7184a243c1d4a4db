"""Makes the control meshes of branches and lets them begin in the wood of their hosts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.build_tubes import (
    CLOSED,
    ControlMesh,
    RingCorners,
    build_tubes,
    drift_left,
    drifted,
    turns_of,
)
from flowtree.meshing.classify_ramifications import ADDITIONAL, CONNECTABLE, LATER, TRUNK, Ramifications
from flowtree.meshing.find_exits import Exits
from flowtree.meshing.find_hosts import find_faces, find_holes
from flowtree.meshing.lay_rings import ControlRings
from flowtree.meshing.open_faces import Openings, open_faces
from flowtree.meshing.paste_ramifications import open_vertices
from flowtree.meshing.place_units import Units

_LIFT = 0.3  # radii by which a start boundary is lifted from the face, where little smoothing follows
_RISE = 1.0  # radii by which the crotch of a branch along its host is filled
_RISE_LIFTED = 0.3  # the same where the boundary is lifted
_THIN = 0.25  # of the host's radius: thinner branches fit into one face of it, once subdivided


@dataclass(frozen=True)
class Growth:
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


def grow_branches(work: Growth, step: int, mesh: ControlMesh) -> ControlMesh:
    """The mesh with the branches that are made after so many subdivisions.

    Connectable branches begin in the main faces of their units, others in quads that nobody has kept
    (Manifold Ramifications, sections 4 and 6).

    Args:
        work: what is known of all branches; targets move with hosts that were moved.
        step: subdivisions so far.
        mesh: of the branches made before.
    """
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


def _put_in(work: Growth, step: int, mesh: ControlMesh, later: Ints, vertex: Ints) -> ControlMesh:
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


def _follow(work: Growth, mesh: ControlMesh, branch: Ints, vertex: Ints) -> None:
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
