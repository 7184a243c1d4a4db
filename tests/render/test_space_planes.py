from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flowtree.render.space_planes import space_planes


@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 200))
def test_one_plane_is_held_and_every_piece_has_its_nearest(seed, count, pieces):
    rng = np.random.default_rng(seed)
    along, weight, held = rng.normal(size=pieces), rng.random(pieces) + 0.01, float(rng.normal())
    places, nearest = space_planes(along, weight, count, held)
    assert places.shape == (count,)
    assert (np.diff(places) >= 0).all()
    assert held in places
    assert np.allclose(np.abs(along - places[nearest]), np.abs(along[:, None] - places).min(axis=1))


def test_planes_lie_nearer_than_evenly_spaced_ones():
    rng = np.random.default_rng(1)
    along = np.concatenate([rng.normal(-3, 0.2, 900), rng.normal(0, 1, 300), rng.normal(2.5, 0.1, 800)])
    weight = np.ones(len(along))
    places, _ = space_planes(along, weight, 7, 0.0)
    even = np.linspace(along.min(), along.max(), 15)[1::2]

    def cost(at):
        return ((along[:, None] - at) ** 2).min(axis=1).sum()

    assert cost(places) < 0.5 * cost(even)


def test_what_weighs_nothing_draws_no_plane():
    along = np.array([0.0, 1.0, 50.0])
    places, _ = space_planes(along, np.array([1.0, 1.0, 0.0]), 2, 0.0)
    assert places == pytest.approx([0.0, 1.0])
