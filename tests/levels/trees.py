"""Trees for levels of detail: skeletons of any kind, swept, with leaves of the project's own shapes."""

from __future__ import annotations

import numpy as np

from flowtree.foliage.make_leaf import make_leaf
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.foliage import Foliage
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from tests.skeletons import random_skeleton
from tests.trees import bark_material


def leaves_on(skeleton: Skeleton, count: int, *, shape: str = "broad", seed: int = 0) -> Foliage:
    """Leaves at random places on all segments."""
    rng = np.random.default_rng(seed)
    mesh, material = make_leaf(shape)
    node = rng.integers(1, len(skeleton.parent), count).astype(np.int32)
    share = rng.random((count, 1))
    start, end = skeleton.points[skeleton.parent[node]], skeleton.points[node]
    turn = rng.normal(size=(count, 4))
    return Foliage(
        leaf=mesh,
        material=material,
        position=(start + share * (end - start)).astype(np.float32),
        rotation=(turn / np.linalg.norm(turn, axis=1, keepdims=True)).astype(np.float32),
        scale=rng.uniform(0.15, 0.3, count).astype(np.float32),
        color=rng.uniform(0.1, 0.9, (count, 3)).astype(np.float32),
        node=node,
    )


def grown_tree(seed: int = 0, nodes: int = 300, leaves: int = 400, *, shape: str = "broad") -> TreeModel:
    """A tree of many short branches."""
    skeleton = random_skeleton(seed, nodes, stubborn=0.6)
    return TreeModel(
        name="Tree",
        height=float(skeleton.points[:, 1].max()),
        skeleton=skeleton,
        wood=sweep_rings(skeleton, device="cpu"),
        bark=bark_material(),
        foliage=leaves_on(skeleton, leaves, shape=shape, seed=seed) if leaves else None,
    )
