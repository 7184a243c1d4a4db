import json

import numpy as np
import pytest
from PIL import Image, ImageDraw

from flowtree.attraction.read_sketch import read_sketch
from flowtree.errors import InputError


def test_a_drawing_keeps_its_own_units(tmp_path):
    (tmp_path / "a.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="-10 -20 40 60"><path d="M-5 30 L 5 -10"/></svg>'
    )
    (tmp_path / "a.json").write_text(json.dumps([[[-5, 30], [5, -10]], [[1, 1], [1, 1]]]))
    for name in ("a.svg", "a.json"):
        (line,) = read_sketch(tmp_path / name)
        assert np.allclose(line[[0, -1]], [[-5, 30], [5, -10]])
        assert line.dtype == np.float32


def test_a_picture_of_any_aspect(tmp_path):
    picture = Image.new("RGB", (60, 300), "white")
    ImageDraw.Draw(picture).line([(30, 290), (30, 10)], fill="black", width=3)
    picture.save(tmp_path / "a.png")
    (line,) = read_sketch(tmp_path / "a.png")
    assert np.ptp(line[:, 1]) == pytest.approx(280, abs=6)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.json", '{"strokes": [], "foot": [1, 2]}', "needs at least one stroke"),
        ("a.json", "[[[1, 1], [1, 1]]]", "needs at least one stroke"),
        ("a.json", "7", "must hold a list of strokes"),
        ("a.svg", "<svg", "must be an SVG drawing"),
        ("a.bmp", "", "must end in .svg"),
    ],
)
def test_bad_files_get_one_clear_line(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=message):
        read_sketch(tmp_path / name)
    with pytest.raises(InputError, match="no such file"):
        read_sketch(tmp_path / "none.svg")
