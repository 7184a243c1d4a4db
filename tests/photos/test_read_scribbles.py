import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.errors import InputError
from flowtree.model.photo import Photo
from flowtree.photos.read_scribbles import read_scribbles

PHOTO = Photo("tree.jpg", np.zeros((60, 40, 3), np.uint8), scale=0.5)  # the file has 120 x 80 pixels
COLOURS = {
    (0, 255, 0): 1,
    (255, 255, 255): 1,
    (255, 0, 0): 2,
    (0, 0, 0): 2,
    (0, 0, 255): 3,
    (128, 128, 128): 0,
}


def write(path, strokes):
    path.write_text(json.dumps({"strokes": strokes}))
    return path


def test_colours_of_a_transparent_layer(tmp_path):
    layer = np.zeros((60, 40, 4), np.uint8)
    for k, colour in enumerate(COLOURS):
        layer[8 * k : 8 * k + 4] = (*colour, 255)
    Image.fromarray(layer).save(tmp_path / "s.png")
    labels = read_scribbles(tmp_path / "s.png", PHOTO)
    for k, label in enumerate(COLOURS.values()):
        assert (labels[8 * k : 8 * k + 4] == label).all()
    assert not labels[8 * len(COLOURS) :].any()


def test_a_grey_canvas_says_nothing_and_fine_strokes_survive_scaling(tmp_path):
    canvas = np.full((480, 320, 3), 128, np.uint8)
    canvas[:, 100] = (0, 255, 0)  # an eighth of a pixel of the photo
    Image.fromarray(canvas).save(tmp_path / "s.png")
    labels = read_scribbles(tmp_path / "s.png", PHOTO)
    assert (labels[:, 12] == 1).all()
    assert labels.sum() == 60


def test_json_is_in_pixels_of_the_original(tmp_path):
    file = write(
        tmp_path / "s.json",
        [
            {"label": "tree", "width": 8, "points": [[40, 20], [40, 100]]},
            {"label": "background", "width": 8, "points": [[0, 110], [300, 110]]},
            {"label": "unknown", "width": 2, "points": [[10, 10]]},
            {"label": "occluder", "width": 2, "points": [[60, 60]]},
        ],
    )
    labels = read_scribbles(file, PHOTO)
    assert labels[30, 20] == 1
    assert labels[55, 35] == 2
    assert labels[30, 30] == 3
    assert labels[5, 5] == 4
    assert labels[30, 5] == 0
    assert 3 <= (labels[30] == 1).sum() <= 6


@pytest.mark.parametrize("place", [[40, 20], [0, 0], [80, 120], [79.9, 0.1]])
@pytest.mark.parametrize("width", [0.01, 1, 2, 3])
def test_one_point_is_a_dot_of_any_width(tmp_path, place, width):
    file = write(tmp_path / "s.json", [{"label": "tree", "width": width, "points": [place]}])
    rows, columns = np.nonzero(read_scribbles(file, PHOTO))
    assert 1 <= len(rows) <= 9
    assert np.abs(rows + 0.5 - place[1] / 2).max() <= 1.5
    assert np.abs(columns + 0.5 - place[0] / 2).max() <= 1.5


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("{", "must be JSON"),
        ("[" * 100_000, "must be JSON"),
        ("[]", 'a list "strokes"'),
        ('{"strokes": []}', "at least one stroke"),
        ('{"strokes": [3]}', "must be an object"),
        ('{"strokes": [{"label": "leaf", "points": [[1, 2]]}]}', "needs a label"),
        ('{"strokes": [{"label": ["tree"], "points": [[1, 2]]}]}', "needs a label"),
        ('{"strokes": [{"label": "tree", "width": -1, "points": [[1, 2]]}]}', "needs a width"),
        ('{"strokes": [{"label": "tree", "width": true, "points": [[1, 2]]}]}', "needs a width"),
        ('{"strokes": [{"label": "tree", "points": []}]}', "needs points"),
        ('{"strokes": [{"label": "tree", "points": [[1, NaN]]}]}', "needs points"),
        ('{"strokes": [{"label": "tree", "points": [[1, 2, 3]]}]}', "needs points"),
        ('{"strokes": [{"label": "tree", "points": [[1, 1' + "0" * 400 + "]]}]}", "needs points"),
        (
            '{"strokes": [{"label": "tree", "width": 1' + "0" * 400 + ', "points": [[1, 2]]}]}',
            "needs a width",
        ),
        ('{"strokes": [{"label": "tree", "points": [[1' + "0" * 300 + ", 2]]}]}", "must touch the photo"),
        ('{"strokes": [{"label": "tree", "points": [[500, 2], [600, 9]]}]}', "must touch the photo"),
        ('{"strokes": [{"label": "tree", "points": [[1e300, 2]]}]}', "must touch the photo"),
    ],
)
def test_malformed_json_gives_one_line(tmp_path, text, says):
    (tmp_path / "s.json").write_text(text)
    with pytest.raises(InputError, match=says) as caught:
        read_scribbles(tmp_path / "s.json", PHOTO)
    assert "\n" not in str(caught.value)


def test_bad_pictures_are_refused(tmp_path):
    Image.fromarray(np.zeros((40, 60, 3), np.uint8)).save(tmp_path / "wide.png")
    with pytest.raises(InputError, match="aspect"):
        read_scribbles(tmp_path / "wide.png", PHOTO)
    Image.fromarray(np.full((60, 40, 3), (200, 180, 40), np.uint8)).save(tmp_path / "photo.png")
    with pytest.raises(InputError, match="mostly other colours"):
        read_scribbles(tmp_path / "photo.png", PHOTO)
    Image.fromarray(np.zeros((60, 40, 4), np.uint8)).save(tmp_path / "blank.png")
    with pytest.raises(InputError, match="at least one stroke"):
        read_scribbles(tmp_path / "blank.png", PHOTO)


JUNK = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers(-(10**400), 10**400) | st.text(max_size=4),
    lambda inner: (
        st.lists(inner, max_size=3)
        | st.dictionaries(st.sampled_from(["label", "width", "points", "strokes", "x"]), inner, max_size=4)
    ),
    max_leaves=12,
)


@settings(max_examples=25, deadline=None)
@given(content=JUNK | st.builds(lambda inner: {"strokes": [{"label": "tree", "points": inner}]}, JUNK))
def test_any_json_is_labels_or_an_input_error(tmp_path_factory, content):
    file = tmp_path_factory.mktemp("junk") / "s.json"
    file.write_text(json.dumps(content))
    try:
        labels = read_scribbles(file, PHOTO)
    except InputError:
        return
    assert labels.shape == (60, 40)
    assert labels.max() <= 3
