import numpy as np
import scipy.sparse as sparse
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.match_depths import draw_shares, match_depths


def views(rng, cells=12, things=80, count=2):
    """What things give cells: each covers one to three neighbouring cells of every view."""
    matrices = []
    for _ in range(count):
        dense = np.zeros((cells, things))
        for k in range(things):
            first, width = rng.integers(cells), rng.integers(1, 4)
            dense[first : first + width, k] = rng.uniform(0.1, 0.4)
        matrices.append(sparse.csr_array(dense))
    return matrices


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_targets_that_can_be_met_are_met(seed):
    """But for a few percent, by which the shares may go to and fro between two views."""
    rng = np.random.default_rng(seed)
    matrices = views(rng)
    hidden = rng.uniform(0.1, 0.7, 80)
    targets = [m @ hidden for m in matrices]
    shares = match_depths(matrices, targets, np.full(80, 0.3), rounds=200)
    assert (shares >= 0).all()
    assert (shares <= 1).all()
    for matrix, target in zip(matrices, targets, strict=True):
        assert np.abs(matrix @ shares - target).sum() < 0.05 * target.sum()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_no_view_has_the_last_word(seed):
    rng = np.random.default_rng(seed)
    matrices = views(rng)
    targets = [m @ rng.uniform(0.0, 1.0, 80) for m in matrices]
    there = match_depths(matrices, targets, np.full(80, 0.3), rounds=100)
    back = match_depths(matrices[::-1], targets[::-1], np.full(80, 0.3), rounds=100)
    last = np.abs(matrices[1] @ there - targets[1]).sum() - np.abs(matrices[1] @ back - targets[1]).sum()
    assert abs(last) < 0.03 * targets[1].sum()


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_the_default_rounds_come_most_of_the_way(seed):
    rng = np.random.default_rng(seed)
    matrices = views(rng)
    targets = [m @ rng.uniform(0.0, 1.0, 80) for m in matrices]  # of different things: views disagree
    start = np.full(80, 0.3)
    shares = match_depths(matrices, targets, start)

    def gap(x):
        return sum(np.abs(m @ x - t).sum() for m, t in zip(matrices, targets, strict=True))

    assert gap(shares) < 0.6 * gap(start)


def test_what_covers_an_empty_cell_alone_goes_and_what_is_too_little_stays():
    matrix = sparse.csr_array(np.eye(3))
    shares = match_depths([matrix], [np.array([0.0, 0.5, 7.0])], np.full(3, 0.5))
    assert np.allclose(shares, [0.0, 0.5, 1.0])


def test_what_no_view_shows_goes():
    matrix = sparse.csr_array((4, 2))
    assert match_depths([matrix], [np.ones(4)], np.ones(2)).tolist() == [0.0, 0.0]


def test_nothing_to_choose_among_is_no_error():
    assert len(match_depths([sparse.csr_array((4, 0))], [np.ones(4)], np.zeros(0))) == 0
    assert len(draw_shares(np.zeros(0), seed=0)) == 0


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), shares=st.lists(st.floats(0, 1), min_size=1, max_size=60))
def test_any_run_keeps_as_many_as_its_shares_add_up_to(seed, shares):
    kept = draw_shares(np.array(shares), seed=seed)
    total, count = np.cumsum([0, *shares]), np.cumsum([0, *kept])
    for begin in range(len(shares)):
        runs = np.abs((count[begin + 1 :] - count[begin]) - (total[begin + 1 :] - total[begin]))
        assert (runs < 1 + 1e-9).all()


def test_over_many_seeds_each_thing_is_kept_with_its_share():
    shares = np.random.default_rng(0).random(30)
    often = np.mean([draw_shares(shares, seed=s) for s in range(2000)], axis=0)
    assert np.abs(often - shares).max() < 0.05  # four standard deviations of a mean of 2,000


def test_certain_and_impossible_things():
    shares = np.tile([0.0, 1.0], 20)
    for seed in range(10):
        assert np.array_equal(draw_shares(shares, seed=seed), shares > 0)
