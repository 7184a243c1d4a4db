"""Meshes and the nodes that place them in a GLB."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.export.glb_builder import INDICES, VERTICES, GlbBuilder
from flowtree.export.glb_materials import GlbMaterials
from flowtree.export.glb_vertices import Frame, Packed, pack_vertices
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh

# 65535 itself restarts a strip in some graphics interfaces, so glTF forbids it as a 16-bit index.
_MOST_SHORT_VERTICES = 65535
_BYTE_JOINTS = 256


class GlbParts:
    """Adds a tree's pieces to a file, all of them exact or all of them quantised in one frame."""

    def __init__(self, builder: GlbBuilder, materials: GlbMaterials, frame: Frame | None) -> None:
        self._builder = builder
        self._materials = materials
        self._frame = frame
        if frame is not None:
            builder.use("KHR_mesh_quantization", required=True)

    def add_mesh(
        self,
        name: str,
        mesh: TreeMesh,
        material: Material,
        *,
        attributes: Mapping[str, NDArray[Any]] | None = None,
        skin: int | None = None,
    ) -> int:
        """A mesh as a node; returns the node's index.

        Args:
            name: of both.
            mesh: with a triangle.
            material: of all of it.
            attributes: more of its vertices (see `flowtree.model.wind.Wind`); a ``COLOR_0`` among them stands
                for the mesh's own colours.
            skin: whose joints move it.
        """
        node: dict[str, Any] = {
            "name": name,
            "mesh": self._mesh(name, mesh, material, attributes or {}, self._frame),
        }
        if skin is not None:
            node["skin"] = skin  # its joints place it
        elif self._frame is not None:
            node["translation"], node["scale"] = self._frame.centre.tolist(), [self._frame.step] * 3
        return self._builder.add("nodes", node)

    def add_instances(self, name: str, foliage: Foliage) -> int:
        """Leaves as one leaf and its places (EXT_mesh_gpu_instancing); returns the node's index.

        The extension is required: a reader without it would show a single leaf at the tree's foot.
        """
        builder = self._builder
        builder.use("EXT_mesh_gpu_instancing", required=True)
        turns = foliage.rotation.astype(np.float64)
        turns /= np.sqrt((turns**2).sum(axis=1, keepdims=True))
        places = {
            "TRANSLATION": builder.accessor(foliage.position.astype(np.float32)),
            "ROTATION": builder.accessor(turns.astype(np.float32)),
            "SCALE": builder.accessor(np.repeat(foliage.scale.astype(np.float32)[:, None], 3, axis=1)),
            # The name under which three.js and Babylon look for an instance's colour.
            "_COLOR_0": builder.accessor(foliage.color.astype(np.float32)),
        }
        instancing = {"EXT_mesh_gpu_instancing": {"attributes": places}}
        # The frame is the whole tree's, a leaf's own is 1 m long: it stays exact.
        index = self._mesh(name, foliage.leaf, foliage.material, {}, None)
        return builder.add("nodes", {"name": name, "mesh": index, "extensions": instancing})

    def add_body(self, name: str, positions: NDArray[np.float32], triangles: NDArray[np.int32]) -> int:
        """A solid body, which is not meant to be seen, as a node; returns the node's index."""
        primitive = {
            "attributes": {"POSITION": self._attribute("POSITION", Packed(positions.astype(np.float32)))},
            "indices": self._indices(triangles, len(positions)),
        }
        index = self._builder.add("meshes", {"name": name, "primitives": [primitive]})
        return self._builder.add("nodes", {"name": name, "mesh": index, "extras": {"collision": True}})

    def _mesh(
        self,
        name: str,
        mesh: TreeMesh,
        material: Material,
        attributes: Mapping[str, NDArray[Any]],
        frame: Frame | None,
    ) -> int:
        packed, factor = pack_vertices(mesh, tangents=material.normal is not None, frame=frame)
        if "COLOR_0" in attributes and mesh.colors is not None:
            factor = mesh.colors.mean(axis=0, dtype=np.float64)
        packed |= {key: _as_it_is(key, values) for key, values in _equally_wide(attributes).items()}
        if frame is not None and "WEIGHTS_0" in attributes:
            packed |= _coarse_skin(attributes["JOINTS_0"], attributes["WEIGHTS_0"])
        primitive: dict[str, Any] = {
            "attributes": {key: self._attribute(key, each) for key, each in packed.items()},
            "indices": self._indices(mesh.triangles, len(mesh.positions)),
            "material": self._materials.add(material, factor),
        }
        entry: dict[str, Any] = {"name": name, "primitives": [primitive]}
        if "COLOR_0" in attributes:  # whoever draws the tree must know that these are no colours
            entry["extras"] = {"COLOR_0": "wind"}
        return self._builder.add("meshes", entry)

    def _attribute(self, key: str, packed: Packed) -> int:
        bounds, normalized = key == "POSITION", packed.normalized
        return self._builder.accessor(packed.values, target=VERTICES, normalized=normalized, bounds=bounds)

    def _indices(self, triangles: NDArray[np.int32], count: int) -> int:
        short = count <= _MOST_SHORT_VERTICES
        flat = triangles.reshape(-1).astype(np.uint16 if short else np.uint32)
        return self._builder.accessor(flat, target=INDICES)


def _coarse_skin(joints: NDArray[Any], weights: NDArray[np.float32]) -> dict[str, Packed]:
    """Weights (n, 4) that sum to 1 as bytes that sum to 255, and joint 0 where none is left.

    What rounding leaves over goes to the largest.
    """
    counts = np.rint(weights * 255.0).astype(np.int64)
    rows = np.arange(len(counts))
    counts[rows, weights.argmax(axis=1)] += 255 - counts.sum(axis=1)
    return {
        "JOINTS_0": _as_it_is("JOINTS_0", np.where(counts > 0, joints, 0)),
        "WEIGHTS_0": Packed(counts.astype(np.uint8), normalized=True),
    }


def _equally_wide(attributes: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """The attributes, those with names of our own filled up with zeros to the widest of them.

    Blender 5.0 keeps such attributes in a set and mixes up their widths: it cannot read different ones.
    """
    own = [values.shape[1] for key, values in attributes.items() if key.startswith("_")]
    wide = dict(attributes)
    for key, values in attributes.items():
        missing = max(own, default=0) - values.shape[1]
        if key.startswith("_") and missing:
            wide[key] = np.concatenate([values, np.zeros((len(values), missing), values.dtype)], axis=1)
    return wide


def _as_it_is(key: str, values: NDArray[Any]) -> Packed:
    if key == "JOINTS_0":
        few = int(values.max()) < _BYTE_JOINTS
        return Packed(values.astype(np.uint8 if few else np.uint16))
    return Packed(values, normalized=np.issubdtype(values.dtype, np.integer))
