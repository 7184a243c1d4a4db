from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.errors import InputError
from flowtree.matting.extract_matte import extract_matte
from flowtree.matting.prepare_photo import prepare_photo
from flowtree.model.photo import Photo
from flowtree.params import MattingParams
from tests.matting.scenes import draw_tree, error

DATA = Path(__file__).parents[2] / ".." / "shared" / "data"
HAS_DATA = pytest.mark.skipif(not DATA.is_dir(), reason="the shared test data are not here")


@pytest.mark.parametrize("sky", [(150, 190, 235), (235, 235, 238), (225, 160, 120)])
@pytest.mark.parametrize("ground", [True, False])
def test_trees_before_skies_are_found_with_their_gaps(sky, ground):
    photo, truth = draw_tree(sky=sky, ground=ground)
    matte = extract_matte(photo)
    assert matte.method == "automatic"
    assert matte.alpha.dtype == np.float32
    assert error(matte.alpha, truth) < 0.06
    gaps = cv2.erode((truth[40:110, 50:110] < 0.1).astype(np.uint8), np.ones((3, 3))) > 0
    assert gaps.any()
    assert matte.alpha[40:110, 50:110][gaps].mean() < 0.15


def test_same_photo_same_bytes():
    photo, _ = draw_tree(seed=3)
    first, second = extract_matte(photo), extract_matte(photo)
    assert first.alpha.tobytes() == second.alpha.tobytes()
    assert first.foreground.tobytes() == second.foreground.tobytes()


def test_an_alpha_channel_is_its_own_matte():
    photo, truth = draw_tree()
    matte = extract_matte(Photo("cut.png", photo.rgb, truth))
    assert matte.method == "alpha channel"
    assert np.array_equal(matte.alpha, truth)
    with pytest.raises(InputError, match="alpha channel"):
        extract_matte(Photo("cut.png", photo.rgb, np.zeros_like(truth)))


def test_a_trimap_decides():
    photo, truth = draw_tree(seed=1)
    trimap = np.full(truth.shape, 128, np.uint8)
    trimap[cv2.erode(truth, np.ones((3, 3))) > 0.99] = 255
    trimap[cv2.dilate(truth, np.ones((5, 5))) < 0.01] = 0
    matte = extract_matte(photo, trimap=trimap)
    assert matte.method == "trimap"
    assert (matte.alpha[trimap == 255] == 1).all()
    assert (matte.alpha[trimap == 0] == 0).all()
    assert error(matte.alpha, truth) < 0.05
    for bad in (np.zeros_like(trimap), np.full_like(trimap, 255), trimap[:-1]):
        with pytest.raises(InputError, match="trimap"):
            extract_matte(photo, trimap=bad)


def test_scribbles_are_obeyed():
    photo, truth = draw_tree(seed=2)
    scribbles = np.zeros(truth.shape, np.uint8)
    scribbles[10:14, 5:60] = 1
    scribbles[70:90, 70:74] = 2
    matte = extract_matte(photo, scribbles=scribbles)
    assert matte.method == "scribbles"
    assert (matte.alpha[scribbles == 1] == 1).all()
    assert (matte.alpha[scribbles == 2] == 0).all()
    with pytest.raises(InputError, match="scribbles"):
        extract_matte(photo, scribbles=np.full(truth.shape, 9))


@pytest.mark.parametrize("given", ["nothing", "trimap", "alpha channel"])
def test_what_stands_before_the_tree_is_unknown(given):
    photo, truth = draw_tree(seed=2)
    scribbles = np.zeros(truth.shape, np.uint8)
    scribbles[60:120, 70:78] = 3
    trimap = np.where(truth > 0.99, 255, np.where(truth < 0.01, 0, 128)) if given == "trimap" else None
    if given == "alpha channel":
        photo = Photo(photo.name, photo.rgb, truth)
    matte = extract_matte(photo, trimap=trimap, scribbles=scribbles)
    assert matte.unknown is not None
    assert np.array_equal(matte.unknown, scribbles == 3)
    nothing = np.zeros_like(scribbles)
    assert extract_matte(photo, trimap=trimap, scribbles=nothing).unknown is None


def test_an_occluder_lends_the_tree_neither_alpha_nor_colour():
    photo, truth = draw_tree(seed=4)
    post = np.zeros(truth.shape, np.uint8)
    post[30:, 70:76] = 3
    painted = np.where(post[..., None] == 3, np.uint8([250, 0, 250]), photo.rgb)
    matte = extract_matte(Photo("post.png", painted), scribbles=post)
    crown = (post == 3) & (cv2.erode(truth, np.ones((5, 5))) > 0.9)
    assert matte.alpha[crown].mean() > 0.8
    assert error(matte.alpha, truth) < 0.06
    red, green, blue = matte.foreground[crown].astype(float).mean(axis=0)
    assert green > red
    assert green > blue


def test_a_scribble_across_the_trunk_ends_it():
    photo, truth = draw_tree(seed=7)
    rows = np.flatnonzero((truth > 0.5).any(axis=1))
    cut = int(rows[-1]) - 14
    scribbles = np.zeros(truth.shape, np.uint8)
    scribbles[cut : cut + 3, 74:87] = 2
    below = np.s_[cut + 5 : rows[-1] - 1, 74:87]
    assert extract_matte(photo).alpha[below].mean() > 0.4
    assert extract_matte(photo, scribbles=scribbles).alpha[below].mean() < 0.4


@pytest.mark.parametrize("strokes", [False, True])
def test_a_prepared_photo_gives_the_same_bytes(strokes):
    photo, truth = draw_tree(seed=5)
    params = MattingParams(foreground_colors=("#3a5f0b",))
    prepared = prepare_photo(photo, params=params)
    scribbles = np.zeros(truth.shape, np.uint8) if strokes else None
    if scribbles is not None:
        scribbles[60:70, 60:90], scribbles[150:160, 5:30] = 1, 2
    kept = extract_matte(photo, scribbles=scribbles, prepared=prepared, params=params)
    anew = extract_matte(photo, scribbles=scribbles, params=params)
    assert kept.alpha.tobytes() == anew.alpha.tobytes()
    assert kept.foreground.tobytes() == anew.foreground.tobytes()


def test_what_was_prepared_for_another_photo_is_refused():
    photo, _ = draw_tree(seed=5)
    with pytest.raises(InputError, match="prepared"):
        extract_matte(photo, prepared=prepare_photo(draw_tree(seed=6)[0]))
    with pytest.raises(InputError, match="prepared"):
        extract_matte(photo, prepared=prepare_photo(photo), params=MattingParams(solve_height=100))


def two_trees():
    """A green and a red disc of leaves, equally far from the middle, before a sky."""
    rng = np.random.default_rng(0)
    rows, columns = np.mgrid[:160, :240]
    picture = np.full((160, 240, 3), (170, 200, 235), float)
    masks = [np.hypot(rows - 90, columns - x) < 42 for x in (60, 180)]
    for mask, colour in zip(masks, ((60, 110, 40), (170, 60, 40)), strict=True):
        picture[mask] = np.array(colour) * rng.uniform(0.5, 1.4, (int(mask.sum()), 1))
    picture += rng.normal(0, 1.0, picture.shape)
    return Photo("two.png", np.clip(picture, 0, 255).astype(np.uint8)), masks


def test_picked_colours_choose_between_two_trees():
    photo, (green, red) = two_trees()
    params = MattingParams(foreground_colors=("#aa3c28", "#7d2c1e"), background_colors=("#3c6e28", "#2a4d1c"))
    alpha = extract_matte(photo, params=params).alpha
    assert alpha[red].mean() > 0.7
    assert alpha[green].mean() < 0.3


def test_scribbles_choose_between_two_trees():
    photo, (green, red) = two_trees()
    scribbles = np.zeros(green.shape, np.uint8)
    scribbles[80:100, 40:80] = 1
    scribbles[80:100, 160:200] = 2
    alpha = extract_matte(photo, scribbles=scribbles).alpha
    assert alpha[green].mean() > 0.8
    assert alpha[red].mean() < 0.3


@pytest.mark.parametrize("colour", ["green", "#12345", "#gggggg"])
def test_malformed_colours_are_refused(colour):
    photo, _ = draw_tree()
    with pytest.raises(InputError, match="#rrggbb"):
        extract_matte(photo, params=MattingParams(foreground_colors=(colour,)))


@pytest.mark.parametrize("kind", ["sky", "black", "white", "fade", "leaves"])
def test_without_a_tree_there_is_a_clear_error(kind):
    rng = np.random.default_rng(0)
    plain = {"sky": (120, 170, 230), "black": (0, 0, 0), "white": (255, 255, 255)}
    picture = np.zeros((120, 90, 3)) + np.array(plain.get(kind, (0, 0, 0)))
    if kind == "fade":
        picture = np.linspace(80, 230, 120)[:, None, None] + np.zeros((120, 90, 3))
    if kind == "leaves":
        picture = cv2.GaussianBlur(rng.uniform(0, 1, (120, 90)), (0, 0), 1.0)[..., None] * np.array(
            [120, 255, 80]
        )
    with pytest.raises(InputError, match="scribble"):
        extract_matte(Photo("none.png", picture.astype(np.uint8)))


@settings(max_examples=20, deadline=None)
@given(data=st.data())
def test_any_picture_gives_a_matte_or_an_input_error(data):
    height, width = data.draw(st.integers(16, 80)), data.draw(st.integers(16, 80))
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32 - 1)))
    coarse = rng.integers(0, 256, (data.draw(st.integers(1, 16)), data.draw(st.integers(1, 16)), 3))
    picture = cv2.resize(coarse.astype(np.uint8), (width, height), interpolation=data.draw(st.integers(0, 2)))
    scribbles = rng.integers(0, 4, (height, width)) if data.draw(st.booleans()) else None
    try:
        matte = extract_matte(Photo("random.png", picture), scribbles=scribbles)
    except InputError:
        return
    assert matte.alpha.shape == (height, width)
    assert matte.foreground.shape == (height, width, 3)
    assert np.isfinite(matte.alpha).all()
    assert 0.0 <= matte.alpha.min() <= matte.alpha.max() <= 1.0
    assert matte.alpha.max() > 0.5


def picture_of(path, side):
    with Image.open(path) as image:
        pixels = np.asarray(image)
    size = side / max(pixels.shape[:2])
    return cv2.resize(pixels, None, fx=size, fy=size, interpolation=cv2.INTER_AREA)


@HAS_DATA
@pytest.mark.parametrize("name", ["aspen", "birch", "maple_bare", "willow"])
def test_loose_photos_with_a_known_matte(name):
    folder = DATA / "truth" / name
    alpha = picture_of(folder / "alpha_1.png", 768)
    truth = (alpha if alpha.ndim == 2 else alpha[..., -1]) / 255
    matte = extract_matte(Photo(name, picture_of(folder / "photo_1.jpg", 768)))
    assert error(matte.alpha, truth) < 0.06  # a plain threshold reaches 0.06 to 0.30


@HAS_DATA
@pytest.mark.parametrize("name", ["crooked-tree2", "palm-tree2", "purple-leaf-plum"])
def test_cutouts_over_a_sky(name):
    cut = picture_of(DATA / "cutouts" / f"{name}.png", 512).astype(float)
    truth, fade = cut[..., 3] / 255, np.linspace(0, 1, len(cut))[:, None, None]
    sky = (1 - fade) * np.array([90, 140, 220]) + fade * np.array([190, 215, 240])
    picture = truth[..., None] * cut[..., :3] + (1 - truth[..., None]) * sky
    matte = extract_matte(Photo(name, picture.astype(np.uint8)))
    assert error(matte.alpha, truth) < 0.03
    solid = truth > 0.95
    assert np.abs(matte.foreground.astype(float) - cut[..., :3])[solid].mean() < 12


@HAS_DATA
@pytest.mark.parametrize("name", ["burr_oak", "catalpa", "sycamore_bare", "white_ash"])
def test_photographs_give_a_tree_that_stands_on_a_trunk(name):
    alpha = extract_matte(Photo(name, picture_of(DATA / "photos" / f"{name}.jpg", 448))).alpha
    rows = np.flatnonzero((alpha > 0.5).any(axis=1))
    assert 0.1 < alpha.mean() < 0.75
    assert np.ptp(rows) > 0.55 * len(alpha)
    low = alpha[rows[-1] - np.ptp(rows) // 12 : rows[-1] + 1]
    assert (low > 0.5).sum(axis=1).mean() < 0.3 * alpha.shape[1]  # a trunk, not a meadow


def test_where_the_person_says_unknown_the_pixels_decide():
    photo, truth = draw_tree(seed=2)
    labels = np.zeros(truth.shape, np.uint8)
    labels[30:70, 40:80] = 4
    matte = extract_matte(photo, scribbles=labels)
    assert matte.unknown is None  # nothing stands before the tree
    assert error(matte.alpha, truth) < 0.08
    beside = np.ones(truth.shape, bool)
    beside[20:80, 30:90] = False
    assert np.abs(matte.alpha - extract_matte(photo).alpha)[beside].mean() < 0.02


@HAS_DATA
@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("burr_oak", (slice(0.725, 0.75), slice(0.3, 0.43))),  # the field beside a trunk that stands free
        ("catalpa", (slice(0.3, 0.6), slice(0.0, 0.045))),  # a conifer at the picture's border
    ],
)
def test_fields_and_neighbours_are_no_part_of_the_tree(name, place):
    alpha = extract_matte(Photo(name, picture_of(DATA / "photos" / f"{name}.jpg", 640))).alpha
    rows, columns = (
        slice(int(part.start * size), int(part.stop * size))
        for part, size in zip(place, alpha.shape, strict=True)
    )
    assert alpha[rows, columns].mean() < 0.12


def test_a_small_gap_in_the_middle_of_a_dense_crown_stays_open():
    rng = np.random.default_rng(4)
    rows, columns = np.mgrid[:448, :400]
    tree = np.hypot(rows - 190, columns - 200) < 150
    tree |= (np.abs(columns - 200) < 8) & (rows > 190) & (rows < 430)
    gaps = np.zeros_like(tree)
    for row, column in rng.integers((150, 160), (230, 240), (14, 2)):
        gaps[row : row + 3, column : column + 2] = True
    sky = np.full((*tree.shape, 3), 250.0) + rng.normal(0.0, 1.0, (*tree.shape, 3))
    leaves = np.array([28.0, 48.0, 24.0]) + rng.normal(0.0, 9.0, (*tree.shape, 1))
    cover = cv2.GaussianBlur((tree & ~gaps).astype(np.float32), (0, 0), 0.6)[..., None]
    photo = Photo("dense.png", np.clip(cover * leaves + (1 - cover) * sky, 0, 255).astype(np.uint8))
    matte = extract_matte(photo)
    assert matte.alpha[gaps].mean() < 0.4
    assert matte.alpha[tree & (cover[..., 0] > 0.99)].mean() > 0.97
