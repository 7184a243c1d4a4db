"""Random skeletons that keep the model's promises."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from flowtree.model.skeleton import Skeleton


def random_skeleton(count: int, seed: int) -> Skeleton:
    """A random tree of ``count`` nodes; ordered, the root at the origin, anything else at random."""
    rng = np.random.default_rng(seed)
    parent = np.array([-1, *(int(rng.integers(k)) for k in range(1, count))], np.int32)
    points = rng.normal(0, 3, (count, 3)).astype(np.float32)
    points[0] = 0
    return Skeleton(
        parent=parent,
        points=points,
        radius=rng.uniform(0, 0.5, count).astype(np.float32),
        particles=rng.integers(1, 5000, count).astype(np.int32),
        level=rng.integers(0, 9, count).astype(np.int32),
        twig=rng.random(count) < 0.3,
    )


skeletons = st.builds(random_skeleton, st.integers(1, 40), st.integers(0, 2**32 - 1))
