"""What a person would do, simulated on a drawn tree: holes, strokes, skies."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from benchmarks.likeness.matte_error import matte_error
from benchmarks.likeness.measure_holes import place_hole
from benchmarks.likeness.measure_paint import place_addition
from benchmarks.likeness.measure_strokes import draw_strokes
from benchmarks.likeness.paint_photo import SKIES, paint_photo
from benchmarks.measure_truth import Truth
from flowtree.model.camera import Camera
from flowtree.model.photo import Photo
from tests.pictures import draw_tree


def _truth(alpha):
    rows, columns = alpha.shape
    rgb = np.zeros((rows, columns, 3), np.uint8)
    camera = Camera(0.0, 10.0 / rows, (columns / 2, float(rows)), columns, rows)
    return Truth("drawn", 10.0, {0: Photo("a.png", rgb)}, {0: alpha}, {0: camera})


def _crown(width):
    """A round crown of this radius on a trunk."""
    row, column = np.mgrid[:200, :200] + 0.5
    alpha = ((row - 90) / 80) ** 2 + ((column - 100) / width) ** 2 < 1
    alpha |= (abs(column - 100) < 4) & (row > 90)
    return alpha.astype(np.float32)


def test_a_hole_is_a_tenth_of_the_crown_inside_it_beside_the_trunk():
    alpha = _crown(80)
    hole = place_hole(_truth(alpha), 0)
    assert hole.sum() == pytest.approx(0.1 * (alpha > 0.5).sum(), rel=0.05)
    assert (alpha[hole] == 1).all()
    columns = np.nonzero(hole.any(axis=0))[0]
    assert columns.min() > 100 or columns.max() < 100


def test_a_narrow_crown_gets_one_too():
    alpha = _crown(22)
    hole = place_hole(_truth(alpha), 0)
    assert hole.any()
    assert alpha[hole].mean() > 0.8


def test_an_addition_lies_on_the_other_side_mostly_outside():
    alpha = _crown(60)
    truth = _truth(alpha)
    hole = place_hole(truth, 0)
    more = place_addition(truth, 0, hole)
    assert more.sum() == pytest.approx(hole.sum(), rel=0.05)
    assert not (more & hole).any()
    assert 0.1 < alpha[more].mean() < 0.5
    assert (np.nonzero(more)[1].mean() - 100) * (np.nonzero(hole)[1].mean() - 100) < 0


def test_strokes_follow_thick_branches_that_reach_out():
    trunk = [[0, 0, 0, 0.3], [0, 9, 0, 0.1]]
    out = [
        [[0, y, 0, r], [side * 2, y + 1, 0, r / 2]]
        for y, side, r in ((3, 1, 0.1), (5, -1, 0.2), (7, 1, 0.05))
    ]
    beside = [[0, 5.1, 0, 0.15], [-2, 6.1, 0, 0.1]]
    toward = [[0, 6, 0, 0.25], [0, 7, 3, 0.1]]
    stems = [np.array(line, float) for line in (trunk, *out, beside, toward)]
    strokes = draw_strokes(_truth(_crown(80)), stems, 0)
    assert len(strokes) == 3
    assert [float(stroke[0, 1]) for stroke in strokes] == pytest.approx([100, 140, 60])
    assert all(stroke.shape[0] >= 5 for stroke in strokes)


def test_a_painted_photo_shows_the_cutout_and_its_matte(tmp_path):
    cutout = draw_tree(0, size=(120, 150))
    Image.fromarray(cutout).save(tmp_path / "tree.png")
    pictures = []
    for sky in SKIES.values():
        photo, alpha = paint_photo(tmp_path / "tree.png", sky)
        assert photo.alpha is None
        assert photo.rgb.shape[:2] == alpha.shape
        assert (alpha > 0.5).sum() == (cutout[..., 3] > 127).sum()
        rows, columns = np.nonzero(alpha == 1)
        shift = rows.min() - np.nonzero(cutout[..., 3] == 255)[0].min()
        aside = columns.min() - np.nonzero(cutout[..., 3] == 255)[1].min()
        own = cutout[rows - shift, columns - aside, :3].astype(int)
        assert np.abs(photo.rgb[rows, columns].astype(int) - own).mean() < 2
        pictures.append(photo.rgb)
    assert not (pictures[0] == pictures[1]).all()


def test_the_error_of_a_matte_counts_over_the_trees_box():
    truth = np.zeros((40, 60), np.float32)
    truth[10:30, 20:40] = 1.0
    assert matte_error(truth, truth) == 0.0
    assert matte_error(0 * truth, truth) == 1.0
    half = truth.copy()
    half[10:20] = 0.0
    half[0:5] = 1.0
    assert matte_error(half, truth) == pytest.approx(0.5)
