import struct
import zlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.errors import InputError
from flowtree.params import PhotoParams
from flowtree.photos.load_photo import load_photo
from flowtree.photos.mirror_photo import mirror_photo


def gradient(height=40, width=60):
    rows, columns = np.mgrid[:height, :width]
    return np.dstack([rows * 6 % 256, columns * 4 % 256, (rows + columns) % 256]).astype(np.uint8)


@pytest.mark.parametrize("ending", ["png", "tif", "webp"])
def test_lossless_files_keep_every_pixel(tmp_path, ending):
    pixels = gradient()
    Image.fromarray(pixels).save(tmp_path / f"a.{ending}", **({"lossless": True} if ending == "webp" else {}))
    photo = load_photo(tmp_path / f"a.{ending}")
    assert np.array_equal(photo.rgb, pixels)
    assert photo.alpha is None
    assert photo.scale == 1.0
    assert photo.name == f"a.{ending}"


def test_jpeg_is_read(tmp_path):
    Image.fromarray(gradient()).save(tmp_path / "a.jpg", quality=98)
    assert np.abs(load_photo(tmp_path / "a.jpg").rgb.astype(int) - gradient()).mean() < 4


@pytest.mark.parametrize("mode", ["L", "P", "1", "CMYK", "I;16", "LA", "RGBA", "F"])
def test_every_mode_becomes_rgb(tmp_path, mode):
    grey = gradient()[..., 1]
    if mode == "I;16":
        image = Image.fromarray(grey.astype(np.uint16) * 257)
    elif mode == "F":
        image = Image.fromarray(grey.astype(np.float32) / 255)
    else:
        image = Image.fromarray(grey).convert("L" if mode == "1" else "RGB").convert(mode)
    name = tmp_path / ("a.tif" if mode in {"F", "CMYK"} else "a.png")
    image.save(name)
    photo = load_photo(name)
    assert photo.rgb.shape == (40, 60, 3)
    assert photo.rgb.dtype == np.uint8
    assert photo.alpha is None  # an opaque alpha says nothing
    if mode in {"L", "I;16", "F", "LA"}:
        assert np.abs(photo.rgb[..., 0].astype(int) - grey).max() <= 1


def test_alpha_is_kept_and_scaled_with_its_colours(tmp_path):
    pixels = np.zeros((64, 64, 4), np.uint8)
    pixels[:, :31] = (200, 100, 50, 255)  # beside it transparent black, which must not bleed in
    Image.fromarray(pixels).save(tmp_path / "a.png")
    photo = load_photo(tmp_path / "a.png", params=PhotoParams(working_height=64))
    assert photo.alpha is not None
    assert photo.alpha[:, :31].min() == 1.0
    Image.fromarray(np.repeat(np.repeat(pixels, 4, 0), 4, 1)).save(tmp_path / "b.png")
    small = load_photo(tmp_path / "b.png", params=PhotoParams(working_height=96))
    assert small.rgb.shape == (96, 96, 3)
    assert small.scale == pytest.approx(96 / 256)
    seen = small.alpha > 0.05
    assert np.abs(small.rgb[seen].astype(int) - (200, 100, 50)).max() <= 3
    assert small.alpha.mean() == pytest.approx(31 / 64, abs=0.01)


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation_is_undone(tmp_path, orientation):
    upright = Image.fromarray(gradient(40, 60))
    undo = {2: 0, 3: 3, 4: 1, 5: 5, 6: 2, 7: 6, 8: 4}  # Pillow's transposes that turn upright into stored
    stored = upright.transpose(Image.Transpose(undo[orientation])) if orientation > 1 else upright
    exif = Image.Exif()
    exif[0x0112] = orientation
    stored.save(tmp_path / "a.png", exif=exif)
    assert np.array_equal(load_photo(tmp_path / "a.png").rgb, gradient(40, 60))


def test_never_scaled_up_and_larger_side_fits(tmp_path):
    Image.fromarray(gradient(90, 300)).save(tmp_path / "a.png")
    assert load_photo(tmp_path / "a.png").rgb.shape == (90, 300, 3)
    assert load_photo(tmp_path / "a.png", params=PhotoParams(working_height=100)).rgb.shape == (30, 100, 3)
    Image.fromarray(np.full((3000, 2000, 3), 77, np.uint8)).save(tmp_path / "b.jpg")
    big = load_photo(tmp_path / "b.jpg", params=PhotoParams(working_height=300))
    assert big.rgb.shape == (300, 200, 3)
    assert big.scale == pytest.approx(0.1)
    assert np.abs(big.rgb.astype(int) - 77).max() <= 1


def png_header(width, height):
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
        + chunk(b"IDAT", b"")
    )


def test_a_huge_header_is_refused_before_decoding(tmp_path):
    before = Image.MAX_IMAGE_PIXELS
    (tmp_path / "bomb.png").write_bytes(png_header(60_000, 60_000))
    with pytest.raises(InputError, match="megapixels, but got 60000 x 60000"):
        load_photo(tmp_path / "bomb.png")
    assert before == Image.MAX_IMAGE_PIXELS


def test_bad_files_give_one_line(tmp_path):
    whole = tmp_path / "whole.jpg"
    Image.fromarray(gradient(200, 200)).save(whole)
    (tmp_path / "cut.jpg").write_bytes(whole.read_bytes()[:900])
    (tmp_path / "text.jpg").write_text("not a picture")
    (tmp_path / "empty.png").write_bytes(b"")
    Image.fromarray(gradient(1, 1)).save(tmp_path / "dot.png")
    Image.fromarray(gradient(16, 9000)).save(tmp_path / "strip.png")
    for name in ("cut.jpg", "text.jpg", "empty.png", "dot.png", "strip.png", "missing.png", ""):
        with pytest.raises(InputError) as caught:
            load_photo(tmp_path / name)
        assert "\n" not in str(caught.value)
        assert str(caught.value).count("but got") == 1


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_damaged_files_either_load_or_give_an_input_error(tmp_path_factory, data):
    folder = tmp_path_factory.mktemp("damaged")
    ending = data.draw(st.sampled_from(["png", "jpg", "tif", "webp"]))
    Image.fromarray(gradient()).save(folder / f"a.{ending}")
    raw = bytearray((folder / f"a.{ending}").read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    end = data.draw(st.integers(1, len(raw)))
    (folder / f"a.{ending}").write_bytes(raw[:end])
    try:
        photo = load_photo(folder / f"a.{ending}")
    except InputError:
        return
    assert photo.rgb.ndim == 3


def test_mirroring_twice_gives_the_same_pixels(tmp_path):
    pixels = np.dstack([gradient(), gradient()[..., 0]])
    Image.fromarray(pixels).save(tmp_path / "a.png")
    photo = load_photo(tmp_path / "a.png")
    once = mirror_photo(photo)
    assert np.array_equal(once.rgb[:, ::-1], photo.rgb)
    assert once.name != photo.name
    twice = mirror_photo(once)
    assert np.array_equal(twice.rgb, photo.rgb)
    assert np.array_equal(twice.alpha, photo.alpha)
