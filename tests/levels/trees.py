"""Trees for levels of detail: skeletons of any kind, swept, with leaves of the project's own shapes."""

from __future__ import annotations

import numpy as np

from flowtree.foliage.make_leaf import make_leaf
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.foliage import Foliage
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from tests.skeletons import skeleton_of
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


def crown(seed: int = 0, limbs: int = 30) -> Skeleton:
    """A trunk of 10 m, curved limbs all round it, each with thin branches and these with twigs."""
    rng = np.random.default_rng(seed)
    parent, points = [-1], [np.zeros(3)]

    def grow(at: int, toward: np.ndarray, length: float, nodes: int) -> list[int]:
        grown = []
        for _ in range(nodes):
            toward = toward + 0.25 * rng.normal(size=3) + np.array([0.0, 0.1, 0.0])
            toward /= np.linalg.norm(toward)
            parent.append(at)
            points.append(points[at] + length / nodes * toward)
            at = len(points) - 1
            grown.append(at)
        return grown

    trunk = grow(0, np.array([0.0, 3.0, 0.0]), 10.0, 14)
    for limb in range(limbs):
        turn, high = 2.4 * limb, 3 + limb * 10 // limbs
        out = np.array([np.cos(turn), 0.6, np.sin(turn)])
        for node in grow(trunk[high], out, 4.5 - 0.25 * high, 5):
            for _ in range(3):
                aside = out + 0.8 * rng.normal(size=3)
                for inner in grow(node, aside / np.linalg.norm(aside), 1.2, 3):
                    grow(inner, rng.normal(size=3), 0.4, 1)
    return skeleton_of(np.array(parent, np.int32), np.array(points), rng)


def crowned_tree(seed: int = 0, *, limbs: int = 30, leaves: int = 3000, shape: str = "broad") -> TreeModel:
    """Its wood swept, and leaves on it."""
    skeleton = crown(seed, limbs)
    return TreeModel(
        name="Tree",
        height=float(skeleton.points[:, 1].max()),
        skeleton=skeleton,
        wood=sweep_rings(skeleton, device="cpu"),
        bark=bark_material(),
        foliage=leaves_on(skeleton, leaves, shape=shape, seed=seed) if leaves else None,
    )
