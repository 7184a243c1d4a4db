"""A photograph is opened at full size only where its trunk is worth it, the widest trunk first."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from PIL import Image

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.model.skeleton import Skeleton
from flowtree.params import PhotoParams
from flowtree.pipeline.cut_trunk import cut_trunk

CAMERA = Camera(0.0, 0.03, (40.0, 250.0), 80, 256)
RADIUS, SCALE = 0.35, 1 / 8


def stem():
    count = 12
    points = np.zeros((count, 3), np.float32)
    points[:, 1] = np.linspace(0, 7, count)
    return Skeleton(
        parent=np.arange(-1, count - 1, dtype=np.int32),
        points=points,
        radius=np.full(count, RADIUS, np.float32),
        particles=np.ones(count, np.int32),
        level=np.zeros(count, np.int32),
        twig=np.zeros(count, bool),
    )


@pytest.fixture
def view(tmp_path):
    """A photograph of a mottled pole, and the same as it was read, an eighth as large."""
    high, wide = int(CAMERA.height / SCALE), int(CAMERA.width / SCALE)
    rows, columns = np.mgrid[:high, :wide].astype(np.float32) + 0.5
    right = (columns * SCALE - CAMERA.foot[0]) * CAMERA.metres_per_pixel
    up = (CAMERA.foot[1] - rows * SCALE) * CAMERA.metres_per_pixel
    there = (np.abs(right) < RADIUS) & (up > 0) & (up < 7)
    noise = np.random.default_rng(0).integers(70, 180, (high, wide, 1))
    mottled = cv2.GaussianBlur(noise.astype(np.uint8), (0, 0), 0.7)[..., None]
    rgb = np.where(there[..., None], mottled + np.array([20, 8, 0]), 235).astype(np.uint8)
    Image.fromarray(rgb).save(tmp_path / "pole.png")
    size = (CAMERA.width, CAMERA.height)
    small = cv2.resize(rgb, size, interpolation=cv2.INTER_AREA)
    alpha = cv2.resize(there.astype(np.float32), size, interpolation=cv2.INTER_AREA)
    photo = Photo("pole.png", small, scale=SCALE)
    return tmp_path / "pole.png", photo, Placement(CAMERA), Matte(alpha, small, "trimap"), CAMERA


def cut(*views, mirrored=None):
    sources, photos, placements, mattes, cameras = zip(*views, strict=True)
    flags = mirrored or (False,) * len(views)
    arguments = (sources, photos, placements, mattes, cameras, flags)
    return cut_trunk(stem(), *arguments, scale=0.6, seed=0, params=PhotoParams())


def test_bark_comes_from_the_file_at_full_size(view):
    bark = cut(view)
    assert bark is not None
    assert bark.name == "bark_photo"
    assert bark.base_color.shape[0] == 160  # 0.6 m at 0.03 / 8 m a pixel


def test_a_photo_in_memory_is_all_there_is(view):
    _, photo, *rest = view
    assert cut((photo, photo, *rest)) is None


def test_a_view_without_clear_bark_leaves_it_to_the_next(view):
    source, photo, placement, matte, camera = view
    hedge = replace(matte, alpha=np.ones_like(matte.alpha))
    assert cut((source, photo, placement, hedge, camera), view) is not None
    assert cut((source, photo, placement, hedge, camera)) is None


def test_a_mirrored_view_is_not_opened(view, tmp_path):
    assert cut((tmp_path / "gone.png", *view[1:]), mirrored=(True,)) is None


def test_a_warped_view_finds_the_same_trunk(view):
    """The straightened picture is the photograph moved and enlarged."""
    source, photo, _, matte, camera = view
    warp = np.array([[0.5, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]])
    larger = Camera(0.0, 0.015, (80.0, 500.0), 160, 512)
    alpha = cv2.resize(matte.alpha, (160, 512), interpolation=cv2.INTER_LINEAR)
    enlarged = Matte(alpha, np.repeat(np.repeat(matte.foreground, 2, 0), 2, 1), "trimap")
    del camera
    bark = cut((source, photo, Placement(larger, warp=warp), enlarged, larger))
    assert bark is not None
    assert bark.base_color.shape[0] == 160
