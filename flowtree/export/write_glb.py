"""A tree as one binary glTF 2.0 file."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import __version__, check
from flowtree.device import side_by_side
from flowtree.export.check_tree import check_tree
from flowtree.export.encode_texture import encode_texture
from flowtree.export.merge_leaves import merge_leaves
from flowtree.files import write_whole
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel

# Numbers of the glTF 2.0 specification.
_UNSIGNED_BYTE, _UNSIGNED_SHORT, _UNSIGNED_INT, _FLOAT = 5121, 5123, 5125, 5126
_VERTICES, _INDICES = 34962, 34963
_LINEAR, _LINEAR_MIPMAP_LINEAR, _CLAMP, _REPEAT = 9729, 9987, 33071, 10497
# 65535 itself restarts a strip in some graphics interfaces, so glTF forbids it as a 16-bit index.
_MOST_SHORT_VERTICES = 65535


def write_glb(tree: TreeModel, path: Path) -> None:
    """Writes a tree as binary glTF: metres, y up, the foot at the origin (glTF 2.0, section 3.4).

    See `encode_glb` for what is inside.

    Raises:
        InputError: the tree is broken (see `check_tree`) or larger than the format allows.
        OutputError: the file could not be written; what stood there is untouched.
    """
    write_whole(path, encode_glb(tree))


def encode_glb(tree: TreeModel) -> bytes:
    """The bytes of the GLB file; the same tree always gives the same ones.

    Nodes: ``<name>`` with the children ``<name>_wood`` and, unless the tree is bare, ``<name>_leaves``, each
    with a mesh. All leaves are one mesh (Blender makes an object of every instance). Colours are stored as
    bytes, relative to the brightest of each channel, which becomes the material's factor: dark greens keep
    their steps. Opaque pictures are JPEG, those with alpha and normal maps PNG.

    Raises:
        InputError: the tree is broken (see `check_tree`) or larger than the format allows.
    """
    check_tree(tree)
    name = tree.name.encode("utf-8", "replace").decode() or "Tree"
    foliage = tree.foliage if tree.foliage is not None and len(tree.foliage.position) else None
    extras = {"height": float(tree.height), "leaves": 0 if foliage is None else len(foliage.position)}
    leafy = foliage is not None and len(foliage.leaf.triangles) > 0
    materials = [tree.bark] if len(tree.wood.triangles) else []
    if foliage is not None and leafy:
        materials.append(foliage.material)
    children: list[int] = []
    file = _Glb({"name": name, "children": children, "extras": extras}, materials)
    if len(tree.wood.triangles):
        children.append(file.add_part(f"{name}_wood", tree.wood, tree.bark))
    if foliage is not None and leafy:
        children.append(file.add_part(f"{name}_leaves", merge_leaves(foliage), foliage.material))
    return file.finish()


class _Glb:
    """A glTF document and its binary buffer while they grow; the root node is the first.

    The pictures of all materials, in the order in which they are added, are packed at the beginning, side by
    side: that takes half of the time.
    """

    def __init__(self, root: dict[str, Any], materials: Sequence[Material]) -> None:
        self._pictures = iter(side_by_side(_pack, [each for some in materials for each in _pictures(some)]))
        self._lists: dict[str, list[dict[str, Any]]] = {"nodes": [root]}
        self._chunks: list[bytes] = []
        self._length = 0

    def add_part(self, name: str, mesh: TreeMesh, material: Material) -> int:
        """A mesh with its material as a node; returns the node's index."""
        attributes = {
            "POSITION": self._accessor(mesh.positions.astype("<f4"), _FLOAT, "VEC3", bounds=True),
            "NORMAL": self._accessor(_unit(mesh.normals), _FLOAT, "VEC3"),
            "TEXCOORD_0": self._accessor(mesh.uvs.astype("<f4"), _FLOAT, "VEC2"),
        }
        factor = np.ones(3)
        if mesh.colors is not None:
            colors, factor = _quantise(mesh.colors)
            # Four channels: a vertex attribute starts at a multiple of four bytes.
            attributes["COLOR_0"] = self._accessor(colors, _UNSIGNED_BYTE, "VEC4", normalized=True)
        primitive = {
            "attributes": attributes,
            "indices": self._indices(mesh),
            "material": self._material(material, factor),
        }
        index = self._add("meshes", {"name": name, "primitives": [primitive]})
        return self._add("nodes", {"name": name, "mesh": index})

    def finish(self) -> bytes:
        """The whole file."""
        document = {
            "asset": {"version": "2.0", "generator": f"flowtree {__version__}"},
            "scene": 0,
            "scenes": [{"name": self._lists["nodes"][0]["name"], "nodes": [0]}],
            **self._lists,
            "buffers": [{"byteLength": self._length}],
        }
        text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + 8 + self._length
        check.require(
            total < 2**32,
            "tree",
            "must fit into 4 GiB, the limit of GLB",
            f"{total} bytes",
            "use fewer leaves",
        )
        return b"".join(
            [
                struct.pack("<4sII", b"glTF", 2, total),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", self._length, b"BIN\0"),
                *self._chunks,
            ]
        )

    def _add(self, kind: str, entry: dict[str, Any]) -> int:
        entries = self._lists.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def _view(self, data: bytes, target: int | None = None) -> int:
        """A buffer view of its own for the bytes, aligned to four."""
        entry: dict[str, Any] = {"buffer": 0, "byteOffset": self._length, "byteLength": len(data)}
        if target is not None:
            entry["target"] = target
        padding = -len(data) % 4
        self._chunks += [data, bytes(padding)]
        self._length += len(data) + padding
        return self._add("bufferViews", entry)

    def _accessor(
        self,
        values: NDArray[Any],
        component: int,
        kind: str,
        *,
        bounds: bool = False,
        normalized: bool = False,
        target: int = _VERTICES,
    ) -> int:
        entry: dict[str, Any] = {
            "bufferView": self._view(values.tobytes(), target),
            "componentType": component,
            "count": len(values),
            "type": kind,
        }
        if normalized:
            entry["normalized"] = True
        if bounds:  # of the stored numbers, as doubles: text and back they are the same float32
            entry |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self._add("accessors", entry)

    def _indices(self, mesh: TreeMesh) -> int:
        flat = mesh.triangles.reshape(-1)
        if len(mesh.positions) <= _MOST_SHORT_VERTICES:
            return self._accessor(flat.astype("<u2"), _UNSIGNED_SHORT, "SCALAR", target=_INDICES)
        return self._accessor(flat.astype("<u4"), _UNSIGNED_INT, "SCALAR", target=_INDICES)

    def _material(self, material: Material, factor: NDArray[np.float64]) -> int:
        masked = material.alpha_cutoff is not None
        # A cut-out picture is used once, edge to edge: repeating it would let the far edge shine through.
        wrap = _CLAMP if masked else _REPEAT
        surface = {
            "baseColorTexture": {"index": self._texture(material.name, wrap)},
            "baseColorFactor": [*factor.tolist(), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": float(material.roughness),
        }
        entry: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": surface}
        if material.normal is not None:
            index = self._texture(f"{material.name}_normal", wrap)
            entry["normalTexture"] = {"index": index}
        if masked:
            entry |= {"alphaMode": "MASK", "alphaCutoff": material.alpha_cutoff}
        if material.double_sided:
            entry["doubleSided"] = True
        return self._add("materials", entry)

    def _texture(self, name: str, wrap: int) -> int:
        data, media = next(self._pictures)
        image = self._add("images", {"name": name, "mimeType": media, "bufferView": self._view(data)})
        sampler = {"magFilter": _LINEAR, "minFilter": _LINEAR_MIPMAP_LINEAR, "wrapS": wrap, "wrapT": wrap}
        samplers = self._lists.setdefault("samplers", [])
        if sampler not in samplers:
            samplers.append(sampler)
        return self._add("textures", {"sampler": samplers.index(sampler), "source": image})


def _pictures(material: Material) -> list[tuple[NDArray[np.uint8], bool]]:
    """A material's pictures, and of each whether it may lose detail: the colours, then the normals."""
    masked = material.alpha_cutoff is not None
    colors = (material.base_color if masked else material.base_color[:, :, :3], not masked)
    return [colors] if material.normal is None else [colors, (material.normal, False)]


def _pack(picture: tuple[NDArray[np.uint8], bool]) -> tuple[bytes, str]:
    pixels, lossy = picture
    return encode_texture(pixels, lossy=lossy)


def _unit(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """The normals at length 1 (glTF demands it); one without a direction points up."""
    length = np.linalg.norm(normals.astype(np.float64), axis=1, keepdims=True)
    up = np.broadcast_to(np.array([0.0, 1.0, 0.0]), normals.shape).copy()
    np.divide(normals, length, out=up, where=length > 1e-12)
    return up.astype("<f4")


def _quantise(colors: NDArray[np.float32]) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
    """Colours (n, 3) as bytes (n, 4), and the factor (3,) in ``color = factor * byte / 255``."""
    factor = colors.max(axis=0).astype(np.float64)
    scale = np.divide(255.0, factor, out=np.zeros(3), where=factor > 0)
    quantised = np.full((len(colors), 4), 255, np.uint8)
    quantised[:, :3] = np.rint(colors * scale)
    return quantised, factor
