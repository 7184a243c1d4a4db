"""Loose photographs of one tree: what was done to them is found, and undone."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.geometry.central_plane import view_from_distance
from flowtree.model.edit import PaintedEdit
from flowtree.model.marks import ViewMarks
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.params import AlignParams
from flowtree.photos.level_picture import pixel_centres, roll_matrix
from flowtree.photos.place_views import place_views
from flowtree.photos.straighten_view import straighten_view

WIDTH, HEIGHT, FOOT, TOP = 360, 400, (180.0, 380.0), 20.0
PARALLEL = AlignParams(distance=0)


def tree(seed=0, turn=0.0):
    """A round tree seen from a side: a plumb, tapering trunk and leaves in a ball: (h, w) alpha."""
    rng = np.random.default_rng(seed)
    alpha = np.zeros((HEIGHT * 2, WIDTH * 2), np.uint8)
    for row in range(300, 2 * round(FOOT[1])):
        half = 8 + 14 * (row - 300) / 460
        alpha[row, round(360 - half) : round(360 + half)] = 255
    count = 420
    out = rng.normal(size=(count, 3))
    place = out / np.linalg.norm(out, axis=1)[:, None] * (rng.random(count) ** (1 / 3))[:, None]
    angle = np.radians(turn)
    x = place[:, 0] * np.cos(angle) - place[:, 2] * np.sin(angle)
    for across, up in zip(x, place[:, 1], strict=True):
        cv2.circle(alpha, (round(360 + 230 * across), round(255 - 205 * up)), 10, 255, -1)
    cv2.circle(alpha, (360, 2 * round(TOP) + 10), 10, 255, -1)
    return cv2.resize(alpha, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA).astype(np.float32) / 255


def warped(alpha, matrix, size=(WIDTH, HEIGHT)):
    """The picture after (x, y) went to matrix (x, y)."""
    return np.clip(cv2.warpPerspective(alpha, pixel_centres(matrix), size), 0, 1)


def photo(picture, name="a.jpg", **more):
    return Photo(name, np.full((*picture.shape, 3), 90, np.uint8), **more)


def matte(alpha):
    return Matte(alpha, np.full((*alpha.shape, 3), 90, np.uint8), "automatic")


def place(alphas, *, marks=None, params=PARALLEL, photos=None, height=10.0):
    count = len(alphas)
    return place_views(
        photos or [photo(alpha, f"{k}.jpg") for k, alpha in enumerate(alphas)],
        [matte(alpha) for alpha in alphas],
        marks or [ViewMarks()] * count,
        yaws=[180.0 * k / count for k in range(count)],
        height=height,
        params=params,
    )


def known(placement, name):
    return next(estimate for estimate in placement.estimates if estimate.name == name)


def straight(alpha, placement):
    return straighten_view(photo(alpha), matte(alpha), PaintedEdit(), placement)[1]


def agreement(alpha, placement, other):
    """Soft IoU of a straightened matte with the unspoilt one, over the tree's own grid."""
    camera, made = placement.camera, straight(alpha, placement)
    scale = 10.0 / (FOOT[1] - TOP) / camera.metres_per_pixel
    matrix = np.array(
        [
            [scale, 0, camera.foot[0] - scale * FOOT[0]],
            [0, scale, camera.foot[1] - scale * FOOT[1]],
            [0, 0, 1],
        ]
    )
    seen = cv2.warpPerspective(
        made.alpha, pixel_centres(matrix), (WIDTH, HEIGHT), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    )
    small = [cv2.resize(picture, (60, 66), interpolation=cv2.INTER_AREA) for picture in (seen, other)]
    return np.minimum(*small).sum() / np.maximum(*small).sum()


@pytest.mark.parametrize("roll", [-3.0, 3.0, 1.5])
def test_the_roll_of_a_view_is_found_and_undone(roll):
    alpha = tree()
    rolled = warped(alpha, roll_matrix(FOOT, roll))
    placement = place([rolled, tree(turn=90)])[0]
    found = known(placement, "roll")
    assert found.value == pytest.approx(roll, abs=0.7)
    assert 0 < found.deviation < 3
    assert agreement(rolled, placement, alpha) > agreement(
        rolled, place([rolled, alpha], marks=[ViewMarks(roll=0.0)] * 2)[0], alpha
    )


def test_a_plumb_pair_stays_as_it_is():
    alphas = [tree(), tree(turn=90)]
    for placement in place(alphas):
        assert placement.warp is None
        assert placement.camera.foot == pytest.approx(FOOT, abs=1.0)
        assert placement.camera.metres_per_pixel == pytest.approx(10 / 360, rel=0.01)


def test_prepared_pictures_are_taken_as_they_are():
    rolled = [warped(tree(turn=turn), roll_matrix(FOOT, 3.0)) for turn in (0, 90)]
    photos = [photo(alpha, alpha=alpha) for alpha in rolled]
    for params in (AlignParams(), AlignParams(automatic="none")):
        assert all(p.warp is None for p in place(rolled, photos=photos, params=params))
    assert all(p.warp is not None for p in place(rolled, photos=photos, params=AlignParams(automatic="all")))
    assert all(p.warp is None for p in place(rolled, params=AlignParams(automatic="none")))


@settings(max_examples=8, deadline=None)
@given(scale=st.floats(0.6, 1.6), x=st.floats(0, 40), y=st.floats(0, 40))
def test_scale_and_shift_of_a_photo_change_nothing_of_the_tree(scale, x, y):
    alpha, other = tree(), tree(turn=90)
    matrix = np.array([[scale, 0, x], [0, scale, y], [0, 0, 1]])
    size = (int(WIDTH * scale + 60), int(HEIGHT * scale + 60))
    loose = warped(alpha, matrix, size)
    for params in (PARALLEL, AlignParams()):
        before, after = place([alpha, other], params=params), place([loose, other], params=params)
        assert after[1].camera.foot == pytest.approx(before[1].camera.foot, abs=2.0)
        assert after[1].camera.metres_per_pixel == pytest.approx(before[1].camera.metres_per_pixel, rel=0.02)
        pixels = [10 / p[0].camera.metres_per_pixel for p in (before, after)]
        assert pixels[1] == pytest.approx(scale * pixels[0], rel=0.02)
        foot = np.array([*before[0].camera.foot, 1.0]), np.array([*after[0].camera.foot, 1.0])
        at = [
            point if p[0].warp is None else (p[0].warp @ point) / (p[0].warp @ point)[2]
            for point, p in zip(foot, (before, after), strict=True)
        ]
        assert np.allclose((matrix @ at[0])[:2], at[1][:2], atol=2.0)


@pytest.mark.parametrize("distance", [1.5, 3.0])
def test_a_given_distance_undoes_the_keystone(distance):
    alpha = tree()
    view = view_from_distance(FOOT[1], TOP, distance=distance, eye=0.16)
    to_plane = np.array([[1 / 360, 0, -FOOT[0] / 360], [0, -1 / 360, FOOT[1] / 360], [0, 0, 1]])
    seen = warped(alpha, view.homography(FOOT[0]) @ to_plane)
    mark = ViewMarks(distance=10.0 * distance, roll=0.0)
    placement = place([seen, tree(turn=90)], marks=[mark, ViewMarks()])[0]
    assert known(placement, "distance").origin == "given"
    with_it, without = (
        agreement(seen, p, alpha)
        for p in (placement, place([seen, alpha], marks=[ViewMarks(roll=0.0)] * 2)[0])
    )
    assert with_it > 0.97
    assert with_it > without


def test_focal_length_and_tree_say_the_distance():
    alpha = tree()
    view = view_from_distance(FOOT[1], TOP, distance=2.0, eye=0.16)
    file = photo(alpha, focal_length=view.focal)
    found = known(place([alpha, alpha], photos=[file, photo(alpha)])[0], "distance")
    assert found.origin == "EXIF"
    assert found.value == pytest.approx(20.0, rel=0.03)
    assumed = known(place([alpha, alpha], params=AlignParams(distance=4))[0], "distance")
    assert (assumed.value, assumed.origin) == (pytest.approx(40.0), "assumed")


@pytest.mark.parametrize(("below", "above"), [(50, 0), (0, 60), (40, 50)])
def test_hidden_ends_are_found_from_the_other_view(below, above):
    alpha = tree()
    cut = alpha[above : round(FOOT[1]) - below]
    placement = place([cut, tree(turn=90)])[0]
    assert known(placement, "foot").value == pytest.approx(FOOT[1] - above, abs=14)
    assert known(placement, "top").value == pytest.approx(TOP - above, abs=14)
    assert placement.warnings
    made = straight(cut, placement)
    camera = placement.camera
    row = round(camera.foot[1]) - 4
    assert made.alpha[row, round(camera.foot[0])] > 0.9, "the trunk goes on down to the foot"
    if above:
        assert made.unknown is not None
        assert made.unknown[2, round(camera.foot[0])]


def test_a_crown_whose_top_nobody_sees_is_closed_by_half_a_ball():
    """Cut through the middle of its crown, a round tree is found to be nearly as high as it is."""
    above = round(0.5 * (TOP + 235.0))
    cut = tree()[above : round(FOOT[1])]
    placement = place([cut, cut])[0]
    top = known(placement, "top")
    assert top.origin == "assumed"
    assert top.value == pytest.approx(TOP - above, abs=20)
    assert any("upper edge" in warning for warning in placement.warnings)
    assert straight(cut, placement).unknown[2:40].mean() > 0.5
    given = place([cut, cut], marks=[ViewMarks(top=-30.0)] * 2)[0]
    assert known(given, "top").value == -30.0


def test_what_is_given_is_taken():
    alpha = tree()
    mark = ViewMarks(foot=(170.0, 420.0), top=-30.0, roll=2.0, distance=25.0)
    placement = place([alpha, alpha], marks=[mark, ViewMarks()])[0]
    assert {e.name: (e.value, e.origin) for e in placement.estimates} == {
        "roll": (2.0, "given"),
        "foot": (420.0, "given"),
        "top": (-30.0, "given"),
        "distance": (pytest.approx(25.0), "given"),
    }
    foot = placement.warp @ np.array([*placement.camera.foot, 1.0])
    assert foot[:2] / foot[2] == pytest.approx(mark.foot)


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    fill=st.floats(0, 1),
    size=st.tuples(st.integers(1, 50), st.integers(1, 50)),
    focal=st.none() | st.floats(1, 1e5),
)
@example(seed=0, fill=1.0, size=(39, 2), focal=1.0)
def test_any_matte_is_placed_finitely_or_refused(seed, fill, size, focal):
    rng = np.random.default_rng(seed)
    alphas = [np.where(rng.random(size) < fill, rng.random(size), 0).astype(np.float32) for _ in range(2)]
    try:
        placements = place(
            alphas, photos=[photo(a, focal_length=focal) for a in alphas], params=AlignParams()
        )
    except InputError:
        return
    for alpha, placement in zip(alphas, placements, strict=True):
        camera = placement.camera
        assert np.isfinite([*camera.foot, camera.metres_per_pixel]).all()
        assert camera.metres_per_pixel > 0
        assert max(camera.width, camera.height) <= 2 * max(size) + 2
        made = straight(alpha, placement)
        assert made.alpha.shape == (camera.height, camera.width)
        assert made.alpha.min() >= 0
        assert made.alpha.max() <= 1
