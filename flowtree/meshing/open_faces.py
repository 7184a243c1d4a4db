"""Joins branches to single quads of their hosts: main face and start boundary (Manifold Ramifications, 4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flowtree.meshing.branch_axes import Floats, Ints, unit
from flowtree.meshing.build_tubes import HOSTING, ControlMesh

_EDGE = 0.4  # what is opened stays this close to a face's middle, in face widths
_WIDEST = 0.4  # half of a face at most that a start boundary takes up, in face widths
_LOOSE = 0.2  # a boundary smaller than this gets another one around it
_AROUND = 2.2  # how much larger that is
_FILLET = 1.35  # the same where it lies below the lifted boundary


@dataclass(frozen=True)
class Openings:
    """Branches (p,) that wait to be joined.

    Attributes:
        base: (p,) the vertex of the base ring's first corner; the others follow.
        start: (p, 4, 3) [m], the base ring's corners where the branch alone would have them.
        target: (p, 3) [m], where on the host's surface the branch should begin.
        along: (p, 3), unit, the host's direction.
        half: (p, 2) [m], half the size of the start boundary, across the host and along it.
        lift: (p, 3) [m], from the face to the start boundary; not 0 where a fillet is to lie between.
        rise: (p,) [m], how much further the boundary reaches on the side to which the branch leans.
    """

    base: Ints
    start: Floats
    target: Floats
    along: Floats
    half: Floats
    lift: Floats
    rise: Floats


def open_faces(mesh: ControlMesh, face: Ints, openings: Openings) -> ControlMesh:
    """Replaces faces by a frame of four quads around each branch's start boundary.

    The boundary (the paper's subface abcd) lies in the main face ABCD, as near to the branch as the face
    allows. It reaches further where the branch leans to the host: the sharp corner there becomes a web, as
    between real limbs. A second boundary lies around it where it is lifted from the face, and where it is
    much smaller than the face: otherwise subdivision would draw it out toward the face's far corners.

    Args:
        mesh: with the branches' tubes.
        face: (p,), all different.
        openings: the branches to join.

    Returns: the mesh; frames are part of the host and may host again.
    """
    quads = mesh.quads[face]
    shift = match_boundaries(mesh.positions[quads], openings.start)
    turn = (np.arange(4) + shift[:, None]) % 4
    row = np.arange(len(face))[:, None]
    outer, uv = quads[row, turn], mesh.uvs[face][row, turn]
    corner = mesh.positions[outer]
    place, half = _in_face(corner, openings)

    inner = openings.base[:, None] + np.arange(4)
    raised = np.any(openings.lift != 0.0, axis=1)
    loose = np.flatnonzero(raised | (half < _LOOSE).any(axis=1))
    positions, node = mesh.positions.copy(), mesh.node
    wide = np.ones(half.shape)
    wide[loose] = np.where(half[loose] < _LOOSE, _AROUND, _FILLET)
    wider = np.minimum(wide * half, np.maximum(half, 0.5 * (half + 0.46)))
    place = np.clip(place, wider - _EDGE, _EDGE - wider)
    flat, inner_uv = _inset(corner, uv, place, half)
    positions[inner] = flat + openings.lift[:, None]
    ring, ring_uv = _inset(corner[loose], uv[loose], place[loose], wider[loose])
    added = len(positions) + np.arange(4 * len(loose)).reshape(-1, 4)
    positions = np.concatenate([positions, ring.reshape(-1, 3)])
    node = np.concatenate([node, node[outer[loose]].ravel()])

    second, second_uv = inner.copy(), inner_uv.copy()
    second[loose], second_uv[loose] = added, ring_uv
    frames, frame_uvs = _frame(outer, second), _frame(uv, second_uv)
    extra, extra_uvs = _frame(added, inner[loose]), _frame(ring_uv, inner_uv[loose])
    host = mesh.branch[face]
    branch = np.concatenate([mesh.branch, np.repeat(host, 3), np.repeat(host[loose], 4)])
    all_quads, all_uvs, kind = mesh.quads.copy(), mesh.uvs.copy(), mesh.kind.copy()
    all_quads[face], all_uvs[face], kind[face] = frames[:, 0], frame_uvs[:, 0], HOSTING
    return replace(
        mesh,
        positions=positions,
        node=node,
        quads=np.concatenate([all_quads, frames[:, 1:].reshape(-1, 4), extra.reshape(-1, 4)]),
        uvs=np.concatenate([all_uvs, frame_uvs[:, 1:].reshape(-1, 4, 2), extra_uvs.reshape(-1, 4, 2)]),
        branch=branch,
        kind=np.concatenate([kind, np.full(len(branch) - len(kind), HOSTING)]),
    )


def _in_face(corner: Floats, openings: Openings) -> tuple[Floats, Floats]:
    """The middles (p, 2) of the boundaries and half their sizes (p, 2), in the faces' own widths."""
    middle = corner.mean(axis=1)
    axes = np.stack([corner[:, 1] + corner[:, 2], corner[:, 2] + corner[:, 3]], 1) - 2.0 * middle[:, None]
    length = np.maximum(np.linalg.norm(axes, axis=2), 1e-300)
    # Which of the face's two axes runs along the host decides where the longer side lies.
    slope = np.einsum("pid,pd->pi", axes, openings.along) / length
    swapped = np.abs(slope[:, 0]) > np.abs(slope[:, 1])
    half = np.where(swapped[:, None], openings.half[:, ::-1], openings.half)
    longer = np.where(swapped[:, None], [0.5, 0.0], [0.0, 0.5]) * openings.rise[:, None] * np.sign(slope)
    target = openings.target - middle + np.einsum("pi,pid->pd", longer / length, axes)
    half = np.clip((half + np.abs(longer)) / length, 0.002, _WIDEST)
    # The target in the face's plane, by least squares.
    gram = np.einsum("pid,pjd->pij", axes, axes)
    gram += 1e-9 * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(2) + 1e-300 * np.eye(2)
    side = np.einsum("pid,pd->pi", axes, target)
    return np.linalg.solve(gram, side[..., None])[..., 0], half


def match_boundaries(end: Floats, start: Floats) -> Ints:
    """Which corner of an end boundary goes with the first of a start boundary (equations 6 and 10).

    Args:
        end: (p, m, 3) [m].
        start: (p, m, 3) [m], in the same sense of rotation.

    Returns: (p,) the shift with the least sum of cosine distances, corners seen from the boundaries' centres.
    """
    size = end.shape[1]
    first, second = (
        unit((ring - ring.mean(axis=1, keepdims=True)).reshape(-1, 3)).reshape(ring.shape)
        for ring in (end, start)
    )
    turn = (np.arange(size)[:, None] + np.arange(size)) % size
    likeness = np.einsum("psmd,pmd->ps", first[:, turn], second)
    return np.asarray(likeness.argmax(axis=1), np.int64)


def _inset(corner: Floats, uv: Floats, center: Floats, half: Floats) -> tuple[Floats, Floats]:
    """A smaller quad in each face, (p, 4, 3) and (p, 4, 2): bilinear in the face's coordinates."""
    sign = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    at = 0.5 + center[:, None] + sign * half[:, None]
    x, y = at[..., 0], at[..., 1]
    weight = np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y], axis=2)
    return np.einsum("pik,pkd->pid", weight, corner), np.einsum("pik,pkd->pid", weight, uv)


def _frame(outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """The four quads (p, 4, 4, ...) between an outer and an inner quad (p, 4, ...)."""
    after, inner_after = np.roll(outer, -1, axis=1), np.roll(inner, -1, axis=1)
    return np.stack([outer, after, inner_after, inner], axis=2)
