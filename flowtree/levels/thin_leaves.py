"""Fewer and larger leaves that let as much light through as all of them."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.rotation_matrices import rotation_matrices
from flowtree.levels.seen_area import seen_area
from flowtree.levels.simplify_leaf import leaf_pieces
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh

# Leaves of one plane for crossed ones lie before each other more often, those of three conifers by so much.
_FLATTER = 1.05


def thin_leaves(
    foliage: Foliage,
    order: NDArray[np.int64],
    count: int,
    leaf: TreeMesh,
    material: Material | None = None,
) -> Foliage:
    """The first ``count`` leaves of an order, of another shape, larger by what the others hid.

    What is seen of all leaves (`seen_area`) stays, and with it the crown's optical depth. A leaf grows about
    the middle of its blade, not away from its twig: the crown's outline does not.

    Args:
        foliage: n leaves.
        order: (n,), as `spread_order` gives it: a leaf of a short beginning is in every longer one too.
        count: leaves to keep.
        leaf: their shape, in the frame of `Foliage`.
        material: of that shape; None for the leaves' own.

    Returns: leaves in the order of ``foliage``.
    """
    kept = np.sort(order[:count])
    flatter = len(leaf_pieces(leaf)) < len(leaf_pieces(foliage.leaf))
    worn = foliage.material if material is None else material
    old, new = seen_area(foliage.leaf, foliage.material), seen_area(leaf, worn)
    whole = float(np.sum(foliage.scale.astype(np.float64) ** 2))
    left = float(np.sum(foliage.scale[kept].astype(np.float64) ** 2))
    growth = np.sqrt(whole * old / (left * new)) if left * new > 0 else 1.0
    growth *= _FLATTER if flatter else 1.0
    scale = foliage.scale[kept].astype(np.float64)
    middle, new_middle = _middle(foliage.leaf), _middle(leaf)
    turned = rotation_matrices(foliage.rotation[kept]).astype(np.float64)
    shift = (turned * (middle - growth * new_middle)).sum(axis=2) * scale[:, None]
    rows = {each.name: getattr(foliage, each.name) for each in fields(foliage)}
    changed: dict[str, Any] = {
        name: value[kept] for name, value in rows.items() if isinstance(value, np.ndarray)
    }
    changed["position"] = (foliage.position[kept] + shift).astype(np.float32)
    changed["scale"] = (growth * scale).astype(np.float32)
    return replace(foliage, leaf=leaf, material=worn, **changed)


def _middle(leaf: TreeMesh) -> NDArray[np.float64]:
    """(3,) the middle of the surface, in leaf lengths."""
    a, b, c = (leaf.positions[leaf.triangles[:, k]].astype(np.float64) for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    total = float(area.sum())
    middle: NDArray[np.float64] = (area[:, None] * (a + b + c)).sum(axis=0) / (3.0 * max(total, 1e-12))
    return middle
