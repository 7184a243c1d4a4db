"""A fingerprint of what goes into the pipeline."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel

from flowtree import check


def digest(*values: Any) -> str:
    """A fingerprint of the values: equal content, equal fingerprint, in every process.

    Arrays count with type and shape, a `Path` with its file's name and content, dataclasses and mappings with
    their fields; everything is written with its kind and length, so that no two values run together.

    Raises:
        InputError: a path whose file cannot be read.
    """
    state = hashlib.sha256()
    for part in _parts(values):
        state.update(part)
    return state.hexdigest()


def _parts(value: Any) -> Iterator[bytes | memoryview]:
    if isinstance(value, np.ndarray):
        yield f"array {value.dtype.str} {value.shape};".encode()
        yield np.ascontiguousarray(value).reshape(-1).view(np.uint8).data
    elif isinstance(value, Path):
        yield from _parts(("file", value.name, _content(value)))
    elif isinstance(value, bytes):
        yield f"bytes {len(value)};".encode()
        yield value
    elif isinstance(value, BaseModel):
        yield from _parts((type(value).__name__, value.model_dump_json()))
    elif is_dataclass(value):
        yield from _parts((type(value).__name__, {f.name: getattr(value, f.name) for f in fields(value)}))
    elif isinstance(value, Mapping):
        yield from _parts(("mapping", *value.items()))
    elif isinstance(value, tuple | list):
        yield f"sequence {len(value)};".encode()
        for item in value:
            yield from _parts(item)
    else:
        text = repr(value).encode()
        yield f"{type(value).__name__} {len(text)};".encode()
        yield text


def _content(path: Path) -> bytes:
    """The file's own fingerprint, read piece by piece."""
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").digest()
    except OSError as error:
        check.fail(str(path), "must be a file that can be read", error.strerror, "check the path")
