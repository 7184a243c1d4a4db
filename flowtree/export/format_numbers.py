"""Numbers as text that reads back to the same number."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray


def format_numbers(values: NDArray[Any]) -> list[Any]:
    """Every number as its shortest text that gives the same number back, in (nested) lists of that shape.

    Args:
        values: float32, whole numbers, or booleans (written as 0 and 1).
    """
    numbers = values.astype(np.int64) if values.dtype == np.bool_ else values
    texts: list[Any] = numbers.astype(np.str_).tolist()
    return texts
