"""Marks from a file: pixels of the original in, working pixels out, one clear line for what is wrong."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.model.photo import Photo
from flowtree.photos.read_marks import read_marks

PHOTO = Photo("tree.jpg", np.zeros((100, 200, 3), np.uint8), scale=0.5)  # the file has 400 x 200 pixels
STROKE = [[10, 20], [30, 40]]


def read(folder, content, photo=PHOTO):
    file = folder / "marks.json"
    file.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
    return read_marks(file, photo)


def test_every_mark_is_scaled_to_working_pixels(tmp_path):
    marks = read(
        tmp_path, {"foot": [200, 190.5], "top": 11, "fork": [203, 100], "seeds": [[0, 0], [399, 30]]}
    )
    assert marks.foot == (100.0, 95.25)
    assert marks.top == 5.5
    assert marks.fork == (101.5, 50.0)
    assert marks.seeds.tolist() == [[0.0, 0.0], [199.5, 15.0]]
    assert marks.seeds.dtype == np.float32


@pytest.mark.parametrize("content", [{"strokes": [{"points": STROKE}]}, [STROKE], {"strokes": [STROKE]}])
def test_a_file_of_strokes_alone_has_no_marks(tmp_path, content):
    marks = read(tmp_path, content)
    assert (marks.foot, marks.top, marks.fork) == (None, None, None)
    assert marks.seeds.shape == (0, 2)


def test_marks_may_stand_beside_strokes_and_be_null(tmp_path):
    marks = read(tmp_path, {"strokes": [STROKE], "top": 4, "foot": None, "seeds": []})
    assert marks.top == 2.0
    assert marks.foot is None


def test_a_byte_order_mark_is_no_fault(tmp_path):
    assert read(tmp_path, '\ufeff{"top": 8}').top == 4.0


def test_the_photos_edge_lies_inside_though_its_size_was_rounded(tmp_path):
    # 3000 x 2001 pixels scaled to 1024 x 683: 683 / scale is a hair under 2001.
    photo = Photo("wide.jpg", np.zeros((683, 1024, 3), np.uint8), scale=1024 / 3000)
    marks = read(tmp_path, {"foot": [3000, 2001], "top": 0}, photo)
    assert marks.foot == (1024.0, 683.0)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{", "must be JSON"),
        ("[" * 100_000, "must be JSON"),
        ("7", "must hold strokes or marks, but got int"),
        ("{}", "needs strokes or marks"),
        ("[]", "needs strokes or marks"),
        ({"strokes": [], "seeds": [], "foot": None}, "needs strokes or marks"),
        ({"strokes": [STROKE], "feet": [1, 2]}, "'feet'; did you mean 'foot'"),
        ({"foot": 7}, r"marks\.json, foot: must be a point \[x, y\], but got 7"),
        ({"foot": [1]}, "foot: must be a point"),
        ({"foot": [1, "2"]}, "foot: must be a point"),
        ({"foot": [True, 2]}, "foot: must be a point"),
        ({"foot": [1, 10**400]}, "foot: must be a point"),
        ('{"foot": [1, NaN]}', "foot: must be a point"),
        ({"foot": [401.5, 20]}, r"foot: must lie in the photo \(400 x 200\), but got \[401\.5, 20\.0\]"),
        ({"foot": [20, 1e300]}, "foot: must lie in the photo"),
        ({"top": [3]}, "top: must be a row"),
        ({"top": False}, "top: must be a row"),
        ({"top": -202}, "top: must lie in the photo"),
        ({"top": 202}, "top: must lie in the photo"),
        ({"fork": {"x": 1}}, "fork: must be a point"),
        ({"fork": [-9, 3]}, "fork: must lie in the photo"),
        ({"seeds": 3}, "seeds: must be points"),
        ({"seeds": [3, 4]}, "seeds: must be points .* but got 3"),
        ({"seeds": [[1, 2], [3]]}, r"seeds: must be points .* but got \[3\]"),
        ({"seeds": [[1, 2], [999, 3]]}, r"seeds: must lie in the photo .* but got \[999"),
        ({"foot": [50, 20], "top": 20}, "foot: must lie below the top, but got rows 20 and 20"),
        ({"foot": [50, 20], "fork": [50, 90]}, "foot: must lie below the fork"),
        ({"fork": [50, 20], "top": 90}, "fork: must lie below the top"),
    ],
)
def test_what_is_wrong_is_one_line_with_the_files_name(tmp_path, content, says):
    with pytest.raises(InputError, match=says) as caught:
        read(tmp_path, content)
    assert str(caught.value).startswith("marks.json")
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 250


def test_another_file_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"drawn\.svg: must end in \.json"):
        read_marks(tmp_path / "drawn.svg", PHOTO)
    with pytest.raises(InputError, match=r"none\.json: must be a file of marks, but got no such file"):
        read_marks(tmp_path / "none.json", PHOTO)


JUNK = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers(-(10**400), 10**400) | st.text(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(
            st.sampled_from(["strokes", "foot", "top", "fork", "seeds", "x"]), inner, max_size=4
        )
    ),
    max_leaves=12,
)
PAIR = st.lists(st.integers(-20, 420), min_size=2, max_size=2)


@settings(max_examples=25, deadline=None)
@given(
    content=JUNK
    | st.fixed_dictionaries(
        {},
        optional={
            "foot": PAIR,
            "top": st.integers(-9, 209),
            "fork": PAIR,
            "seeds": st.lists(PAIR, max_size=4),
            "roll": st.floats(-50, 50),
            "distance": st.floats(allow_nan=True),
            "focal_length": st.integers(-5, 10**9),
        },
    )
)
def test_any_json_is_marks_inside_the_picture_or_an_input_error(tmp_path_factory, content):
    try:
        marks = read(tmp_path_factory.mktemp("junk"), content)
    except InputError:
        return
    points = [marks.fork or (0, 0), *marks.seeds]
    assert (np.array(points) >= 0).all()
    assert (np.array(points) <= (200, 100)).all()
    if marks.foot is not None:  # a frame may cut off the foot, and the top
        assert 0 <= marks.foot[0] <= 200
        assert 0 <= marks.foot[1] <= 200
    assert -100 <= (marks.top or 0) <= 100
