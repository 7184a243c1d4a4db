import numpy as np
import pytest
import scipy.sparse as sparse
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from flowtree.density.fit_depths import fit_depths
from flowtree.density.footprint_matrix import footprint_matrix
from tests.flows import DEVICES

YAWS = [(25.0,), (0.0, 90.0), (10.0, 75.0), (0.0, 60.0, 120.0), (5.0, 50.0, 99.0, 140.0), (3.3, 41.7, 47.1)]


def _shares(yaws, side=16):
    """Every view's shares of the voxels of a slice with an edge of 1."""
    centres = np.arange(side) + 0.5 - side / 2
    columns = 2 * int(np.ceil(side / 2 * np.sqrt(2))) + 2
    grid = {"left": -columns / 2, "cell": 1.0, "columns": columns}
    return [footprint_matrix(centres, centres, yaw, **grid) for yaw in yaws]


def _crown(side=16, rows=21, seed=0):
    """Voxels (voxels, rows) of a loose crown."""
    rng = np.random.default_rng(seed)
    x = np.arange(side) + 0.5 - side / 2
    round_ = np.hypot(x[:, None], x[None, :]).ravel() < 0.47 * side
    return rng.random((side * side, rows)) * (rng.random((side * side, rows)) < 0.5) * round_[:, None]


def _fit(shares, depths, *, least=0.0, iterations=500, tolerance=1e-3, device="cpu"):
    """The result as (voxels, rows)."""
    fitted = fit_depths(
        shares, depths, least=least, iterations=iterations, tolerance=tolerance, device=device
    )
    assert fitted.dtype == np.float32
    flat = fitted.swapaxes(0, 1).reshape(fitted.shape[1], -1)
    rows = depths[0].shape[1]
    assert (flat[:, rows:] == 0).all()
    return flat[:, :rows]


def _relative(shares, depths, fitted):
    rest = np.concatenate([m @ fitted.astype(float) - d for m, d in zip(shares, depths, strict=True)])
    return np.linalg.norm(rest) / np.linalg.norm(np.concatenate(depths))


def _weighted(shares, depths, fitted):
    """The sum that the rounds lower, for every height."""
    squares = 0.0
    for matrix, depth in zip(shares, depths, strict=True):
        length = np.asarray(matrix.sum(axis=1))
        weight = np.where(length > 0, 1 / np.maximum(length, 0.1), 0)
        squares = squares + weight @ (matrix @ fitted.astype(float) - depth) ** 2
    return squares


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("yaws", YAWS)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_views_of_one_thing_are_satisfied_to_the_tolerance(yaws, tolerance, device):
    shares = _shares(yaws)
    depths = [m @ _crown() for m in shares]
    fitted = _fit(shares, depths, tolerance=tolerance, device=device)
    assert (fitted >= 0).all()
    assert _relative(shares, depths, fitted) <= tolerance * (1 + 1e-4)
    # A height's voxels together hold what each view shows of it.
    assert np.allclose(fitted.sum(axis=0), depths[0].sum(axis=0), rtol=10 * tolerance)


@pytest.mark.parametrize("yaws", YAWS[1:])
def test_no_round_makes_any_height_worse(yaws):
    shares, rng = _shares(yaws), np.random.default_rng(1)
    # Loose views: nothing satisfies all of them.
    depths = [m @ _crown(rows=5, seed=k) * rng.uniform(0.8, 1.2, 5) for k, m in enumerate(shares)]
    left = [
        _weighted(shares, depths, _fit(shares, depths, iterations=rounds, tolerance=0.0))
        for rounds in range(40)
    ]
    assert (np.diff(left, axis=0) <= 1e-5 * left[0]).all()
    assert (left[-1] < left[0]).all()


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_loose_views_are_fitted_as_well_as_anything_could(seed):
    """A slow exact method (Lawson and Hanson's) says what the least residual is."""
    shares, rng = _shares((0.0, 40.0, 95.0), side=6), np.random.default_rng(seed)
    depths = [m @ rng.random((36, 1)) * rng.uniform(0.7, 1.3, (m.shape[0], 1)) for m in shares]
    length = np.concatenate([np.asarray(m.sum(axis=1)) for m in shares])
    root = np.where(length > 0, 1 / np.sqrt(np.maximum(length, 0.1)), 0)
    whole, wanted = sparse.vstack(shares).toarray() * root[:, None], np.concatenate(depths)[:, 0] * root
    _, best = nnls(whole, wanted)
    # With noise of 30 % on so small a slice the last of it comes off very slowly.
    for above, stop in ((0.006, {"tolerance": 1e-3}), (0.0015, {"tolerance": 0.0, "iterations": 600})):
        ours = np.sqrt(_weighted(shares, depths, _fit(shares, depths, **stop))[0])
        assert best * (1 - 1e-5) <= ours <= best + above * np.linalg.norm(wanted)


def test_what_a_view_does_not_show_stays_empty():
    shares = _shares((0.0, 90.0))
    depths = [m @ _crown() for m in shares]
    least = 0.8
    filled = np.minimum.reduce([m.T @ d for m, d in zip(shares, depths, strict=True)]) >= least + 1e-4
    fitted = _fit(shares, depths, least=least, iterations=30)
    assert (fitted[~filled] == 0).mean() > 0.999  # at the threshold itself float32 may say otherwise
    assert (fitted[filled] > 0).mean() > 0.9


def test_what_the_views_leave_open_is_the_product():
    """At a right angle the start satisfies both: no round changes it."""
    shares = _shares((0.0, 90.0))
    depths = [m @ _crown(rows=3) for m in shares]
    product = np.multiply.reduce([m.T @ d for m, d in zip(shares, depths, strict=True)])
    product *= depths[0].sum(axis=0) / product.sum(axis=0)
    assert np.allclose(_fit(shares, depths, iterations=0), product, rtol=1e-4, atol=1e-6)
    assert np.allclose(_fit(shares, depths), product, rtol=1e-3, atol=1e-5)


@pytest.mark.parametrize("yaws", [(0.0, 90.0), (5.0, 50.0, 99.0, 140.0)])
def test_one_core_and_two_give_the_same_bytes(yaws, monkeypatch):
    shares = _shares(yaws, side=20)
    depths = [m @ _crown(side=20, rows=40) for m in shares]
    results = []
    for threads in ("1", "2", "5"):
        monkeypatch.setenv("FLOWTREE_THREADS", threads)
        results.append(_fit(shares, depths, tolerance=0.0, iterations=12).tobytes())
    assert len(set(results)) == 1


def test_a_height_is_fitted_as_it_would_be_alone():
    shares = _shares((12.0, 71.0))
    depths = [m @ _crown(rows=40) for m in shares]
    together = _fit(shares, depths, tolerance=0.0, iterations=4)
    alone = _fit(shares, [d[:, 19:36] for d in depths], tolerance=0.0, iterations=4)
    assert np.array_equal(together[:, 19:36], alone)


@pytest.mark.parametrize("views", [2, 20, 60])
def test_many_views_neither_overflow_nor_vanish(views):
    shares = _shares(np.linspace(0, 170, views), side=8)
    depths = [m @ (4 * _crown(side=8, rows=3)) for m in shares]
    fitted = _fit(shares, depths, iterations=50)
    assert np.isfinite(fitted).all()
    assert _relative(shares, depths, fitted) < 0.05


def test_nothing_shown_gives_nothing():
    shares = _shares((0.0, 90.0))
    depths = [np.zeros((m.shape[0], 4)) for m in shares]
    assert (_fit(shares, depths) == 0).all()
    depths[0][10, 2] = 1.0  # one view alone shows something
    assert np.isfinite(_fit(shares, depths)).all()
