"""What a skeleton file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from flowtree.export.number_branches import number_branches
from flowtree.export.read_skeleton import read_skeleton


def inspect_skeleton(path: Path) -> dict[str, Any]:
    """Reads a skeleton (`read_skeleton`) and measures it.

    Returns: ``{"kind", "bytes", "nodes", "tips", "branches", "orders", "total_length_m", "trunk_radius_m",
        "bounds": {"min", "max"} [m]}``.

    Raises:
        InputError: it cannot be read or is no skeleton.
    """
    skeleton = read_skeleton(path)
    parent, points = skeleton.parent, skeleton.points.astype(np.float64)
    children = np.bincount(parent[1:], minlength=len(parent))
    return {
        "kind": "skeleton",
        "bytes": path.stat().st_size,
        "nodes": len(parent),
        "tips": int((children == 0).sum()),
        "branches": int(number_branches(skeleton).branch.max()),
        "orders": int(skeleton.level.max()) + 1,
        "total_length_m": round(float(np.linalg.norm(points[1:] - points[parent[1:]], axis=1).sum()), 4),
        "trunk_radius_m": round(float(skeleton.radius[0]), 5),
        "bounds": {
            "min": np.round(points.min(axis=0), 6).tolist(),
            "max": np.round(points.max(axis=0), 6).tolist(),
        },
    }
