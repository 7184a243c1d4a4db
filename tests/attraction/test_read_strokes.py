import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image, ImageDraw

from flowtree.attraction.read_strokes import read_strokes
from flowtree.errors import InputError
from flowtree.model.photo import Photo

PHOTO = Photo("tree.jpg", np.zeros((100, 200, 3), np.uint8), scale=0.5)  # the file had 400 x 200 pixels


def svg(body, attributes=""):
    return f'<svg xmlns="http://www.w3.org/2000/svg" {attributes}>{body}</svg>'


def read(tmp_path, text, name="strokes.svg"):
    file = tmp_path / name
    file.write_text(text, encoding="utf-8")
    return read_strokes(file, PHOTO)


def test_svg_without_a_view_box_is_in_pixels_of_the_original(tmp_path):
    body = '<path d="M10 20 L30 40"/><polyline points="1,2 3,4 5,6"/><line x1="0" y1="0" x2="8px" y2="6"/>'
    path, polyline, line = read(tmp_path, svg(body))
    assert path.dtype == np.float32
    assert path.tolist() == [[5, 10], [15, 20]]
    assert polyline.tolist() == [[0.5, 1], [1.5, 2], [2.5, 3]]
    assert line.tolist() == [[0, 0], [4, 3]]


def test_view_box_is_mapped_to_the_picture(tmp_path):
    (line,) = read(tmp_path, svg('<path d="M100 100 L110 105"/>', 'viewBox="100 100 10 5"'))
    assert line.tolist() == [[0, 0], [200, 100]]


def test_transforms_nest(tmp_path):
    body = (
        '<g transform="translate(10 20)"><g transform="scale(2) rotate(90)"><path d="M0 0 L10 0"/></g>'
        '<path transform="matrix(1 0 0 1 5 5)" d="M0 0 h2"/></g>'
    )
    first, second = read(tmp_path, svg(body))
    assert np.allclose(first, [[5, 10], [5, 20]], atol=1e-5)
    assert np.allclose(second, [[7.5, 12.5], [8.5, 12.5]])


def test_definitions_are_not_drawn(tmp_path):
    body = '<defs><path d="M0 0 L9 9"/></defs><!-- note --><path d="M0 0 L2 2"/>'
    assert len(read(tmp_path, svg(body))) == 1


def test_both_kinds_of_json(tmp_path):
    points = [[10, 20], [30, 40.5]]
    (a,) = read(tmp_path, json.dumps({"strokes": [{"points": points}]}), "a.json")
    (b,) = read(tmp_path, json.dumps([points]), "b.json")
    assert a.tolist() == b.tolist() == [[5, 10], [15, 20.25]]


@pytest.mark.parametrize(
    "content",
    [{"foot": [1, 2]}, {"strokes": [], "top": 3}, {"strokes": None, "seeds": [[1, 2]]}, {"fork": "wrong"}],
)
def test_json_of_marks_alone_has_no_strokes(tmp_path, content):
    assert read(tmp_path, json.dumps(content), "a.json") == ()


def test_marks_beside_strokes_change_nothing(tmp_path):
    content = {"strokes": [{"points": [[10, 20], [30, 40]]}], "foot": [9, 9]}
    (line,) = read(tmp_path, json.dumps(content), "a.json")
    assert line.tolist() == [[5, 10], [15, 20]]


@pytest.mark.parametrize("ground", [(255, 255, 255, 255), (0, 0, 0, 0)])
def test_png_becomes_the_lines_that_were_drawn(tmp_path, ground):
    picture = Image.new("RGBA", (400, 200), ground)
    pen = ImageDraw.Draw(picture)
    pen.line([(200, 190), (200, 100)], fill=(200, 0, 0, 255), width=5)
    pen.line([(200, 100), (100, 20)], fill=(200, 0, 0, 255), width=5)
    pen.line([(200, 100), (300, 20)], fill=(200, 0, 0, 255), width=5)
    picture.save(tmp_path / "drawn.png")
    lines = read_strokes(tmp_path / "drawn.png", PHOTO)
    assert len(lines) == 3
    ends = np.concatenate([line[[0, -1]] for line in lines])
    for place in ([100, 95], [50, 10], [150, 10]):
        assert np.linalg.norm(ends - place, axis=1).min() < 3
    fork = [100, 50]
    assert all(np.linalg.norm(line - fork, axis=1).min() < 3 for line in lines)
    # Lines that meet at a fork meet exactly: that is how they join again.
    assert (np.linalg.norm(ends[:, None] - ends[None], axis=2) < 1e-6).sum() >= 6 + 6


def test_a_ring_is_closed(tmp_path):
    picture = Image.new("RGBA", (400, 200))
    ImageDraw.Draw(picture).ellipse([150, 50, 250, 150], outline=(0, 0, 0, 255), width=3)
    picture.save(tmp_path / "ring.png")
    lines = read_strokes(tmp_path / "ring.png", PHOTO)
    assert sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines) == pytest.approx(
        np.pi * 49, rel=0.1
    )


BOMB = '<!DOCTYPE svg [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><svg><text>&b;</text></svg>'


@pytest.mark.parametrize(
    ("name", "text", "rule"),
    [
        ("a.svg", "", "malformed XML"),
        ("a.svg", "<svg", "malformed XML"),
        ("a.svg", "<html/>", "outermost"),
        ("a.svg", BOMB, "DOCTYPE"),
        ("a.svg", svg('<path d="M0 0 L1"/>'), "needs 2 numbers"),
        ("a.svg", svg('<path d="M0 0 L1 1"/>', 'viewBox="0 0 0 5"'), "viewBox"),
        ("a.svg", svg('<path transform="spin(3)" d="M0 0 L1 1"/>'), "transform"),
        ("a.svg", svg('<polyline points="1 2 3"/>'), "no pairs"),
        ("a.svg", svg("<rect/>"), "at least one stroke"),
        ("a.svg", svg('<path d="M500 500 L600 600"/>'), "touch the photo"),
        ("a.json", "{", "JSON"),
        ("a.json", "[" * 100_000, "JSON"),
        ("a.json", "{}", "list of strokes"),
        ("a.json", "[]", "at least one stroke"),
        ("a.json", '{"foot": null, "seeds": []}', "list of strokes"),
        ("a.json", '{"strokes": [], "seeds": []}', "at least one stroke"),
        ("a.json", '{"strokes": 3, "foot": [1, 2]}', "list of strokes"),
        ("a.json", "[[[1, 2]]]", "two points"),
        ("a.json", "[[[1, 2], [NaN, 3]]]", "two points"),
        ("a.json", "[[[1, 2], [1" + "0" * 400 + ", 3]]]", "two points"),
        ("a.json", "[[[1, 2], [1, 2]]]", "at least one stroke"),
        ("a.json", "[[[-9, -9], [-1, -1]]]", "touch the photo"),
        ("a.txt", "", "must end in"),
        ("a.png", "no picture", "PNG"),
    ],
)
def test_bad_files_are_named_in_one_line(tmp_path, name, text, rule):
    with pytest.raises(InputError, match=rule) as caught:
        read(tmp_path, text, name)
    assert str(caught.value).startswith(name)
    assert "\n" not in str(caught.value)


def test_a_missing_file_a_photo_and_another_aspect_are_refused(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        read_strokes(tmp_path / "none.svg", PHOTO)
    Image.new("RGB", (400, 200), (90, 90, 90)).save(tmp_path / "full.png")
    with pytest.raises(InputError, match="thin lines"):
        read_strokes(tmp_path / "full.png", PHOTO)
    Image.new("RGBA", (400, 400)).save(tmp_path / "square.png")
    with pytest.raises(InputError, match="aspect"):
        read_strokes(tmp_path / "square.png", PHOTO)
    Image.new("RGBA", (400, 200)).save(tmp_path / "empty.png")
    with pytest.raises(InputError, match="at least one stroke"):
        read_strokes(tmp_path / "empty.png", PHOTO)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=st.text(max_size=60), name=st.sampled_from(["a.svg", "a.json", "a.png"]))
def test_random_files_never_raise_anything_else(tmp_path, text, name):
    file = tmp_path / name
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    with pytest.raises(InputError):
        read_strokes(file, PHOTO)


def test_a_png_that_would_fill_the_memory_is_refused_whatever_pillow_is_set_to(tmp_path, monkeypatch):
    file = tmp_path / "huge.png"
    Image.new("RGBA", (4, 4)).save(file)
    data = bytearray(file.read_bytes())
    data[16:24] = (20_000).to_bytes(4, "big") * 2
    file.write_bytes(data)
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", None)  # as another thread may have it for a moment
    with pytest.raises(InputError, match="at most 89 megapixels, but got 20000 x 20000"):
        read_strokes(file, PHOTO)


def test_a_brush_has_its_width_in_working_pixels(tmp_path):
    file = tmp_path / "strokes.json"
    points = [[40, 20], [40, 100]]
    file.write_text(json.dumps({"strokes": [{"points": points, "width": 10}, {"points": points}]}))
    brush, pen = read_strokes(file, PHOTO)
    assert brush.shape == (2, 3)
    assert (brush[:, 2] == np.float32(10 * PHOTO.scale)).all()
    assert (brush[:, :2] == pen).all()
    for width in (0, -1, "wide", True):
        file.write_text(json.dumps({"strokes": [{"points": points, "width": width}]}))
        with pytest.raises(InputError, match="needs a width"):
            read_strokes(file, PHOTO)
