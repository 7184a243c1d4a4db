import numpy as np
import pytest
from PIL import Image

from flowtree.errors import InputError
from flowtree.meshing.load_bark import load_bark


def test_a_picture_is_taken_as_it_is(tmp_path):
    pixels = np.random.default_rng(0).integers(0, 255, (20, 30, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "bark.png")
    assert np.array_equal(load_bark(tmp_path / "bark.png").base_color, pixels)
    assert np.array_equal(load_bark(str(tmp_path / "bark.png")).base_color, pixels)


@pytest.mark.parametrize("mode", ["L", "RGBA", "P", "1", "CMYK", "I;16"])
def test_every_mode_becomes_colour(tmp_path, mode):
    Image.new(mode, (16, 16)).save(tmp_path / "bark.tif")
    assert load_bark(tmp_path / "bark.tif").base_color.shape == (16, 16, 3)


def test_a_large_picture_is_scaled_down(tmp_path):
    Image.new("RGB", (4096, 100), (90, 80, 70)).save(tmp_path / "bark.png")
    assert load_bark(tmp_path / "bark.png").base_color.shape == (50, 2048, 3)


def test_what_is_no_picture_gets_one_clear_line(tmp_path):
    (tmp_path / "text.png").write_text("not a picture")
    whole = tmp_path / "whole.png"
    Image.fromarray(np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)).save(whole)
    (tmp_path / "cut.png").write_bytes(whole.read_bytes()[:3000])
    Image.new("RGB", (3, 40)).save(tmp_path / "tiny.png")
    names = {
        "text.png": "picture of bark",
        "cut.png": "picture of bark",
        "none.png": "picture of bark",
        "tiny.png": "8 x 8",
    }
    for name, message in names.items():
        with pytest.raises(InputError, match=f"{name}: must be .*{message}") as caught:
            load_bark(tmp_path / name)
        assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="must be a picture of bark"):
        load_bark(tmp_path)
