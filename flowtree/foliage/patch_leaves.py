"""A painted edit changes the leaves where it was painted, and no others (Particle Flows, section 9)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.find_painted import find_painted
from flowtree.geometry.rotation_matrices import rotation_matrices
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.foliage import Foliage


def patch_leaves(
    plain: Foliage | None,
    painted: Foliage | None,
    cameras: Sequence[Camera],
    edits: Sequence[PaintedEdit],
    *,
    of_plain: NDArray[np.int64],
    of_painted: NDArray[np.int64],
) -> Foliage | None:
    """Takes the leaves in the paint from the painted tree, and all others from the one without.

    Args:
        plain: leaves of the tree made without the paint.
        painted: the same made with it.
        cameras: of the views.
        edits: one a view.
        of_plain: (n,) for each node of the joint skeleton its number in the plain one, -1 for none.
        of_painted: the same in the painted one.

    Returns: the leaves whose branches are there; None where there are none.
    """
    parts = []
    for leaves, numbers, wanted in ((plain, of_plain, False), (painted, of_painted, True)):
        if leaves is None:
            continue
        index = np.full(max(int(numbers.max(initial=-1)), int(leaves.node.max(initial=-1))) + 1, -1)
        index[numbers[numbers >= 0]] = np.flatnonzero(numbers >= 0)
        node = index[leaves.node]
        middle = leaves.position + 0.5 * leaves.scale[:, None] * rotation_matrices(leaves.rotation)[:, :, 1]
        stays = (node >= 0) & (find_painted(middle, cameras, edits).anyhow == wanted)
        parts.append((leaves, stays, node[stays].astype(np.int32)))
    if not any(stays.any() for _, stays, _ in parts):
        return None

    def join(name: str) -> NDArray[np.float32]:
        return np.concatenate([getattr(leaves, name)[stays] for leaves, stays, _ in parts])

    return replace(
        parts[0][0],
        position=join("position"),
        rotation=join("rotation"),
        scale=join("scale"),
        color=join("color"),
        node=np.concatenate([node for _, _, node in parts]),
    )
