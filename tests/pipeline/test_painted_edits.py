"""What a person paints in one view changes the tree there, and leaves the rest as it was."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from scipy.spatial import cKDTree

from benchmarks.measure_truth import INPUTS, load_truth, mark_ends
from flowtree.geometry.footprint_means import footprint_means
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.photo import Photo
from flowtree.params import LeafParams, Params
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.render.render_mask import render_mask

_BIRCH = Path(__file__).parents[2] / ".." / "shared" / "data" / "truth" / "birch"
SMALL = Params(leaves=LeafParams(most=4000))
SHRINK = 2
pytestmark = pytest.mark.skipif(not _BIRCH.is_dir(), reason="the test data beside the project is not there")


class Painter:
    """A known tree at half its size, made again with whatever is painted on its first view."""

    def __init__(self):
        truth = load_truth(_BIRCH)
        self.height = truth.height
        self.cameras, self.photos = [], []
        for yaw in INPUTS:
            camera, photo = truth.cameras[yaw], truth.photos[yaw]
            rows, columns = camera.height // SHRINK, camera.width // SHRINK
            size = {"dsize": (columns, rows), "interpolation": cv2.INTER_AREA}
            foot = (camera.foot[0] / SHRINK, camera.foot[1] / SHRINK)
            self.cameras.append(Camera(float(yaw), camera.metres_per_pixel * SHRINK, foot, columns, rows))
            rgb, alpha = cv2.resize(photo.rgb, **size), cv2.resize(truth.alphas[yaw], **size)
            self.photos.append(Photo(photo.name, rgb, alpha))
        self.cache = StageCache()
        self.plain = self.make(PaintedEdit())
        rows, columns = np.nonzero(self.photos[0].alpha > 0.3)
        foot = self.cameras[0].foot
        in_crown = rows < foot[1] - 0.25 * self.height / self.cameras[0].metres_per_pixel
        self.radius = float(np.sqrt(0.1 * in_crown.sum() / np.pi))
        self.side = float(np.percentile(columns[in_crown], 97))
        self.middle = (0.5 * (foot[0] + self.side), float(np.percentile(rows[in_crown], 45)))

    def make(self, edit):
        return reconstruct(
            self.photos,
            yaws=INPUTS,
            height=self.height,
            marks=[mark_ends(camera, self.height) for camera in self.cameras],
            paint=[edit, None],
            params=SMALL,
            cache=self.cache,
        )

    def disc(self, x, y, radius):
        down, right = np.mgrid[: self.cameras[0].height, : self.cameras[0].width] + 0.5
        return (right - x) ** 2 + (down - y) ** 2 < radius**2

    def means(self, picture):
        """Over cells of a 64th of the height, those of the measure of fidelity."""
        cell = self.height / 64
        grid = {"left": -40 * cell, "bottom": 0.0, "cell": cell, "columns": 80, "rows": 66}
        return footprint_means(np.asarray(picture, np.float32), self.cameras[0], **grid)

    def seen(self, made):
        return self.means(render_mask(made.tree, self.cameras[0], samples=2))

    def changed(self, made, place):
        """Alpha within, and its mean change beside, what was painted."""
        before, after = self.seen(self.plain), self.seen(made)
        cover = self.means(place)
        beside = (cover == 0) & (np.maximum(before, after) > 0.02)
        return after[cover > 0.99].mean(), np.abs(after - before)[beside].mean()


@pytest.fixture(scope="module")
def painter():
    return Painter()


def test_what_is_erased_goes_and_the_rest_stays(painter):
    place = painter.disc(*painter.middle, painter.radius)
    made = painter.make(PaintedEdit(erase=place.astype(np.float32)))
    within, beside = painter.changed(made, place)
    assert within <= 0.15
    assert beside < 0.03
    assert made.cameras == painter.plain.cameras
    assert made.volume.density.shape == painter.plain.volume.density.shape
    _assert_limbs_stay(painter, made, painter.middle)


def test_what_is_added_grows_and_the_rest_stays(painter):
    place = painter.disc(painter.side + 0.3 * painter.radius, painter.middle[1], painter.radius)
    made = painter.make(PaintedEdit(add=(0.7 * place).astype(np.float32)))
    within, beside = painter.changed(made, place)
    assert within >= 0.5 * 0.7
    assert beside < 0.03
    assert made.volume.voxel == painter.plain.volume.voxel
    _assert_limbs_stay(painter, made, (painter.side + 0.3 * painter.radius, painter.middle[1]))


def test_a_direction_bends_branches_where_it_is_drawn(painter):
    x, y = painter.middle
    reach = painter.radius
    line = np.array([[x + reach, y + reach], [x - reach, y - 0.2 * reach]], np.float32)
    made = painter.make(PaintedEdit(directions=(line,), reach=(reach,)))
    wanted = line[1] - line[0]
    turned = [_along(painter, m, painter.disc(x, y, 0.6 * reach), wanted) for m in (painter.plain, made)]
    assert turned[1] > turned[0] + 0.3
    _, beside = painter.changed(made, painter.disc(x, y, 2 * reach))
    assert beside < 0.03
    assert np.array_equal(made.volume.density, painter.plain.volume.density)
    _assert_limbs_stay(painter, made, painter.middle)


def _pixels(painter, points):
    camera = painter.cameras[0]
    x = camera.foot[0] + points[:, 0] / camera.metres_per_pixel
    return np.stack([x, camera.foot[1] - points[:, 1] / camera.metres_per_pixel], axis=1)


def _along(painter, made, place, wanted):
    """Mean cosine, by length, of the branches' ways to the foot within a place with one in the picture."""
    skeleton = made.skeleton
    at = _pixels(painter, skeleton.points)
    way = at[np.maximum(skeleton.parent, 0)] - at
    column, row = np.clip(at.astype(int).T, 0, np.array(place.shape[::-1])[:, None] - 1)
    there = place[row, column] & ~skeleton.twig
    length = np.linalg.norm(way[there], axis=1).sum()
    return float((way[there] @ wanted).sum() / (length * np.linalg.norm(wanted)))


def _assert_limbs_stay(painter, made, middle):
    """Of what is thick, away from the paint, nearly all has its like within 3 % of the height."""
    old, new = painter.plain.skeleton, made.skeleton
    points = old.points[~old.twig & (old.particles >= 5)]
    away = np.linalg.norm(_pixels(painter, points) - middle, axis=1)
    cell = 0.1 * painter.height / painter.cameras[0].metres_per_pixel
    far = points[away > painter.radius + cell]
    nearest = cKDTree(new.points[~new.twig]).query(far)[0]
    assert (nearest < 0.03 * painter.height).mean() > 0.9
