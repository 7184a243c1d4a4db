"""Colours as people write them."""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from flowtree import check


def read_color(text: str, thing: str) -> NDArray[np.float64]:
    """The sRGB values (3,) 0..255 of #rrggbb.

    Args:
        text: what was written.
        thing: its name in the error.

    Raises:
        InputError: anything else.
    """
    written = re.fullmatch(r"#[0-9a-fA-F]{6}", text) is not None
    check.require(written, thing, "must be auto or #rrggbb", repr(text)[:40], "write it like #5f7f38")
    return np.frombuffer(bytes.fromhex(text[1:]), np.uint8).astype(np.float64)
