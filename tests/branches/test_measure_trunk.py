import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.branches.measure_trunk import measure_trunk
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

TRUTH = Path(__file__).parents[2] / ".." / "shared" / "data" / "truth"


def matte(alpha):
    return Matte(alpha.astype(np.float32), np.zeros((*alpha.shape, 3), np.uint8), "automatic")


def tree(width, lean=0.0, crown_from=0.35, blur=True):
    """A stem of that width [pixels], its foot at (100, 390), below a crown; exact coverage at its edges."""
    alpha = np.zeros((400, 200))
    columns = np.arange(200)
    for row in range(10, 390):
        up = (390 - row) / 380
        half = width / 2 if up < crown_from else 60.0
        middle = 100 + lean * (390 - row)
        cover = np.minimum(columns + 1, middle + half) - np.maximum(columns, middle - half)
        alpha[row] = np.clip(cover, 0, 1) if blur else cover > 0.5
    return alpha


CAMERA = Camera(0.0, 0.05, (100.0, 390.0), 200, 400)


@pytest.mark.parametrize("width", [4.0, 7.5, 12.3, 30.0])
def test_width_is_finer_than_a_pixel(width):
    assert measure_trunk(matte(tree(width)), CAMERA) == pytest.approx(width / 2 * 0.05, rel=0.02)


def test_a_leaning_stem_is_followed():
    assert measure_trunk(matte(tree(10.0, lean=0.2)), CAMERA) == pytest.approx(0.25, rel=0.05)


def test_a_low_fork_does_not_widen_it():
    assert measure_trunk(matte(tree(10.0, crown_from=0.1)), CAMERA) == pytest.approx(0.25, rel=0.05)


def test_a_crown_down_to_the_ground_has_no_stem():
    assert measure_trunk(matte(tree(10.0, crown_from=0.0)), CAMERA) is None
    assert measure_trunk(matte(np.zeros((400, 200))), CAMERA) is None


def test_mirror_images_measure_the_same():
    alpha = tree(11.0, lean=0.1)
    there = measure_trunk(matte(alpha), CAMERA)
    assert measure_trunk(matte(alpha[:, ::-1]), CAMERA) == pytest.approx(there, rel=1e-5)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1), fill=st.floats(0, 1), foot=st.tuples(st.floats(0, 40), st.floats(0, 60))
)
def test_random_alpha_gives_a_radius_or_none(seed, fill, foot):
    rng = np.random.default_rng(seed)
    alpha = np.where(rng.random((60, 40)) < fill, rng.random((60, 40)), 0.0)
    radius = measure_trunk(matte(alpha), Camera(0.0, 0.1, foot, 40, 60))
    assert radius is None or 0 < radius < 0.08 * 60 * 0.1 + 1e-6


@pytest.mark.skipif(not TRUTH.is_dir(), reason="the shared test data are not here")
@pytest.mark.parametrize("name", ["aspen", "birch", "maple_bare", "willow"])
def test_known_stems(name):
    known = json.loads((TRUTH / name / "truth.json").read_text())
    stem = np.array(known["stems"][0])
    true = np.interp(0.05 * known["height"], stem[:, 1], stem[:, 3])
    view = known["views"][0]
    alpha = np.asarray(Image.open(TRUTH / name / view["file"]))[..., 3] / 255
    camera = Camera(0.0, view["metres_per_pixel"], tuple(view["foot_pixel"]), alpha.shape[1], alpha.shape[0])
    # Half of the stretch lies above 5 % of the height, where the stem is a little thinner.
    assert measure_trunk(matte(alpha), camera) == pytest.approx(true, rel=0.1)
