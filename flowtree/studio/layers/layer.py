"""One thing that the page shows."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

JSON, BINARY, GLB = "application/json", "application/octet-stream", "model/gltf-binary"
PNG, JPEG = "image/png", "image/jpeg"


@dataclass(frozen=True)
class Layer:
    """A layer as it travels.

    Attributes:
        name: ``matte/0``.
        media_type: of the data.
        data: the file.
        box: (left, top, right, bottom) of what changed since the layer of that name before [its pixels]; None
            where that is not known, or all.
        part: a file of that box alone.
    """

    name: str
    media_type: str
    data: bytes
    box: tuple[int, int, int, int] | None = None
    part: bytes | None = None


def json_layer(name: str, value: Any) -> Layer:
    """A layer of JSON."""
    return Layer(name, JSON, json.dumps(value, separators=(",", ":"), allow_nan=False).encode())
