"""Reads the JSON in which somebody drew or pointed at a photo."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from flowtree import check

_LARGEST_FILE = 64_000_000  # bytes


def read_drawn_json(file: Path, *, holds: str, form: str) -> Any:
    """The content of a JSON file, of any form.

    Args:
        file: which one.
        holds: what it should hold, for the error: "scribbles".
        form: an example of the right content, for the error.

    Raises:
        InputError: no such file, too large, no JSON.
    """
    check.require(file.is_file(), file.name, f"must be a file of {holds}", "no such file", "check the path")
    size = file.stat().st_size
    check.require(size <= _LARGEST_FILE, file.name, "must be under 64 MB", f"{size} bytes", "draw less")
    try:
        return json.loads(file.read_text(encoding="utf-8-sig"))
    except (ValueError, RecursionError) as error:
        check.fail(file.name, "must be JSON", f"something else ({error})", f"write {form}")


def is_number(value: Any) -> bool:
    """Whether a value of the JSON is a finite number that a float can hold."""
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    # Python's JSON holds whole numbers of any size, and NaN: neither passes this comparison.
    return number and abs(value) <= sys.float_info.max


def is_pair(value: Any) -> bool:
    """Whether a value of the JSON is a point [x, y]."""
    return isinstance(value, list) and len(value) == 2 and all(is_number(number) for number in value)
