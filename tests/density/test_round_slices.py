import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.density.footprint_matrix import footprint_matrix
from flowtree.density.guess_depths import guess_depths
from flowtree.density.round_slices import round_slices

SIDE, ROWS = 40, 48
CENTRES = np.arange(SIDE) + 0.5 - SIDE / 2
COLUMNS = 2 * int(np.ceil(SIDE / 2 * np.sqrt(2))) + 2


def _seen(crown, yaws):
    """Depths of a crown (side * side, rows) in each view."""
    grid = {"left": -COLUMNS / 2, "cell": 1.0, "columns": COLUMNS}
    return [footprint_matrix(CENTRES, CENTRES, yaw, **grid) @ crown for yaw in yaws]


def _round_crown(profile, lean=0.0):
    """A crown whose slices are round about an axis that leans along x by ``lean`` voxels a row."""
    x, z = np.meshgrid(CENTRES, CENTRES, indexing="ij")
    rows = [profile(np.hypot(x - lean * (row - ROWS / 2), z)).ravel() for row in range(ROWS)]
    return np.stack(rows, axis=1)


def _everywhere(slices):
    """The slices' voxels (side * side, rows)."""
    rows = []
    for axis, profile in zip(slices.axis, slices.profile, strict=True):
        away = np.linalg.norm(slices.place - axis, axis=1)
        rows.append(np.interp(away, np.arange(len(profile)) + 0.5, profile))
    return np.stack(rows, axis=1)


@pytest.mark.parametrize("yaws", [(0.0, 90.0), (10.0, 70.0), (0.0, 45.0, 100.0)])
@pytest.mark.parametrize("kind", ["full", "hollow", "thin toward the rim"])
def test_a_round_crown_is_found_from_any_views(kind, yaws):
    profiles = {
        "full": lambda r: 0.1 * (r < 15),
        "hollow": lambda r: 0.1 * ((r > 8) & (r < 15)),
        "thin toward the rim": lambda r: 0.2 * np.exp(-((r / 6) ** 2)),
    }
    crown = _round_crown(profiles[kind])
    depths = _seen(crown, yaws)
    found = _everywhere(round_slices(depths, [d > -1 for d in depths], yaws, CENTRES))
    # An edge within the crown stays soft: the rounds end before they sharpen noise.
    assert np.abs(found - crown).sum() < (0.3 if kind == "hollow" else 0.2) * crown.sum()
    for one, two in zip(_seen(found, yaws), depths, strict=True):
        assert np.abs(one - two).sum() < 0.1 * two.sum()


def test_the_axis_follows_a_leaning_tree():
    crown = _round_crown(lambda r: 0.1 * (r < 6), lean=0.2)
    depths = _seen(crown, (0.0, 90.0))
    axis = round_slices(depths, [d > -1 for d in depths], (0.0, 90.0), CENTRES).axis
    inner = slice(8, ROWS - 8)  # at the ends fewer heights share what they see
    wanted = 0.2 * (np.arange(ROWS) - ROWS / 2)
    assert np.abs(axis[inner, 0] - wanted[inner]).max() < 1.0
    assert np.abs(axis[:, 1]).max() < 0.2


def test_a_crown_half_hidden_in_one_view_keeps_its_shape():
    crown = _round_crown(lambda r: 0.1 * (r < 15))
    depths = _seen(crown, (0.0, 90.0))
    known = [np.ones(d.shape, bool) for d in depths]
    known[0][COLUMNS // 2 + 3 :] = False
    depths[0] = np.where(known[0], depths[0], 0.0)
    found = _everywhere(round_slices(depths, known, (0.0, 90.0), CENTRES))
    assert np.abs(found - crown).sum() < 0.2 * crown.sum()


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    yaws=st.lists(st.floats(-720, 720), min_size=1, max_size=4),
    rows=st.integers(1, 12),
    shown=st.sampled_from([0.0, 0.1, 1.0]),
    sure=st.sampled_from([0.0, 0.5, 1.0]),
)
def test_whatever_the_views_show_the_slices_are_above_nothing(seed, yaws, rows, shown, sure):
    rng = np.random.default_rng(seed)
    shape = (COLUMNS, rows)
    depths = [4.6 * rng.random(shape) * (rng.random(shape) < shown) for _ in yaws]
    known = [rng.random(shape) < sure for _ in yaws]
    depths = [np.where(k, d, 0.0) for d, k in zip(depths, known, strict=True)]
    slices = round_slices(depths, known, yaws, CENTRES)
    assert slices.axis.shape == (rows, 2)
    assert len(slices.profile) == rows
    assert np.isfinite(slices.profile).all()
    assert (slices.profile > 0).all()
    assert np.abs(slices.axis).max() <= SIDE / 2


def test_what_is_not_known_is_guessed_from_the_other_side_or_from_beside_it():
    depth = np.arange(8.0)[:, None] * [1.0, 1.0, 1.0]
    known = np.ones((8, 3), bool)
    known[6, 0] = known[[1, 6], 1] = False
    known[:, 2] = False
    guessed = guess_depths(np.where(known, depth, 0.0), known)
    assert guessed[:, 0].tolist() == [0, 1, 2, 3, 4, 5, 1, 7]
    assert guessed[:, 1].tolist() == [0, 1, 2, 3, 4, 5, 6, 7]
    assert (guessed[:, 2] == 0).all()
    assert guess_depths(depth, np.ones((8, 3), bool)) is depth
