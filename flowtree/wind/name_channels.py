"""Which vertex attribute carries what of the wind, for each engine."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.model.wind import VertexWind

#: Layouts that `name_channels` knows.
LAYOUTS = ("attributes", "colors", "godot", "unity", "unreal")
Channels = dict[str, NDArray[Any]]


def name_channels(wind: VertexWind, layout: str) -> Channels:
    """Names the vertices' values as a glTF file carries them to an engine.

    ``attributes``, for three.js, Blender and own shaders (custom attributes keep the material untouched):
        ``_WIND_LIMB`` float3 [m]: pivot of the limb. ``_WIND_BRANCH`` float3 [m]: pivot of the finer branch.
        ``_WIND_EXTENT`` 4 x 16 bits: extent of stem, limb, finer branch, flutter.
        ``_WIND_PHASE`` 4 x 8 bits: phase of limb, finer branch, leaf; depth / 2.
    ``colors``, for shaders that read only a vertex colour; in the order of Unity's tree shaders:
        ``COLOR_0`` 4 x 8 bits: phase of limb, flutter, extent of the stem, larger extent of limb and branch.
        It takes the place of the leaves' own tints.
    ``godot``, ``unity`` and ``unreal`` keep the tints and use texture coordinates, which all three import:
        ``TEXCOORD_1``: phase of the leaf, depth. ``TEXCOORD_2``, ``_3``: pivot of the limb, and its phase.
        ``TEXCOORD_4``, ``_5``: pivot of the finer branch, and its phase. ``TEXCOORD_6``, ``_7``: extent of
        stem, limb, finer branch, and flutter.
        In Godot they arrive as UV2, CUSTOM0, CUSTOM1 and CUSTOM2 (xyzw). In Unity as UV1 to UV7: pivots are
        in its left-handed frame (-x, y, z), and second coordinates are stored as 1 - v, because its importers
        turn them round. In Unreal as UV channels 1 to 7 (full-precision UVs on): pivots as (x, z, y) in
        centimetres.

    Args:
        wind: of v vertices.
        layout: one of `LAYOUTS`.

    Returns: attributes by name, each (v, columns), as `Wind` describes them.

    Raises:
        InputError: an unknown layout.
    """
    check.require(
        layout in LAYOUTS,
        "wind layout",
        f"must be one of {', '.join(LAYOUTS)}",
        repr(layout),
        check.nearest_name(layout, LAYOUTS),
    )
    if layout == "attributes":
        return _attributes(wind)
    if layout == "colors":
        return _colors(wind)
    return _coordinates(wind, layout)


def _attributes(wind: VertexWind) -> Channels:
    depth = wind.depth[:, None] / 2.0
    return {
        "_WIND_LIMB": np.ascontiguousarray(wind.pivot[:, 0]),
        "_WIND_BRANCH": np.ascontiguousarray(wind.pivot[:, 1]),
        "_WIND_EXTENT": np.rint(wind.extent * 65535.0).astype(np.uint16),
        "_WIND_PHASE": _bytes(np.concatenate([wind.phase, depth], axis=1)),
    }


def _colors(wind: VertexWind) -> Channels:
    stem, limb, fine, flutter = wind.extent.T
    return {"COLOR_0": _bytes(np.stack([wind.phase[:, 0], flutter, stem, np.maximum(limb, fine)], axis=1))}


def _coordinates(wind: VertexWind, layout: str) -> Channels:
    limb, fine = (_to_frame(wind.pivot[:, tier], layout) for tier in (0, 1))
    columns = np.concatenate(
        [
            wind.phase[:, 2:],
            wind.depth[:, None],
            limb,
            wind.phase[:, :1],
            fine,
            wind.phase[:, 1:2],
            wind.extent,
        ],
        axis=1,
    ).astype(np.float32)
    if layout == "unity":
        columns[:, 1::2] = 1.0 - columns[:, 1::2]
    return {
        f"TEXCOORD_{number}": np.ascontiguousarray(pair)
        for number, pair in enumerate(np.split(columns, 7, axis=1), start=1)
    }


def _to_frame(points: NDArray[np.float32], layout: str) -> NDArray[np.float32]:
    """Points (v, 3) of our world [m] as the engine's importer turns positions."""
    if layout == "unity":
        return points * np.array([-1.0, 1.0, 1.0], np.float32)
    if layout == "unreal":
        return points[:, [0, 2, 1]] * np.float32(100.0)
    return points


def _bytes(values: NDArray[Any]) -> NDArray[np.uint8]:
    return np.rint(values * 255.0).astype(np.uint8)
