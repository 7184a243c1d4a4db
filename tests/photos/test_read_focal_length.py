"""The focal length from EXIF: in working pixels, upright or turned, and never nonsense."""

import math

import numpy as np
import pytest
from PIL import Image

from flowtree.params import PhotoParams
from flowtree.photos.load_photo import load_photo
from flowtree.photos.read_focal_length import FILM_DIAGONAL, read_focal_length

ON_FILM, FOCAL, PER_UNIT, UNIT = 0xA405, 0x920A, 0xA20E, 0xA210


def save(file, tags, size=(400, 300), orientation=1):
    exif = Image.Exif()
    exif[0x0112] = orientation
    exif.get_ifd(0x8769).update(tags)
    Image.fromarray(np.zeros((size[1], size[0], 3), np.uint8)).save(file, exif=exif)
    return file


@pytest.mark.parametrize("orientation", [1, 6])
def test_the_length_on_film_is_compared_by_diagonals(tmp_path, orientation):
    file = save(tmp_path / "a.jpg", {ON_FILM: 26}, orientation=orientation)
    assert load_photo(file).focal_length == pytest.approx(26 / FILM_DIAGONAL * 500)
    small = load_photo(file, params=PhotoParams(working_height=200))
    assert small.focal_length == pytest.approx(26 / FILM_DIAGONAL * 250)


def test_length_and_sensor_give_pixels(tmp_path):
    tags = {FOCAL: 5.0, PER_UNIT: 100.0, UNIT: 4}
    assert load_photo(save(tmp_path / "a.jpg", tags)).focal_length == pytest.approx(500.0)


@pytest.mark.parametrize(
    "tags", [{}, {FOCAL: 5.0}, {ON_FILM: 0}, {ON_FILM: 60000}, {FOCAL: 5.0, PER_UNIT: 0.001}, {ON_FILM: "x"}]
)
def test_nothing_or_nonsense_is_none(tags):
    class Exif:
        def get_ifd(self, _):
            return tags

    assert read_focal_length(Exif(), 400, 300) is None


def test_damaged_metadata_and_numbers_do_no_harm():
    class Broken:
        def get_ifd(self, _):
            raise OSError("truncated")

    class Odd:
        def get_ifd(self, _):
            return {ON_FILM: math.nan, FOCAL: object(), PER_UNIT: math.inf}

    assert read_focal_length(Broken(), 400, 300) is None
    assert read_focal_length(Odd(), 400, 300) is None
