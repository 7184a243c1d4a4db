"""Finds for every branch the quads of its host that it may take the place of."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.build_tubes import HOSTING, ControlMesh

_LOOKED_AT = 3  # places that each branch chooses among


def find_faces(mesh: ControlMesh, host: Ints, target: Floats, rank: Floats) -> Ints:
    """A quad of its host for each branch, near its target; no quad for two branches.

    Args:
        mesh: HOSTING quads may be taken.
        host: (p,), the branch whose quads each may take.
        target: (p, 3) [m].
        rank: (p,), of two that want one quad the one with the higher rank gets it.

    Returns: (p,) quads, -1 where all near ones were taken: there is always one for the highest rank.
    """
    face = np.flatnonzero(mesh.kind == HOSTING)
    face = face[np.isin(mesh.branch[face], host)]
    center = mesh.positions[mesh.quads[face]].mean(axis=1)
    near = _near_of_branch(center, mesh.branch[face], target, host)
    found = _share_out(near[:, :, None], len(face), rank)
    return np.where(found >= 0, face[np.maximum(found, 0)], -1)


def find_holes(mesh: ControlMesh, host: Ints, target: Floats, rank: Floats) -> Ints:
    """Four quads around a vertex of its host for each branch: the closest vertex to its target.

    The paper looks among the faces within 1.5 diameters of the joint for the one that the branch's axis
    meets, and takes its closest vertex; here the place where the axis leaves the wood is known, and the
    closest vertex is taken around which four free quads of the host lie.

    Args: as for `find_faces`.

    Returns: (p, 4) quads, counter-clockwise; -1 where none are free.
    """
    none = np.full((len(host), 4), -1)
    if not len(host):
        return none
    face = np.flatnonzero((mesh.kind == HOSTING) & np.isin(mesh.branch, host))
    quads, branch = mesh.quads[face], mesh.branch[face]
    valence = np.bincount(mesh.quads.ravel(), minlength=len(mesh.positions))
    corner = quads.ravel()
    order = np.argsort(corner, kind="stable")
    vertex, begin, number = np.unique(corner[order], return_index=True, return_counts=True)
    regular = (number == 4) & (valence[vertex] == 4)
    vertex, spot = vertex[regular], order[begin[regular][:, None] + np.arange(4)]
    own, at = spot // 4, spot % 4
    one_branch = (branch[own] == branch[own[:, :1]]).all(axis=1)
    vertex, own, at = vertex[one_branch], own[one_branch], at[one_branch]
    leaving, arriving = quads[own, (at + 1) % 4], quads[own, (at + 3) % 4]
    row = np.arange(len(own))
    turned = np.zeros((len(own), 4), np.int64)
    for step in range(1, 4):
        follows = leaving == arriving[row, turned[:, step - 1]][:, None]
        turned[:, step] = follows.argmax(axis=1)
    around = (np.sort(turned, axis=1) == np.arange(4)).all(axis=1)
    # Eight different vertices around: else the hole's edge would touch itself.
    ring = np.sort(np.concatenate([leaving, quads[own, (at + 2) % 4]], axis=1), axis=1)
    around &= (np.diff(ring, axis=1) > 0).all(axis=1)
    vertex, own = vertex[around], own[row[:, None], turned][around]
    if not len(vertex):
        return none
    near = _near_of_branch(mesh.positions[vertex], branch[own[:, 0]], target, host)
    claims = np.where(near[:, :, None] >= 0, own[np.maximum(near, 0)], -1)
    found = _share_out(claims, len(face), rank, near)
    return np.where(found[:, None] >= 0, face[own[np.maximum(found, 0)]], -1)


def _near_of_branch(points: Floats, branch: Ints, target: Floats, host: Ints) -> Ints:
    """(p, k) the points of its host that are nearest to each target, -1 beyond the last."""
    # Another host's points are far away in a fourth direction.
    span = 4.0 * float(np.max(np.abs(np.concatenate([points, target])), initial=1e-3)) + 1.0
    count = min(_LOOKED_AT, len(points))
    tree = cKDTree(np.column_stack([points, branch * span]))
    _, near = tree.query(np.column_stack([target, host * span]), k=np.arange(1, count + 1))
    return np.where(branch[near] == host[:, None], near, -1)


def _share_out(claims: Ints, size: int, rank: Floats, name: Ints | None = None) -> Ints:
    """Gives every branch (p,) the first of its wishes whose quads nobody with a higher rank takes.

    Args:
        claims: (p, k, q), the quads that each of its wishes takes; -1 is no wish.
        size: number of quads.
        rank: (p,).
        name: (p, k), what is returned for a wish; the quad itself by default.
    """
    count, wishes, _ = claims.shape
    found = np.full(count, -1)
    taken: NDArray[np.bool_] = np.zeros(size, np.bool_)
    place = np.empty(count, np.int64)
    place[np.lexsort((np.arange(count), -rank))] = np.arange(count)
    wish = np.zeros(count, np.int64)
    open_ = np.arange(count)
    while len(open_):
        wanted = claims[open_, wish[open_]]
        usable = (wanted >= 0).all(axis=1)
        usable &= ~taken[np.maximum(wanted, 0)].any(axis=1)
        best = np.full(size, count)
        np.minimum.at(best, wanted[usable].ravel(), np.repeat(place[open_[usable]], wanted.shape[1]))
        wins = usable & (best[np.maximum(wanted, 0)] == place[open_][:, None]).all(axis=1)
        won = open_[wins]
        found[won] = wanted[wins, 0] if name is None else name[won, wish[won]]
        taken[wanted[wins].ravel()] = True
        wish[open_[~usable]] += 1
        open_ = open_[~wins]
        open_ = open_[wish[open_] < wishes]
    return found
