"""Small systems, all at once."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from flowtree.geometry.solve_symmetric import solve_symmetric


@given(st.integers(0, 1000), st.sampled_from([1e-4, 1.0, 1e3]))
def test_it_solves_what_lapack_solves(seed, floor):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 5, 3, 3))
    matrix = root @ np.swapaxes(root, -1, -2) + floor * np.eye(3)
    right = rng.normal(size=(4, 5, 3))
    expected = np.linalg.solve(matrix, right[..., None])[..., 0]
    assert np.allclose(solve_symmetric(matrix, right), expected, rtol=1e-6, atol=1e-9 / floor)
