"""Quaternions and their matrices turn alike."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.frames import quaternions
from flowtree.geometry.rotation_matrices import rotation_matrices


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 9999))
def test_there_and_back(seed):
    turns = np.random.default_rng(seed).normal(size=(7, 4))
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    matrices = rotation_matrices(turns)
    np.testing.assert_allclose(
        matrices @ matrices.transpose(0, 2, 1), np.tile(np.eye(3), (7, 1, 1)), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(matrices), 1, atol=1e-12)
    again = quaternions(*matrices.transpose(2, 0, 1))
    np.testing.assert_allclose(np.abs((again * turns).sum(axis=1)), 1, atol=1e-9)
