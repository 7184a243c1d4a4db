import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.flow.seed_particles import seed_particles
from flowtree.model.volume import DensityVolume


def _counts(volume, count, seed):
    places = seed_particles(volume, count, seed=seed)
    cell = np.floor((places - volume.origin) / volume.voxel).astype(int)
    cell = np.clip(cell, 0, np.array(volume.density.shape) - 1)  # float32 may round up to the far border
    counts = np.zeros(volume.density.shape, int)
    np.add.at(counts, tuple(cell.T), 1)
    return counts


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 400), shape=st.tuples(*[st.integers(1, 7)] * 3))
def test_every_voxel_gets_its_share_to_within_two(seed, count, shape):
    """A voxel of expected e particles gets floor(e + t), up to what the given number asks of all."""
    rng = np.random.default_rng(seed)
    density = (rng.random(shape) ** 3).astype(np.float32)
    density[rng.random(shape) < 0.3] = 0
    density[0, 0, 0] = 1.0
    volume = DensityVolume(density, np.float32([-1, 0, 2]), 0.25)
    counts = _counts(volume, count, seed)
    expected = density / density.sum(dtype=float) * count
    assert counts.sum() == count
    assert (counts[density == 0] == 0).all()
    assert (np.abs(counts - expected) < 2 + 1e-3).all()


def test_over_many_seeds_the_shares_are_the_densities():
    density = np.random.default_rng(1).random((3, 3, 3)).astype(np.float32)
    volume = DensityVolume(density, np.zeros(3, np.float32), 1.0)
    rounds, count = 300, 20
    total = sum(_counts(volume, count, seed) for seed in range(rounds))
    expected = density / density.sum() * rounds * count
    # Independent draws would give 26 on the average, with a standard deviation of 7; strata give less.
    assert ((total - expected) ** 2 / expected).sum() < 47


def test_strata_spread_more_evenly_than_independent_draws():
    volume = DensityVolume(np.ones((8, 8, 8), np.float32), np.zeros(3, np.float32), 1.0)
    for seed in range(5):
        blocks = _counts(volume, 512, seed).reshape(2, 4, 2, 4, 2, 4).sum(axis=(1, 3, 5))
        assert (blocks == 64).all()  # an octant is one stretch of the curve


def test_equal_seeds_give_equal_places_and_others_do_not():
    volume = DensityVolume(np.ones((4, 4, 4), np.float32), np.zeros(3, np.float32), 1.0)
    one, same, other = (seed_particles(volume, 50, seed=s) for s in (3, 3, 4))
    assert one.tobytes() == same.tobytes()
    assert not np.array_equal(one, other)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), erased=st.booleans(), wider=st.integers(0, 3))
def test_a_change_in_one_place_leaves_the_places_elsewhere(seed, erased, wider):
    rng = np.random.default_rng(seed)
    density = rng.random((16, 20, 16)).astype(np.float32)
    before = DensityVolume(density, np.float32([-2, 0, -2]), 0.25)
    changed = np.pad(density, ((wider, wider), (0, 0), (wider, wider)))  # the box has become wider too
    changed[wider : wider + 8, 5:15, wider : wider + 8] *= 0.0 if erased else 2.0
    after = DensityVolume(changed, np.float32([-2 - wider / 4, 0, -2 - wider / 4]), 0.25)
    # As many more or less as the place holds, so that elsewhere as many are wanted as before.
    count = 600
    one = seed_particles(before, count, seed=seed)
    two = seed_particles(after, round(count * changed.sum() / density.sum()), seed=seed)

    def far(places):
        return {p.tobytes() for p in places[(places[:, 0] > 0.01) | (places[:, 2] > 0.01)].round(4)}

    assert len(far(one) & far(two)) > 0.95 * len(far(one))
