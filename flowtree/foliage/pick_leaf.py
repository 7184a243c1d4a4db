"""The leaf that a tree bears."""

from __future__ import annotations

from collections.abc import Sequence

from flowtree.foliage.choose_leaf import choose_leaf
from flowtree.foliage.make_leaf import make_leaf
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material, TreeMesh
from flowtree.params import LeafParams


def pick_leaf(
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    params: LeafParams = LeafParams(),
    seed: int = 0,
) -> tuple[TreeMesh, Material]:
    """The leaf of a tree that looks so: of the shape that is asked for or suits it, light grey.

    Raises:
        InputError: a leaf picture that cannot be used.
    """
    shape = choose_leaf(mattes, cameras) if params.shape == "auto" else params.shape
    return make_leaf(shape, color=(0.8, 0.8, 0.8), seed=seed, picture=params.picture)
