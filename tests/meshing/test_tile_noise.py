import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.meshing.tile_noise import tile_cells, tile_noise


@given(st.integers(0, 1000), st.floats(1, 12), st.floats(1, 12))
@settings(max_examples=20, deadline=None)
def test_noise_is_settled_and_goes_on_over_the_edge(seed, across, down):
    noise = tile_noise(np.random.default_rng(seed), 64, across, down, rough=0.0)
    assert np.isclose(noise.mean(), 0.0, atol=1e-9)
    assert np.isclose(noise.std(), 1.0)
    for axis in (0, 1):
        steps = np.abs(noise - np.roll(noise, 1, axis=axis)).max(axis=1 - axis)
        assert steps[0] <= 1.5 * steps[1:].max()


def test_cells_equal_the_search_over_all_copies_of_all_seeds():
    x, y = np.random.default_rng(1).uniform(-0.5, 1.5, (2, 200))
    inside, number = tile_cells(np.random.default_rng(2), x, y, 4, 3)
    rng = np.random.default_rng(2)
    jitter = rng.uniform(0.1, 0.9, (2, 3, 4))
    column, row = np.meshgrid(np.arange(4), np.arange(3))
    seeds = np.stack([column + jitter[0], row + jitter[1] + 0.5 * (column % 2)], -1).reshape(-1, 2)
    copies = [seeds + np.array([4 * i, 3 * j]) for i in range(-3, 4) for j in range(-3, 4)]
    away = np.array([np.hypot(*(c.T[:, :, None] - np.array([4 * x, 3 * y])[:, None, :])) for c in copies])
    nearest = away.min(axis=0)
    best = np.sort(away.reshape(-1, 200), axis=0)
    assert np.array_equal(nearest.argmin(axis=0), number)
    assert np.allclose(best[1] - best[0], inside, atol=1e-9)


def test_cells_repeat_with_the_picture():
    x, y = np.random.default_rng(3).uniform(0, 1, (2, 100))
    one = tile_cells(np.random.default_rng(0), x, y, 5, 4)
    two = tile_cells(np.random.default_rng(0), x + 1.0, y - 2.0, 5, 4)
    assert np.allclose(one[0], two[0], atol=1e-9)
    assert np.array_equal(one[1], two[1])
