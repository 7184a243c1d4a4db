from __future__ import annotations

import numpy as np
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.capsule_mesh import capsule_mesh
from flowtree.geometry.polylines import nearest_on_segments


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    radius=st.floats(0.01, 3),
    sides=st.integers(3, 16),
    rings=st.integers(1, 4),
    tall=st.sampled_from([0.0, 1.0, 5.0]),
)
def test_it_is_a_convex_closed_capsule(seed, radius, sides, rings, tall):
    rng = np.random.default_rng(seed)
    low = rng.normal(size=3)
    ends = np.stack([low, low + tall * rng.normal(size=3)])
    positions, triangles = capsule_mesh(ends, radius, sides=sides, rings=rings)
    assert len(positions) == 2 * rings * sides + 2
    mesh = trimesh.Trimesh(positions, triangles, process=False)
    assert mesh.is_winding_consistent
    assert mesh.volume > 0
    _, nearest = nearest_on_segments(positions, *ends)
    np.testing.assert_allclose(np.linalg.norm(positions - nearest, axis=1), radius, rtol=1e-4)
    if tall:
        assert mesh.is_watertight
        assert mesh.convex_hull.volume <= mesh.volume * 1.001
