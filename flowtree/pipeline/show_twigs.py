"""What far levels of a bare tree have no triangles for, on cards."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh
from flowtree.model.tree import TreeModel

CARDS = 11  # of each of three directions
_ROUNDED = 0.3  # of the cards' normals, the way out of the crown: else each is lit as the plane that it is


def show_twigs(tree: TreeModel, shown: NDArray[np.bool_], *, device: str | None = None) -> Foliage:
    """Bakes branches on crossed cards (`bake_crossed`), as one large leaf that stands on the root.

    Args:
        tree: whose wood's vertices know their nodes.
        shown: (n,), which of its nodes; some of the wood belongs to them.
        device: to run on.
    """
    from flowtree.render.bake_crossed import bake_crossed  # few ask for it

    assert tree.wood.node is not None
    part = shown[tree.wood.node[tree.wood.triangles]].any(axis=1)
    twigs = replace(tree, wood=replace(tree.wood, triangles=tree.wood.triangles[part]), foliage=None)
    card = bake_crossed(twigs, cards=CARDS, device=device)
    return Foliage(
        leaf=_rounded(card.mesh),
        material=replace(card.material, name=f"{tree.bark.name}_twigs", normal=None),
        position=np.zeros((1, 3), np.float32),
        rotation=np.array([[0, 0, 0, 1]], np.float32),
        scale=np.ones(1, np.float32),
        color=np.ones((1, 3), np.float32),
        node=np.zeros(1, np.int32),
        rounding=0.0,
    )


def _rounded(cards: TreeMesh) -> TreeMesh:
    """Normals bent out of the crown, each card's on the side that is seen from outside."""
    corner = cards.positions.reshape(-1, 4, 3).astype(np.float64)
    middle = 0.5 * (cards.positions.min(axis=0) + cards.positions.max(axis=0)).astype(np.float64)
    own = cards.normals.reshape(-1, 4, 3).astype(np.float64)
    away = corner - middle
    away /= np.maximum(np.linalg.norm(away, axis=2, keepdims=True), 1e-9)
    side = np.where((own * (corner.mean(axis=1, keepdims=True) - middle)).sum(axis=2) < 0, -1.0, 1.0)
    bent = (1.0 - _ROUNDED) * own + _ROUNDED * side[:, :, None] * away
    bent /= np.linalg.norm(bent, axis=2, keepdims=True)
    return replace(cards, normals=bent.reshape(-1, 3).astype(np.float32), tangents=None)
