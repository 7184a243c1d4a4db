"""The container and the accessors of a binary glTF file, read with distrust."""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.errors import FlowtreeError

_COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


@dataclass(frozen=True)
class GlbFile:
    """An opened GLB.

    Attributes:
        name: the file's, for errors.
        size: of the file [bytes].
        document: its JSON.
        binary: its one embedded buffer.
    """

    name: str
    size: int
    document: dict[str, Any]
    binary: bytes

    def entries(self, kind: str) -> list[dict[str, Any]]:
        """One of the document's lists ("nodes", "meshes", …); empty where it has none."""
        entries: list[dict[str, Any]] = self.document.get(kind, [])
        return entries

    def entry(self, kind: str, index: int) -> dict[str, Any]:
        """One entry of such a list.

        Raises:
            IndexError: there is none of that number.
        """
        return _at(self.entries(kind), index)

    def view(self, index: int) -> bytes:
        """The bytes of a buffer view."""
        view = _at(self.entries("bufferViews"), index)
        first, length = view.get("byteOffset", 0), view["byteLength"]
        inside = view["buffer"] == 0 and 0 <= first <= first + length <= len(self.binary)
        check.require(
            inside, self.name, "must hold all its data", f"buffer view {index} beyond it", "export it again"
        )
        return self.binary[first : first + length]

    def accessor(self, index: int) -> NDArray[Any]:
        """An accessor's values, (count,) or (count, width); normalised integers as float32 in 0..1 or -1..1.

        Raises:
            InputError: it is sparse, compressed or reaches beyond its data.
        """
        entry = _at(self.entries("accessors"), index)
        plain = "bufferView" in entry and "sparse" not in entry
        check.require(
            plain, self.name, "needs plain accessors", "a sparse or compressed one", "export it uncompressed"
        )
        kind, count = np.dtype(_COMPONENTS[entry["componentType"]]), entry["count"]
        width, first = _WIDTHS[entry["type"]], entry.get("byteOffset", 0)
        row = kind.itemsize * width
        data = self.view(entry["bufferView"])
        stride = _at(self.entries("bufferViews"), entry["bufferView"]).get("byteStride", row)
        inside = (
            count > 0 and first >= 0 and stride >= row and first + (count - 1) * stride + row <= len(data)
        )
        check.require(
            inside, self.name, "must hold all its data", f"accessor {index} beyond it", "export it again"
        )
        values: NDArray[Any] = np.ndarray((count, width), kind, data, first, (stride, kind.itemsize)).copy()
        if entry.get("normalized"):
            values = np.maximum(values / np.float32(np.iinfo(kind).max), np.float32(-1))
        return values[:, 0] if width == 1 else values

    def placed_nodes(self, scene: int | None = None) -> Iterator[tuple[dict[str, Any], NDArray[np.float64]]]:
        """Every node of a scene, the one to show unless another is given, and its matrix (4, 4) to the world.

        That of a skinned mesh is its joints' at rest.
        """
        nodes = self.entries("nodes")
        number = self.document.get("scene", 0) if scene is None else scene
        shown = _at(self.entries("scenes"), number) if self.entries("scenes") else {}
        waiting = [(index, np.eye(4)) for index in reversed(shown.get("nodes", []))]
        placed: dict[int, NDArray[np.float64]] = {}
        while waiting:
            index, above = waiting.pop()
            rule = "must be a tree of nodes"
            check.require(index not in placed, self.name, rule, "a circle", "export it again")
            node = _at(nodes, index)
            placed[index] = above @ _local_matrix(node)
            waiting += [(child, placed[index]) for child in reversed(node.get("children", []))]
        for index, matrix in placed.items():
            yield (
                nodes[index],
                self._at_rest(nodes[index]["skin"], placed) if "skin" in nodes[index] else matrix,
            )

    def _at_rest(self, index: int, placed: dict[int, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Where a skin's first joint, not yet turned, puts the mesh."""
        skin = _at(self.entries("skins"), index)
        joint = placed[skin["joints"][0]]
        if "inverseBindMatrices" not in skin:
            return joint
        undo = self.accessor(skin["inverseBindMatrices"])[0].reshape(4, 4).T
        matrix: NDArray[np.float64] = joint @ undo.astype(np.float64)
        return matrix


def parse_glb(path: Path) -> GlbFile:
    """Opens a GLB file (glTF 2.0, section 4.4).

    Raises:
        InputError: it cannot be read, is no GLB of version 2, or its chunks are damaged.
    """
    name = path.name
    try:
        data = path.read_bytes()
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        check.fail(name, "must be a readable file", reason, "choose another file")
    ours = len(data) >= 20 and data[:4] == b"glTF" and struct.unpack_from("<I", data, 4)[0] == 2
    check.require(ours, name, "must be binary glTF 2.0", "other bytes", "choose a .glb file")
    total = struct.unpack_from("<I", data, 8)[0]
    check.require(
        total == len(data), name, f"must be {total} bytes, as it says", len(data), "copy or export it again"
    )
    chunks, at = [], 12
    while at + 8 <= total:
        length, kind = struct.unpack_from("<I4s", data, at)
        whole = at + 8 + length <= total
        check.require(whole, name, "must hold its chunks whole", "a chunk beyond the end", "export it again")
        chunks.append((kind, data[at + 8 : at + 8 + length]))
        at += 8 + length
    check.require(
        bool(chunks) and chunks[0][0] == b"JSON",
        name,
        "must begin with JSON",
        "other data",
        "export it again",
    )
    with refuse_malformed(name):
        document = json.loads(chunks[0][1])
    check.require(
        isinstance(document, dict), name, "must hold a glTF document", "other JSON", "export it again"
    )
    return GlbFile(name, len(data), document, next((body for kind, body in chunks if kind == b"BIN\0"), b""))


@contextmanager
def refuse_malformed(name: str) -> Iterator[None]:
    """Turns what a document of the wrong form does to the code that walks it into the one-line input error.

    A hostile document can break any rule of the format at any place; checking each would bury the reading.
    Numbers beyond all bounds become infinite in silence here: whoever reads checks what comes out.
    """
    try:
        with np.errstate(all="ignore"):
            yield
    except FlowtreeError:
        raise
    except (LookupError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
        got = f"{type(error).__name__}: {str(error)[:80]}"
        check.fail(name, "must be a well-formed file", got, "export it again")


def _at(entries: list[dict[str, Any]], index: Any) -> dict[str, Any]:
    # Python would take -1 for the last and True for the second.
    if type(index) is not int or not 0 <= index < len(entries):
        raise IndexError(f"no entry {index!r}")
    return entries[index]


def _local_matrix(node: dict[str, Any]) -> NDArray[np.float64]:
    if "matrix" in node:
        matrix = np.array(node["matrix"], np.float64).reshape(4, 4).T
    else:
        x, y, z, w = (float(value) for value in node.get("rotation", (0, 0, 0, 1)))
        turn = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        matrix = np.eye(4)
        matrix[:3, :3] = np.array(turn) * np.array(node.get("scale", (1, 1, 1)), np.float64)
        matrix[:3, 3] = node.get("translation", (0, 0, 0))
    if not all(math.isfinite(value) for value in matrix.flat):
        raise ValueError("a node's transformation is not finite")
    return matrix
