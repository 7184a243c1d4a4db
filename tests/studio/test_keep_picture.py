"""Pictures from outside: whatever they are called, they lie where their content says."""

from __future__ import annotations

import io
from pathlib import PurePosixPath

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from flowtree.errors import InputError
from flowtree.params import PhotoParams
from flowtree.studio import keep_picture as module
from flowtree.studio.keep_picture import keep_picture, safe_name


def _png(size=(40, 30), **more):
    content = io.BytesIO()
    Image.new("RGB", size, "green").save(content, "PNG", **more)
    return content.getvalue()


def _upright(orientation):
    content, exif = io.BytesIO(), Image.Exif()
    exif[0x0112] = orientation
    Image.new("RGB", (40, 30)).save(content, "JPEG", exif=exif)
    return content.getvalue()


def test_a_picture_lies_where_its_content_says(tmp_path):
    kept = keep_picture(tmp_path, "photos", "../../My oak!.png", _png(), PhotoParams())
    assert kept.place.endswith("/My_oak_.png")
    assert (tmp_path / kept.place).read_bytes() == _png()
    assert (kept.width, kept.height) == (40, 30)
    assert keep_picture(tmp_path, "photos", "My oak!.png", _png(), PhotoParams()) == kept


def test_a_turned_photo_is_measured_upright(tmp_path):
    kept = keep_picture(tmp_path, "photos", "oak.jpg", _upright(6), PhotoParams())
    assert (kept.width, kept.height) == (30, 40)


@given(st.text(max_size=80))
def test_any_name_becomes_a_plain_one(name):
    safe = safe_name(name)
    assert safe
    assert PurePosixPath(safe).name == safe
    assert not safe.startswith(".")
    assert len(safe) <= 80
    assert not set(safe) & set('/\\\0\n:*?"<>|')


def test_what_is_too_large_or_no_picture_leaves_nothing(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="whole JPEG"):
        keep_picture(tmp_path, "photos", "oak.png", _png()[:40], PhotoParams())
    with pytest.raises(InputError, match=r"at most 0\.001 megapixels"):
        keep_picture(tmp_path, "photos", "oak.png", _png(), PhotoParams(max_megapixels=0.001))
    monkeypatch.setattr(module, "LARGEST", 10)
    with pytest.raises(InputError, match="must be under"):
        keep_picture(tmp_path, "photos", "oak.png", _png(), PhotoParams())
    assert not [file for file in tmp_path.rglob("*") if file.is_file()]
