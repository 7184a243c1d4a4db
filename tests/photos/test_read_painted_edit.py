import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image, ImageDraw

from flowtree.errors import InputError
from flowtree.model.photo import Photo
from flowtree.photos.read_painted_edit import read_painted_edit

PHOTO = Photo("tree.jpg", np.zeros((100, 200, 3), np.uint8), scale=0.5)  # the file had 400 x 200 pixels


def read(tmp_path, *layers):
    file = tmp_path / "paint.json"
    file.write_text(json.dumps({"layers": list(layers)}), encoding="utf-8")
    return read_painted_edit(file, PHOTO)


def test_picture_green_adds_red_erases_alpha_is_the_strength(tmp_path):
    picture = Image.new("RGBA", (800, 400))
    pen = ImageDraw.Draw(picture)
    pen.rectangle([0, 0, 399, 399], fill=(0, 255, 0, 128))
    pen.rectangle([400, 0, 799, 199], fill=(255, 0, 0, 255))
    pen.rectangle([400, 200, 799, 399], fill=(0, 0, 255, 255))
    picture.save(tmp_path / "paint.png")
    edit = read_painted_edit(tmp_path / "paint.png", PHOTO)
    assert edit.add.dtype == edit.erase.dtype == np.float32
    assert edit.add.shape == edit.erase.shape == (100, 200)
    assert np.allclose(edit.add[:, :99], 128 / 255)
    assert not edit.add[:, 101:].any()
    assert np.allclose(edit.erase[:49, 101:], 1.0)
    assert not edit.erase[51:].any()
    assert edit.directions == ()


def test_brush_is_soft_and_of_its_width(tmp_path):
    edit = read(tmp_path, {"kind": "add", "width": 40, "strength": 0.5, "points": [[100, 100], [300, 100]]})
    assert edit.erase is None
    column = edit.add[:, 100]
    assert column.max() == pytest.approx(0.5)
    assert column[50] == pytest.approx(0.5)
    reached = np.flatnonzero(column)
    assert 18 <= len(reached) <= 23  # 20 working pixels
    assert (np.diff(column[50:]) <= 0).all()


def test_layers_of_a_kind_unite(tmp_path):
    stroke = {"kind": "erase", "width": 40, "strength": 0.5, "points": [[100, 100]]}
    assert read(tmp_path, stroke, stroke).erase.max() == pytest.approx(0.75)


def test_directions_are_scaled(tmp_path):
    edit = read(tmp_path, {"kind": "direct", "width": 60, "points": [[100, 20], [120, 180]]})
    assert edit.add is None
    assert edit.directions[0].tolist() == [[50, 10], [60, 90]]
    assert edit.reach == (30.0,)


@pytest.mark.parametrize(
    ("layer", "rule"),
    [
        (3, "object"),
        ({"kind": "cut", "points": [[1, 1]]}, "kind"),
        ({"kind": "add", "points": []}, "points"),
        ({"kind": "add", "points": [[1, "a"]]}, "points"),
        ({"kind": "add", "points": [[1, float("nan")]]}, "points"),
        ({"kind": "add", "points": [[10**400, 1]]}, "points"),
        ({"kind": "add", "width": 0, "points": [[1, 1]]}, "width"),
        ({"kind": "add", "width": 1e6, "points": [[1, 1]]}, "width"),
        ({"kind": "add", "strength": 2, "points": [[1, 1]]}, "strength"),
        ({"kind": "direct", "points": [[1, 1], [1, 1]]}, "two different"),
        ({"kind": "erase", "points": [[500, 50], [600, 60]]}, "touch the photo"),
        ({"kind": "add", "strength": 0, "points": [[1, 1]]}, "something painted"),
    ],
)
def test_bad_layers_are_named(tmp_path, layer, rule):
    with pytest.raises(InputError, match=rule) as caught:
        read(tmp_path, layer)
    assert str(caught.value).startswith("paint.json")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"layers": 3}', "[" * 100_000])
def test_malformed_json_is_refused(tmp_path, text):
    file = tmp_path / "paint.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=r"paint\.json"):
        read_painted_edit(file, PHOTO)


def test_missing_files_empty_pictures_and_other_aspects_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_painted_edit(tmp_path / "none.json", PHOTO)
    Image.new("RGBA", (400, 200)).save(tmp_path / "empty.png")
    with pytest.raises(InputError, match="something painted"):
        read_painted_edit(tmp_path / "empty.png", PHOTO)
    Image.new("RGBA", (400, 400), (0, 255, 0, 99)).save(tmp_path / "square.png")
    with pytest.raises(InputError, match="aspect"):
        read_painted_edit(tmp_path / "square.png", PHOTO)


points = st.lists(st.lists(st.floats(-1e4, 1e4), min_size=2, max_size=2), min_size=1, max_size=4)
layer = st.fixed_dictionaries(
    {"kind": st.sampled_from(["add", "erase", "direct"]), "points": points},
    optional={"width": st.floats(-1, 300), "strength": st.floats(-0.2, 1.2)},
)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(layers=st.lists(layer, max_size=3))
def test_random_layers_give_an_edit_or_an_input_error(tmp_path, layers):
    try:
        edit = read(tmp_path, *layers)
    except InputError:
        return
    for painted in (edit.add, edit.erase):
        assert painted is None or (painted.dtype == np.float32 and 0 <= painted.min() <= painted.max() <= 1)
    assert len(edit.directions) == len(edit.reach)


def test_a_hard_brush_covers_fully_and_a_soft_one_fades(tmp_path):
    def dot(**more):
        return read(tmp_path, {"kind": "add", "width": 60, "points": [[200, 100]], **more}).add

    hard, middle, soft = (dot(softness=softness) for softness in (0.0, 0.5, 1.0))
    assert set(np.unique(hard)) == {0.0, 1.0}
    assert (hard >= middle).all()
    assert (middle >= soft).all()
    assert hard.sum() > middle.sum() > soft.sum() > 0
    assert (dot() == middle).all()


@pytest.mark.parametrize("softness", [-0.1, 1.5, "soft", True])
def test_a_softness_is_a_share(tmp_path, softness):
    with pytest.raises(InputError, match="needs a softness"):
        read(tmp_path, {"kind": "add", "softness": softness, "points": [[30, 30]]})
