"""Triangles and what covers them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Material:
    """A metallic-roughness material with metallic 0.

    Attributes:
        name: as it stands in the file.
        base_color: (h, w, 3) or (h, w, 4) uint8 sRGB texture, row 0 on top; four channels are alpha-tested.
        normal: (h, w, 3) uint8 tangent-space normal map (glTF convention: +y is up), or None; an octahedral
            card's has depths in a fourth channel.
        roughness: 0..1.
        double_sided: whether both sides are seen.
        alpha_cutoff: below this alpha the surface is not there; None is opaque.
        translucency: 0..1, how much of the light that a thin leaf does not mirror shines through it.
        repeats: whether the texture goes on beyond its edges even where alpha is tested; an opaque one does.
        mipmaps: whether smaller copies of the colours may stand for them; not where the share of pixels that
            pass the alpha test says how much is there: averaged, all or none of them would.
    """

    name: str
    base_color: NDArray[np.uint8]
    normal: NDArray[np.uint8] | None = None
    roughness: float = 0.9
    double_sided: bool = False
    alpha_cutoff: float | None = None
    translucency: float = 0.0
    repeats: bool = False
    mipmaps: bool = True


@dataclass(frozen=True)
class TreeMesh:
    """Triangles with texture coordinates, world frame.

    Attributes:
        positions: (n, 3) float32 [m].
        normals: (n, 3) float32, unit.
        uvs: (n, 2) float32; (0, 0) is the picture's upper left corner, v grows downwards, as in glTF.
        triangles: (m, 3) int32, counter-clockwise seen from outside.
        colors: (n, 3) float32 in 0..1, linear, multiplied with the texture; None is white.
        tangents: (n, 4) float32, unit toward growing u, and +-1, the sign of the bitangent (glTF); None where
            no normal map is laid on.
        node: (n,) int32, the skeleton node whose segment carries the vertex: what moves it in the wind; None
            where no skeleton does.
    """

    positions: NDArray[np.float32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    triangles: NDArray[np.int32]
    colors: NDArray[np.float32] | None = None
    tangents: NDArray[np.float32] | None = None
    node: NDArray[np.int32] | None = None


@dataclass(frozen=True)
class QuadMesh:
    """A closed surface of quads, world frame; vertices are shared, so texture coordinates are the corners'.

    Attributes:
        positions: (n, 3) float32 [m].
        quads: (m, 4) int32, counter-clockwise seen from outside.
        node: (n,) int32, the skeleton node whose segment carries the vertex.
        uvs: (m, 4, 2) float32, of each quad's corners, as in `TreeMesh`.
    """

    positions: NDArray[np.float32]
    quads: NDArray[np.int32]
    node: NDArray[np.int32]
    uvs: NDArray[np.float32]
