from dataclasses import replace
from functools import lru_cache

import cv2
import numpy as np
import pytest

from flowtree.meshing.cut_bark import cut_bark
from flowtree.meshing.measure_bark import measure_bark
from flowtree.meshing.quilt_texture import quilt_texture
from flowtree.meshing.rectify_trunk import HALF_TURN, TrunkPicture, rectify_trunk
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton

RADIUS, HEIGHT = 0.3, 9.0  # [m]
CAMERA = Camera(0.0, 0.02, (50.0, 470.0), 100, 480)
FINER = 8  # times as many pixels in the photograph


def stem():
    count = 20
    points = np.zeros((count, 3), np.float32)
    points[:, 1] = np.linspace(0, HEIGHT, count)
    return Skeleton(
        parent=np.arange(-1, count - 1, dtype=np.int32),
        points=points,
        radius=np.full(count, RADIUS, np.float32),
        particles=np.ones(count, np.int32),
        level=np.zeros(count, np.int32),
        twig=np.zeros(count, bool),
    )


def photograph(finer=FINER, lean=0.0, seed=0, stripes=False):
    """A round trunk with a bark of known pattern, lit from the left."""
    rows, columns = np.mgrid[: CAMERA.height * finer, : CAMERA.width * finer].astype(np.float32) + 0.5
    right = (columns / finer - CAMERA.foot[0]) * CAMERA.metres_per_pixel
    up = (CAMERA.foot[1] - rows / finer) * CAMERA.metres_per_pixel
    sine = (right - lean * up) / RADIUS
    there = (np.abs(sine) < 1) & (up > 0) & (up < HEIGHT)
    angle = np.arcsin(np.clip(sine, -1, 1))
    if stripes:
        bark = 0.5 + 0.3 * np.sign(np.sin(2 * np.pi * angle * RADIUS / 0.08))
    else:
        noise = np.random.default_rng(seed).standard_normal((256, 256)).astype(np.float32)
        noise = cv2.GaussianBlur(noise, (0, 0), 0.9)
        noise /= noise.std()
        u, v = (np.mod(x * 160.0, 256).astype(np.float32) for x in (angle * RADIUS, up))
        bark = 0.45 + 0.13 * cv2.remap(noise, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP)
    light = np.clip(bark, 0.05, 0.9) * (0.75 - 0.5 * sine)
    color = light[..., None] * np.array([1.0, 0.9, 0.78], np.float32)
    rgb = np.where(there[..., None], 255 * np.clip(color, 0, 1) ** (1 / 2.2), 230)
    return rgb.astype(np.uint8), there


@lru_cache
def view(finer=FINER, **more):
    rgb, there = photograph(finer, **more)
    alpha = cv2.resize(there.astype(np.float32), (CAMERA.width, CAMERA.height), interpolation=cv2.INTER_AREA)
    coarse = cv2.resize(rgb, (CAMERA.width, CAMERA.height), interpolation=cv2.INTER_AREA)
    return Matte(alpha, coarse, "trimap"), TrunkPicture(rgb, np.diag([finer, finer, 1.0]))


def test_the_trunk_is_unrolled():
    """Stripes of one width around the trunk are of one width in the strip, to its edges."""
    matte, picture = view(stripes=True)
    strip = rectify_trunk(stem(), matte, CAMERA, picture)
    assert strip is not None
    assert strip.turn == pytest.approx(HALF_TURN / np.pi)
    width = strip.rgb.shape[1] * strip.metres_per_pixel
    assert width == pytest.approx(2 * HALF_TURN * RADIUS, rel=0.06)
    row = strip.rgb[strip.rgb.shape[0] // 2].mean(axis=1)
    low = cv2.GaussianBlur(row[None], (0, 0), 12)[0]
    edges = np.flatnonzero(np.diff((row > low).astype(int)) != 0)
    gaps = np.diff(edges) * strip.metres_per_pixel
    assert np.median(gaps) == pytest.approx(0.04, rel=0.1)
    assert np.ptp(gaps) < 0.015


def test_bark_is_cut_without_seam_or_shade_and_in_the_trunks_colour():
    matte, picture = view()
    bark = cut_bark(stem(), matte, CAMERA, picture, scale=0.6)
    assert bark is not None
    assert bark.name == "bark_photo"
    size = bark.base_color.shape[0]
    assert bark.base_color.shape == bark.normal.shape == (size, size, 3)
    assert 200 <= size <= 512
    light = bark.base_color.astype(float).mean(axis=2)
    for axis in (0, 1):
        step = np.abs(light - np.roll(light, 1, axis=axis)).mean(axis=1 - axis)
        assert step[0] < np.median(step) + 8 * np.median(np.abs(step - np.median(step)))
        shade = light.mean(axis=1 - axis)
        assert shade.std() < 0.35 * light.std(), "light from the left is taken out"
    assert light.std() > 8, "the pattern stays"
    seen = measure_bark(stem(), [matte], [CAMERA])
    mean = bark.base_color.reshape(-1, 3).mean(axis=0)
    assert np.abs(mean / mean.sum() - seen / seen.sum()).max() < 0.02
    assert np.abs(mean - seen).max() < 45


def test_a_seed_gives_its_bytes_and_another_gives_others():
    matte, picture = view()
    one, two, other = (cut_bark(stem(), matte, CAMERA, picture, scale=0.6, seed=s) for s in (1, 1, 2))
    assert one.base_color.tobytes() == two.base_color.tobytes()
    assert one.base_color.tobytes() != other.base_color.tobytes()


def with_leaves(matte, picture):
    rgb = picture.rgb.copy()
    rgb[::3, ::2] = (60, 140, 40)
    return matte, replace(picture, rgb=rgb)


def out_of_focus(matte, picture):
    return matte, replace(picture, rgb=cv2.GaussianBlur(picture.rgb, (0, 0), 6.0))


def before_a_hedge(matte, picture):
    return replace(matte, alpha=np.maximum(matte.alpha, 0.9).astype(np.float32)), picture


def behind_a_car(matte, picture):
    unknown = np.zeros(matte.alpha.shape, bool)
    unknown[250:] = True
    return replace(matte, unknown=unknown), picture


@pytest.mark.parametrize("spoil", [with_leaves, out_of_focus, before_a_hedge, behind_a_car])
def test_what_is_not_clear_bark_is_left_to_painting(spoil):
    matte, picture = spoil(*view())
    assert cut_bark(stem(), matte, CAMERA, picture, scale=0.6) is None


def test_a_narrow_trunk_is_left_to_painting():
    matte, picture = view(finer=2)
    assert cut_bark(stem(), matte, CAMERA, picture, scale=0.6) is None


def test_no_tree_no_strip():
    matte, picture = view()
    empty = replace(matte, alpha=np.zeros_like(matte.alpha))
    assert rectify_trunk(stem(), empty, CAMERA, picture) is None


@pytest.mark.parametrize(
    ("rows", "columns", "size", "block"), [(60, 20, 64, 12), (9, 7, 16, 50), (3, 3, 8, 3)]
)
def test_any_sample_makes_a_tile_of_its_own_colours(rows, columns, size, block):
    rng = np.random.default_rng(0)
    sample = rng.random((rows, columns, 3)).astype(np.float32)
    tile = quilt_texture(sample, size, block=block, random=rng)
    assert tile.shape == (size, size, 3)
    assert tile.min() >= sample.min() - 1e-5
    assert tile.max() <= sample.max() + 1e-5
