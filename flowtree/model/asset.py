"""The tree with all that an engine wants of it."""

from __future__ import annotations

from dataclasses import dataclass

from flowtree.model.collision import Collision
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.model.wind import Wind


@dataclass(frozen=True)
class Card:
    """A few flat pieces with pictures of the tree on them.

    Attributes:
        name: what kind of card it is: ``crossed`` or ``octahedral``.
        mesh: the pieces, world frame.
        material: pictures of the tree: albedo with alpha, and normals; of an octahedral card depths, too.
        frames: pictures along each side of the texture: 1, or those of the octahedral map.
    """

    name: str
    mesh: TreeMesh
    material: Material
    frames: int = 1


@dataclass(frozen=True)
class TreeAsset:
    """A tree, its coarser levels, and what moves and bounds it.

    Attributes:
        levels: from the finest, level 0, on; all of one skeleton's shape, each with its own thinned copy.
        cards: for far away, after the last level.
        winds: what moves each level; empty, or one for each.
        collision: None where none is wanted.
    """

    levels: tuple[TreeModel, ...]
    cards: tuple[Card, ...] = ()
    winds: tuple[Wind, ...] = ()
    collision: Collision | None = None
