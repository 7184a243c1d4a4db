"""Where the instances of a node stand."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.export.parse_glb import GlbFile
from flowtree.geometry.rotation_matrices import rotation_matrices

_WIDTHS = {"ROTATION": 4, "SCALE": 3, "TRANSLATION": 3}


def instance_places(file: GlbFile, node: dict[str, Any]) -> NDArray[np.float64]:
    """A node's instances (EXT_mesh_gpu_instancing) as matrices (n, 4, 4); one, the unit, where it has none.

    Raises:
        ValueError: attributes that do not fit together, or a place that is not finite.
    """
    attributes = node.get("extensions", {}).get("EXT_mesh_gpu_instancing", {}).get("attributes", {})
    values = {key: file.accessor(attributes[key]) for key in _WIDTHS if key in attributes}
    count = len(next(iter(values.values()))) if values else 1
    matrices = np.tile(np.eye(4), (count, 1, 1))
    for key, each in values.items():
        if each.shape != (count, _WIDTHS[key]) or not np.isfinite(each).all():
            raise ValueError(f"instances with a broken {key}")
    if "ROTATION" in values:
        matrices[:, :3, :3] = rotation_matrices(values["ROTATION"].astype(np.float64))
    if "SCALE" in values:
        matrices[:, :3, :3] *= values["SCALE"][:, None, :]
    if "TRANSLATION" in values:
        matrices[:, :3, 3] = values["TRANSLATION"]
    return matrices
