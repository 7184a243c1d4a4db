"""The finished tree."""

from __future__ import annotations

from dataclasses import dataclass

from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton


@dataclass(frozen=True)
class TreeModel:
    """Everything a file or a picture of the tree is made from.

    Attributes:
        name: of the nodes in the file.
        height: [m], foot to top.
        skeleton: the branches.
        wood: their surface.
        bark: its material.
        foliage: the leaves; None for a bare tree.
    """

    name: str
    height: float
    skeleton: Skeleton
    wood: TreeMesh
    bark: Material
    foliage: Foliage | None
