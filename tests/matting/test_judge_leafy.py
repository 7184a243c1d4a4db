from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.matting.judge_leafy import judge_leafy
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

DATA = Path(__file__).parents[2] / ".." / "shared" / "data"
BARK, LEAF = (90, 75, 60), (60, 130, 40)


def view_of(picture):
    """A picture with alpha as matte and camera."""
    alpha = (picture[..., 3] / 255).astype(np.float32)
    rows = np.flatnonzero((alpha > 0.3).any(axis=1))
    foot = (alpha.shape[1] / 2, float(rows[-1] + 1) if len(rows) else 1.0)
    camera = Camera(0.0, 0.02, foot, alpha.shape[1], alpha.shape[0])
    return Matte(alpha, np.ascontiguousarray(picture[..., :3]), "alpha channel"), camera


def drawn(leaves=0, color=LEAF, seed=0):
    """Forking lines in the colour of bark, with round leaves on their ends."""
    rng = np.random.default_rng(seed)
    picture = np.zeros((560, 440, 4), np.uint8)
    picture[..., :3] = color if leaves else BARK

    def grow(x, y, turn, length, thick, order):
        end = (x + length * np.sin(turn), y - length * np.cos(turn))
        a, b = ((round(16 * u), round(16 * v)) for u, v in ((x, y), end))
        cv2.line(picture, a, b, (*BARK, 255), max(1, round(thick)), cv2.LINE_AA, 4)
        if order == 7:
            for _ in range(leaves):
                spot = np.array(end) + rng.normal(0, 9, 2)
                cv2.circle(picture, spot.round().astype(int).tolist(), 6, (*color, 255), -1)
            return
        for side in (-1, 1):
            grow(*end, turn + side * rng.uniform(0.2, 0.5), length * 0.78, thick * 0.65, order + 1)

    grow(220, 545, 0.0, 120, 16, 0)
    return picture


def judge(*pictures):
    views = [view_of(picture) for picture in pictures]
    return judge_leafy([matte for matte, _ in views], [camera for _, camera in views])


def test_lines_are_bare_and_bunches_of_leaves_are_not():
    assert not judge(drawn())
    assert judge(drawn(leaves=5))


def test_lines_of_another_colour_than_the_trunk_are_no_twigs():
    picture = drawn()
    picture[:380, :, :3] = LEAF
    assert judge(picture)


def test_most_views_must_show_leaves():
    bare, leafy = drawn(), drawn(leaves=5)
    assert judge(leafy, leafy, bare)
    assert not judge(leafy, bare, bare)
    assert not judge(leafy, bare)


def test_mirroring_and_margins_change_nothing():
    for leaves in (0, 5):
        picture = drawn(leaves)
        assert judge(picture) == judge(picture[:, ::-1])
        assert judge(picture) == judge(np.pad(picture, ((40, 0), (60, 20), (0, 0))))


@pytest.mark.skipif(not DATA.is_dir(), reason="the shared test data are not here")
@pytest.mark.parametrize(
    ("file", "leafy"),
    [
        ("truth/aspen/ortho_000.png", True),
        ("truth/birch/ortho_000.png", True),
        ("truth/maple_bare/ortho_000.png", False),
        ("truth/maple_bare/ortho_090.png", False),
        ("cutouts/crooked-tree2.png", False),
        ("cutouts/dry-slim-bush1.png", False),
        ("cutouts/horse-chestnut-tree.png", True),
        ("cutouts/palm-tree2.png", True),
        ("cutouts/purple-leaf-plum.png", True),
        ("cutouts/snowy-spruce.png", True),
    ],
)
@pytest.mark.parametrize("height", [1000, 300])
def test_known_trees_at_any_size(file, leafy, height):
    picture = np.asarray(Image.open(DATA / file).convert("RGBA"))
    scale = min(1.0, height / picture.shape[0])
    assert judge(cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)) == leafy


def test_no_views_and_no_tree_are_taken_for_leafy():
    assert judge_leafy([], [])
    matte, camera = view_of(drawn())
    assert judge_leafy([replace(matte, alpha=np.zeros_like(matte.alpha))], [camera])


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    shape=st.tuples(st.integers(1, 60), st.integers(2, 60)),
    fill=st.floats(0, 1),
    foot=st.floats(-10, 80),
)
def test_any_matte_is_judged(seed, shape, fill, foot):
    rng = np.random.default_rng(seed)
    alpha = np.where(rng.random(shape) < fill, rng.random(shape), 0).astype(np.float32)
    matte = Matte(alpha, rng.integers(0, 256, (*shape, 3), np.uint8), "automatic")
    assert judge_leafy([matte], [Camera(0.0, 0.1, (1.0, foot), shape[1], shape[0])]) in (True, False)
