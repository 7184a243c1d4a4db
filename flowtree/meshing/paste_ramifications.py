"""Cuts holes of four quads into hosts and joins branches to them (Manifold Ramifications, section 6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flowtree.meshing.branch_axes import Floats, Ints, unit
from flowtree.meshing.build_tubes import HOSTING, ControlMesh
from flowtree.meshing.open_faces import Openings, match_boundaries

_MERGED = 0.5  # how far the destination boundary gives way to the branch's own


def paste_subdivided(mesh: ControlMesh, hole: Ints, base: Ints) -> ControlMesh:
    """Joins branches that were subdivided alone, eight edges to eight (equations 10 and 11).

    Both surfaces lose the four quads around a vertex. Of the eight ways to match the boundaries the one with
    the least sum of cosine distances is taken (equation 10); then CP (equation 11) is minimised in closed
    form: the branch's boundary is turned by the mean angle that is left and moved onto the other's centre,
    and the merged boundary lies halfway between the two.

    Args:
        mesh: hosts and closed branches, subdivided.
        hole: (p, 4), the quads around the vertex that gives way, counter-clockwise.
        base: (p, 4), the same of the branch's base.
    """
    around, own = ring_of(mesh.quads, hole), ring_of(mesh.quads, base)[:, ::-1]
    here, there = mesh.positions[around], mesh.positions[own]
    shift = match_boundaries(there, here)
    row = np.arange(len(hole))[:, None]
    own = own[row, (np.arange(8) + shift[:, None]) % 8]
    there = _turned_onto(mesh.positions[own], here)
    positions = mesh.positions.copy()
    positions[around] = (1.0 - _MERGED) * here + _MERGED * there
    name = np.arange(len(positions))
    name[own] = around
    kept = np.ones(len(mesh.quads), np.bool_)
    kept[hole] = kept[base] = False
    return _some(replace(mesh, positions=positions, quads=name[mesh.quads]), kept)


def open_vertices(mesh: ControlMesh, hole: Ints, openings: Openings) -> ControlMesh:
    """Joins branches that are made now, four edges to the eight around a vertex, by six quads.

    Two opposite edges of the branch's start boundary reach three edges of the hole each, the others one: no
    fewer quads do it without another vertex. Of the sixteen ways to lay that out the one with the least sum
    of cosine distances is taken, as in equation 10.
    """
    around = ring_of(mesh.quads, hole)
    here = mesh.positions[around]
    center = here.mean(axis=1)
    ways = np.array([[(first + step) % 8 for step in range(8)] for first in range(8)])
    best = np.full(len(hole), -np.inf)
    chosen, shift = np.zeros((2, len(hole)), np.int64)
    ring = openings.start - openings.start.mean(axis=1, keepdims=True)
    outward = unit((here - center[:, None]).reshape(-1, 3)).reshape(here.shape)
    for number, way in enumerate(ways):
        for turn in (0, 1):
            like = unit(np.roll(ring, -turn, axis=1).reshape(-1, 3)).reshape(ring.shape)
            score = np.sum(outward[:, way[[0, 3, 4, 7]]] * like, axis=(1, 2))
            better = score > best
            best[better], chosen[better], shift[better] = score[better], number, turn
    row = np.arange(len(hole))[:, None]
    around = around[row, ways[chosen]]
    inner = openings.base[:, None] + (np.arange(4) + shift[:, None]) % 4

    positions = mesh.positions.copy()
    here = positions[around]
    normal = unit(
        np.sum(np.cross(here - center[:, None], np.roll(here, -1, axis=1) - center[:, None]), axis=1)
    )
    offset = openings.target - center
    offset -= np.sum(offset * normal, axis=1, keepdims=True) * normal
    flat = ring - np.sum(ring * normal[:, None], axis=2, keepdims=True) * normal[:, None]
    room = np.linalg.norm(here - center[:, None], axis=2).min(axis=1)
    size = np.linalg.norm(flat, axis=2).max(axis=1)
    scale = np.minimum(1.0, 0.8 * room / np.maximum(size, 1e-300))
    slack = np.maximum(0.85 * room - scale * size, 0.0) / np.maximum(np.linalg.norm(offset, axis=1), 1e-300)
    offset *= np.minimum(1.0, slack)[:, None]
    turned = np.take_along_axis(flat, ((np.arange(4) + shift[:, None]) % 4)[..., None], axis=1)
    middle = mesh.positions[_middle(mesh.quads, hole)]
    positions[inner] = (0.5 * (center + middle) + offset)[:, None] + scale[:, None, None] * turned

    uv, inner_uv = _texture(mesh, hole, ways[chosen], positions[around], positions[inner])
    pattern = (
        (0, 1, "b", "a"),
        (1, 2, 3, "b"),
        (3, 4, "c", "b"),
        (4, 5, "d", "c"),
        (5, 6, 7, "d"),
        (7, 0, "a", "d"),
    )
    quads, uvs = [], []
    for names in pattern:
        pick = [("abcd".index(k), True) if isinstance(k, str) else (k, False) for k in names]
        quads.append(np.stack([inner[:, k] if within else around[:, k] for k, within in pick], axis=1))
        uvs.append(np.stack([inner_uv[:, k] if within else uv[:, k] for k, within in pick], axis=1))
    return _replaced(replace(mesh, positions=positions), hole, np.stack(quads, axis=1), np.stack(uvs, axis=1))


def fill_face(mesh: ControlMesh, face: Ints, base: Ints) -> ControlMesh:
    """Joins branches that were subdivided alone to single quads, eight edges to four, by six quads.

    The fallback for branches that find no vertex with four free quads around it.
    """
    own = ring_of(mesh.quads, base)[:, ::-1]
    outer = mesh.quads[face]
    here, there = mesh.positions[outer], mesh.positions[own]
    # Corners of the face stand for every second place of an eight.
    double = np.stack([here, 0.5 * (here + np.roll(here, -1, axis=1))], axis=2).reshape(len(face), 8, 3)
    shift = match_boundaries(there, double)
    row = np.arange(len(face))[:, None]
    own = own[row, (np.arange(8) + shift[:, None]) % 8]
    positions = mesh.positions.copy()
    positions[own] = here.mean(axis=1)[:, None] + 0.6 * (double - here.mean(axis=1)[:, None])
    quads = [
        np.stack([outer[:, 0], outer[:, 1], own[:, 1], own[:, 0]], axis=1),
        np.stack([outer[:, 1], own[:, 3], own[:, 2], own[:, 1]], axis=1),
        np.stack([outer[:, 1], outer[:, 2], own[:, 4], own[:, 3]], axis=1),
        np.stack([outer[:, 2], outer[:, 3], own[:, 5], own[:, 4]], axis=1),
        np.stack([outer[:, 3], own[:, 7], own[:, 6], own[:, 5]], axis=1),
        np.stack([outer[:, 3], outer[:, 0], own[:, 0], own[:, 7]], axis=1),
    ]
    filled = _replaced(
        replace(mesh, positions=positions),
        face[:, None],
        np.stack(quads, axis=1),
        np.repeat(mesh.uvs[face][:, None], 6, axis=1),
    )
    kept = np.ones(len(filled.quads), np.bool_)
    kept[base] = False
    return _some(filled, kept)


def _replaced(mesh: ControlMesh, old: Ints, quads: Ints, uvs: Floats) -> ControlMesh:
    """The mesh with quads (p, j, 4) in the places of old ones (p, k), j > k, the rest behind the last."""
    size = old.shape[1]
    all_quads, all_uvs, kind = mesh.quads.copy(), mesh.uvs.copy(), mesh.kind.copy()
    all_quads[old], all_uvs[old], kind[old] = quads[:, :size], uvs[:, :size], HOSTING
    host = np.repeat(mesh.branch[old[:, 0]], quads.shape[1] - size)
    return replace(
        mesh,
        quads=np.concatenate([all_quads, quads[:, size:].reshape(-1, 4)]),
        uvs=np.concatenate([all_uvs, uvs[:, size:].reshape(-1, 4, 2)]),
        branch=np.concatenate([mesh.branch, host]),
        kind=np.concatenate([kind, np.full(len(host), HOSTING)]),
    )


def ring_of(quads: Ints, hole: Ints) -> Ints:
    """The eight vertices (p, 8) around four quads (p, 4) that share a vertex, counter-clockwise."""
    corner = quads[hole]
    shared = _middle(quads, hole)
    at = (corner == shared[:, None, None]).argmax(axis=2)
    row, face = np.ogrid[: len(hole), :4]
    first, second = corner[row, face, (at + 1) % 4], corner[row, face, (at + 2) % 4]
    return np.stack([first, second], axis=2).reshape(-1, 8)


def _middle(quads: Ints, hole: Ints) -> Ints:
    """The vertex (p,) that four quads (p, 4) share."""
    corner = quads[hole]
    shared = (corner[:, 0, :, None, None] == corner[:, None, 1:, :]).any(axis=3).all(axis=2)
    return np.asarray(corner[np.arange(len(hole)), 0, shared.argmax(axis=1)], np.int64)


def _turned_onto(ring: Floats, other: Floats) -> Floats:
    """A ring (p, m, 3) on the centre of another and turned, about that one's normal, as it is."""
    center = other.mean(axis=1, keepdims=True)
    rays = other - center
    normal = unit(np.sum(np.cross(rays, np.roll(rays, -1, axis=1)), axis=1))[:, None]
    own = ring - ring.mean(axis=1, keepdims=True)
    own -= np.sum(own * normal, axis=2, keepdims=True) * normal
    cosine = np.sum(own * rays, axis=(1, 2))
    sine = np.sum(np.cross(own, rays) * normal, axis=(1, 2))
    angle = np.arctan2(sine, cosine)[:, None, None]
    turned: Floats = center + np.cos(angle) * own + np.sin(angle) * np.cross(normal, own)
    return turned


def _texture(mesh: ControlMesh, hole: Ints, way: Ints, outer: Floats, inner: Floats) -> tuple[Floats, Floats]:
    """Texture coordinates around a hole (p, 8, 2), seams undone, and within it (p, 4, 2), affine."""
    corner, uvs = mesh.quads[hole], mesh.uvs[hole]
    at = (corner == _middle(mesh.quads, hole)[:, None, None]).argmax(axis=2)
    row, face = np.ogrid[: len(hole), :4]
    middle = uvs[row, face, at]
    seam = (middle - middle[:, :1])[:, :, None]
    around = np.stack([uvs[row, face, (at + 1) % 4], uvs[row, face, (at + 2) % 4]], axis=2) - seam
    uv = np.take_along_axis(around.reshape(-1, 8, 2), way[..., None], axis=1)
    center, mean = outer.mean(axis=1, keepdims=True), uv.mean(axis=1, keepdims=True)
    rays = outer - center
    gram = np.einsum("pki,pkj->pij", rays, rays)
    gram += 1e-6 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(3) + 1e-300 * np.eye(3)
    slope = np.linalg.solve(gram, np.einsum("pki,pkj->pij", rays, uv - mean))
    return uv, mean + np.einsum("pki,pij->pkj", inner - center, slope)


def _some(mesh: ControlMesh, kept: np.ndarray) -> ControlMesh:
    """The mesh without some of its quads."""
    return replace(
        mesh, quads=mesh.quads[kept], uvs=mesh.uvs[kept], branch=mesh.branch[kept], kind=mesh.kind[kept]
    )
