"""The contact sheet, and pictures as files."""

from __future__ import annotations

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.errors import InputError, OutputError
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.params import RenderParams
from flowtree.render.render_sheet import render_sheet
from flowtree.render.write_picture import write_picture
from tests.trees import hand_made_tree

_GRAPH = AttractorGraph(np.array([-1, 0, 1], np.int32), np.array([[0, 0], [0, 1], [1, 2]], np.float32))


def _view(yaw, width=70, height=90, box=None):
    rgb = np.full((height, width, 3), 200, np.uint8)
    alpha = np.zeros((height, width), np.float32)
    alpha[10:80, 20:50] = 1.0
    if box is not None:
        alpha[:] = box
    return (
        Photo(f"photo_{yaw}.jpg", rgb),
        Matte(alpha, rgb, "automatic"),
        Camera(yaw, 0.06, (35.0, 80.0), width, height),
    )


@pytest.mark.parametrize("alpha", [None, 0.0, 1.0])
def test_holds_a_row_for_each_view_and_a_free_view(alpha):
    views = [_view(0.0, box=alpha), _view(90.0, width=110)]
    photos, mattes, cameras = zip(*views, strict=True)
    small = RenderParams(size=96, samples=1)
    one = render_sheet(photos[:1], mattes[:1], cameras[:1], [None], hand_made_tree(20), params=small)
    two = render_sheet(
        photos, mattes, cameras, [_GRAPH, None], hand_made_tree(20), scores=[0.5, 1.0], params=small
    )
    assert one.dtype == two.dtype == np.uint8
    assert one.shape[1:] == two.shape[1:] == (200, 3)
    assert two.shape[0] > one.shape[0]


def test_the_default_sheet_is_large_enough_to_read_and_small_enough_to_show():
    photo, matte, camera = _view(0.0)
    sheet = render_sheet(
        [photo], [matte], [camera], [None], hand_made_tree(2), params=RenderParams(samples=1)
    )
    assert sheet.shape[1] == 1600
    assert sheet.shape[0] < 1600


def test_lists_that_do_not_fit_are_refused():
    photo, matte, camera = _view(0.0)
    tree = hand_made_tree(2)
    for graphs, scores in (([], None), ([None], []), ([None], [0.5, 0.5])):
        with pytest.raises(InputError, match="equally many"):
            render_sheet([photo], [matte], [camera], graphs, tree, scores=scores)
    with pytest.raises(InputError, match="matte of its size"):
        render_sheet([photo], [_view(0.0, width=30)[1]], [camera], [None], tree)


@settings(max_examples=20, deadline=None)
@given(
    shape=st.sampled_from([(), (3,), (4,)]),
    rows=st.integers(1, 9),
    columns=st.integers(1, 9),
    seed=st.integers(0, 99),
)
def test_a_png_comes_back_as_it_was(tmp_path_factory, shape, rows, columns, seed):
    pixels = np.random.default_rng(seed).integers(0, 256, (rows, columns, *shape)).astype(np.uint8)
    path = tmp_path_factory.mktemp("pictures") / "a.png"
    write_picture(pixels, path)
    with Image.open(path) as picture:
        assert (np.asarray(picture) == pixels).all()


def test_a_jpeg_lies_on_white(tmp_path):
    clear = np.zeros((16, 16, 4), np.uint8)
    write_picture(clear, tmp_path / "a.jpg", quality=95)
    with Image.open(tmp_path / "a.jpg") as picture:
        assert np.asarray(picture).min() > 250


def test_bad_pictures_and_places_are_refused(tmp_path):
    pixels = np.zeros((4, 4, 3), np.uint8)
    with pytest.raises(InputError, match="must end in"):
        write_picture(pixels, tmp_path / "a.gif")
    for wrong in (pixels.astype(float), pixels[:, :, :2], pixels[:0], pixels[0, 0]):
        with pytest.raises(InputError, match="uint8"):
            write_picture(wrong, tmp_path / "a.png")
    old = tmp_path / "old.png"
    old.write_bytes(b"old")
    with pytest.raises(InputError):
        write_picture(pixels.astype(float), old)
    assert old.read_bytes() == b"old"
    with pytest.raises(OutputError, match="could not be written"):
        write_picture(pixels, tmp_path / "missing" / "a.png")
    assert os.listdir(tmp_path) == ["old.png"]
