from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.foliage.choose_leaf import choose_leaf
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from tests.crowns import ball_matte, camera_at, plane_of

CUTOUTS = Path(__file__).parents[2] / ".." / "shared" / "data" / "cutouts"
CAMERA = camera_at(0.0)
RIGHT, UP = plane_of(CAMERA)


def matte_of(shape):
    return Matte(shape.astype(np.float32), np.zeros((*shape.shape, 3), np.uint8), "trimap")


STEM = (np.abs(RIGHT) < 0.1) & (UP > 0) & (UP < 1)
CONE = matte_of((np.abs(RIGHT) < 0.28 * (7.6 - UP)) & (UP > 0.4) | STEM)
TUFT = matte_of((np.hypot(RIGHT, (UP - 6.5) * 1.5) < 1.6) | (np.abs(RIGHT) < 0.15) & (UP > 0) & (UP < 6))
BALL = ball_matte(CAMERA, 0.7)


@pytest.mark.parametrize(("matte", "leaf"), [(CONE, "needle"), (TUFT, "lanceolate"), (BALL, "broad")])
def test_silhouettes(matte, leaf):
    assert choose_leaf([matte], [CAMERA]) == leaf
    assert choose_leaf([matte] * 2, [CAMERA] * 2) == leaf
    mirrored = replace(matte, alpha=np.ascontiguousarray(matte.alpha[:, ::-1]))
    assert choose_leaf([mirrored], [replace(CAMERA, foot=(128 - 64.0, 168.0))]) == leaf


def test_views_that_disagree_mean_an_ordinary_tree():
    assert choose_leaf([CONE, BALL], [CAMERA] * 2) == "broad"
    assert choose_leaf([CONE, CONE, BALL], [CAMERA] * 3) == "needle"


@pytest.mark.skipif(not CUTOUTS.is_dir(), reason="the shared test data are not here")
@pytest.mark.parametrize(
    ("name", "leaf"),
    [
        ("snowy-spruce", "needle"),
        ("palm-tree2", "lanceolate"),
        ("horse-chestnut-tree", "broad"),
        ("purple-leaf-plum", "broad"),
    ],
)
def test_real_trees(name, leaf):
    picture = np.asarray(Image.open(CUTOUTS / f"{name}.png").convert("RGBA"))
    alpha = (picture[..., 3] / 255).astype(np.float32)
    rows, columns = np.nonzero(alpha > 0.5)
    foot = (float(np.median(columns[rows > np.quantile(rows, 0.99)])), float(rows.max() + 1))
    camera = Camera(0.0, 0.01, foot, alpha.shape[1], alpha.shape[0])
    assert choose_leaf([Matte(alpha, picture[..., :3].copy(), "alpha channel")], [camera]) == leaf


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    shape=st.tuples(st.integers(1, 40), st.integers(1, 30)),
    fill=st.floats(0, 1),
    foot=st.floats(-5, 60),
)
def test_any_matte_gets_a_leaf(seed, shape, fill, foot):
    alpha = np.random.default_rng(seed).random(shape) < fill
    camera = replace(CAMERA, width=shape[1], height=shape[0], foot=(shape[1] / 2, foot))
    assert choose_leaf([matte_of(alpha)], [camera]) in ("broad", "needle", "lanceolate")
