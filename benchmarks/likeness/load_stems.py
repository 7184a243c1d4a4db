"""The true stems of a known tree."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def load_stems(folder: Path) -> tuple[list[NDArray[np.float64]], bool]:
    """Polylines (n, 4) of x, y, z, radius [m], the trunk first, and whether the tree bears leaves."""
    known = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    lines = [np.array(stem, np.float64) for stem in known["stems"] if len(stem) > 1]
    return lines, bool(known["leafy"])
