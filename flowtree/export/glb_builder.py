"""A binary glTF 2.0 file while it grows: its lists, its one buffer, its extensions."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import __version__, check

# Numbers of the glTF 2.0 specification.
VERTICES, INDICES = 34962, 34963
_COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class GlbBuilder:
    """The document's lists and the binary buffer; entries are named by their index, as in the format."""

    def __init__(self) -> None:
        self._lists: dict[str, list[dict[str, Any]]] = {}
        self._used: set[str] = set()
        self._required: set[str] = set()
        self._chunks: list[bytes] = []
        self._length = 0

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """Appends to one of the document's lists ("nodes", "meshes", …); returns the entry's index."""
        entries = self._lists.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def share(self, kind: str, entry: dict[str, Any]) -> int:
        """Like `add`, but an equal entry that is there already stands for the new one."""
        entries = self._lists.setdefault(kind, [])
        return entries.index(entry) if entry in entries else self.add(kind, entry)

    def entry(self, kind: str, index: int) -> dict[str, Any]:
        """An entry, to be completed."""
        return self._lists[kind][index]

    def use(self, extension: str, *, required: bool = False) -> None:
        """Names an extension; a reader that does not know a required one refuses the file."""
        self._used.add(extension)
        if required:
            self._required.add(extension)

    def view(self, data: bytes, *, target: int | None = None, stride: int | None = None) -> int:
        """A buffer view of its own for the bytes, aligned to four."""
        entry: dict[str, Any] = {"buffer": 0, "byteOffset": self._length, "byteLength": len(data)}
        if stride is not None:
            entry["byteStride"] = stride
        if target is not None:
            entry["target"] = target
        padding = -len(data) % 4
        self._chunks += [data, bytes(padding)]
        self._length += len(data) + padding
        return self.add("bufferViews", entry)

    def accessor(
        self,
        values: NDArray[Any],
        *,
        target: int | None = None,
        normalized: bool = False,
        bounds: bool = False,
    ) -> int:
        """Values (count,) or (count, width) of a type that glTF knows, in a view of their own.

        Args:
            values: stored as they are.
            target: `VERTICES`, whose rows are then padded to four bytes, `INDICES`, or None.
            normalized: whether whole numbers stand for 0..1 or -1..1.
            bounds: whether least and most are written, too.
        """
        table = values.reshape(len(values), -1)
        rows, stride = table, None
        if target == VERTICES and (table.itemsize * table.shape[1]) % 4:
            stride = -(-table.itemsize * table.shape[1] // 4) * 4
            rows = np.zeros((len(table), stride // table.itemsize), table.dtype)
            rows[:, : table.shape[1]] = table
        little = rows.astype(rows.dtype.newbyteorder("<"), copy=False)
        entry: dict[str, Any] = {
            "bufferView": self.view(little.tobytes(), target=target, stride=stride),
            "componentType": _COMPONENTS[f"{table.dtype.kind}{table.itemsize}"],
            "count": len(table),
            "type": _KINDS[table.shape[1]],
        }
        if normalized:
            entry["normalized"] = True
        if bounds:  # of the stored numbers, as doubles: text and back they are the same float32
            entry |= {"min": table.min(axis=0).tolist(), "max": table.max(axis=0).tolist()}
        return self.add("accessors", entry)

    def finish(self) -> bytes:
        """The whole file; its first scene is the one to show.

        Raises:
            InputError: it is larger than the format allows.
        """
        document: dict[str, Any] = {"asset": {"version": "2.0", "generator": f"flowtree {__version__}"}}
        if self._used:
            document["extensionsUsed"] = sorted(self._used)
        if self._required:
            document["extensionsRequired"] = sorted(self._required)
        document |= {"scene": 0, **self._lists, "buffers": [{"byteLength": self._length}]}
        text = json.dumps(document, ensure_ascii=False, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        total = 12 + 8 + len(text) + 8 + self._length
        rule = "must fit into 4 GiB, the limit of GLB"
        check.require(total < 2**32, "tree", rule, f"{total} bytes", "use fewer leaves")
        return b"".join(
            [
                struct.pack("<4sII", b"glTF", 2, total),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", self._length, b"BIN\0"),
                *self._chunks,
            ]
        )
