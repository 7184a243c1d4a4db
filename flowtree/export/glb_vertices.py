"""A mesh's vertices as glTF stores them: exact, or in fewer bits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.model.mesh import TreeMesh

_SHORT, _BYTE = 32767, 127


@dataclass(frozen=True)
class Frame:
    """The cube in which quantised places are whole numbers; a node's translation and scale undo it.

    Attributes:
        centre: (3,) float64 [m].
        half: of its edge [m].
    """

    centre: NDArray[np.float64]
    half: float

    @property
    def step(self) -> float:
        """From one whole number to the next [m]."""
        return self.half / _SHORT


@dataclass(frozen=True)
class Packed:
    """One vertex attribute.

    Attributes:
        values: (n, k), of the stored type.
        normalized: whether whole numbers stand for 0..1 or -1..1.
    """

    values: NDArray[Any]
    normalized: bool = False


def frame_around(places: Sequence[NDArray[np.float32]]) -> Frame:
    """The smallest cube around all places, (n, 3) each, at least one of them."""
    low = np.min([each.min(axis=0) for each in places], axis=0).astype(np.float64)
    high = np.max([each.max(axis=0) for each in places], axis=0).astype(np.float64)
    # Half of an edge of 0 would leave nothing to divide by.
    return Frame((low + high) / 2.0, max(float((high - low).max()) / 2.0, 1e-6))


def pack_vertices(
    mesh: TreeMesh, *, tangents: bool, frame: Frame | None
) -> tuple[dict[str, Packed], NDArray[np.float64]]:
    """The attributes that glTF names, and the factor (3,) of the colours.

    Colours are bytes relative to the brightest of each channel, so that dark greens keep their steps:
    ``color = factor * byte / 255``. Texture coordinates that stay inside the picture are 16-bit fractions of
    it, finer than any texel.

    Args:
        mesh: n vertices, at least one.
        tangents: whether the material needs them.
        frame: with one, places become 16-bit numbers and directions 8-bit fractions (KHR_mesh_quantization).
    """
    normals = _unit(mesh.normals, np.array([0.0, 1.0, 0.0]))
    packed = {"POSITION": _places(mesh.positions, frame), "NORMAL": _directions(normals, frame)}
    if tangents and mesh.tangents is not None:
        packed["TANGENT"] = _directions(_tangents(mesh.tangents, normals), frame)
    packed["TEXCOORD_0"] = _fractions(mesh.uvs)
    factor = np.ones(3)
    if mesh.colors is not None:
        factor = mesh.colors.max(axis=0).astype(np.float64)
        scale = np.divide(255.0, factor, out=np.zeros(3), where=factor > 0)
        colors = np.full((len(mesh.colors), 4), 255, np.uint8)
        colors[:, :3] = np.rint(mesh.colors * scale)
        packed["COLOR_0"] = Packed(colors, normalized=True)
    return packed, factor


def _places(positions: NDArray[np.float32], frame: Frame | None) -> Packed:
    if frame is None:
        return Packed(positions.astype(np.float32, copy=False))
    inside = np.rint((positions - frame.centre) / frame.step)
    # Plain whole numbers, which the node's scale brings to metres: simple readers know no fractions.
    return Packed(np.clip(inside, -_SHORT, _SHORT).astype(np.int16))


def _directions(vectors: NDArray[np.float32], frame: Frame | None) -> Packed:
    if frame is None:
        return Packed(vectors)
    return Packed(np.rint(vectors * _BYTE).astype(np.int8), normalized=True)


def _fractions(uvs: NDArray[np.float32]) -> Packed:
    if uvs.min() < 0.0 or uvs.max() > 1.0:  # bark repeats
        return Packed(uvs.astype(np.float32, copy=False))
    return Packed(np.rint(uvs.astype(np.float64) * 65535.0).astype(np.uint16), normalized=True)


def _unit(vectors: NDArray[np.float32], instead: NDArray[np.float64]) -> NDArray[np.float32]:
    """The vectors at length 1 (glTF demands it); what has no direction gets another, (3,) or (n, 3)."""
    length = np.sqrt((vectors.astype(np.float64) ** 2).sum(axis=1, keepdims=True))
    unit = np.broadcast_to(instead, vectors.shape).copy()
    np.divide(vectors, length, out=unit, where=length > 1e-12)
    return unit.astype(np.float32)


def _tangents(tangents: NDArray[np.float32], normals: NDArray[np.float32]) -> NDArray[np.float32]:
    # Where a tangent has no direction, any at a right angle to the normal will do.
    least = np.eye(3)[np.abs(normals).argmin(axis=1)]
    across = np.cross(normals, least)
    across /= np.sqrt((across**2).sum(axis=1, keepdims=True))
    sign = np.where(tangents[:, 3:] < 0.0, np.float32(-1), np.float32(1))
    return np.concatenate([_unit(tangents[:, :3], across), sign], axis=1)
