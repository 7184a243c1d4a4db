"""What a frame cuts off is expected to look as the other views show it."""

from __future__ import annotations

import numpy as np

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.placement import Placement
from flowtree.photos.complete_mattes import complete_mattes

WIDE = Camera(0.0, 0.1, (50.0, 95.0), 100, 100)


def ball(camera):
    y, x = np.mgrid[: camera.height, : camera.width] + 0.5
    across, up = (
        (x - camera.foot[0]) * camera.metres_per_pixel,
        (camera.foot[1] - y) * camera.metres_per_pixel,
    )
    return (np.hypot(across, up - 5.0) < 3.0).astype(np.float32)


def view(alpha, unknown=None):
    return Matte(alpha, np.zeros((*alpha.shape, 3), np.uint8), "automatic", unknown)


def test_a_cut_crown_is_completed_and_what_stands_before_it_stays_unknown():
    whole = ball(WIDE)
    cut = whole.copy()
    cut[:, 65:] = 0.0
    unknown = np.zeros(cut.shape, bool)
    unknown[:, 65:] = unknown[40:50, 30:40] = True
    placements = [Placement(WIDE, np.eye(3), (65, 100), ("right",)), Placement(WIDE)]
    done, other = complete_mattes([view(cut, unknown), view(whole)], placements)
    assert np.abs(done.alpha - whole).mean() < 0.01
    assert done.unknown.sum() == 100
    assert done.unknown[45, 35]
    assert np.array_equal(other.alpha, whole)


def test_views_of_another_size_are_brought_to_scale():
    small = Camera(90.0, 0.25, (30.0, 42.0), 60, 44)
    unknown = np.ones((100, 100), bool)
    unknown[50:] = False
    cut = np.where(unknown, 0.0, ball(WIDE)).astype(np.float32)
    warp = np.array([[1.0, 0, 0], [0, 1.0, -50.0], [0, 0, 1.0]])
    placements = [Placement(WIDE, warp, (100, 50), ("top",)), Placement(small)]
    done = complete_mattes([view(cut, unknown), view(ball(small))], placements)[0]
    assert np.abs(done.alpha - ball(WIDE)).mean() < 0.03
    assert done.unknown is None


def test_whole_views_and_lone_ones_stay_as_they_are():
    whole, unknown = view(ball(WIDE)), view(ball(WIDE), np.ones((100, 100), bool))
    assert complete_mattes([whole, whole], [Placement(WIDE)] * 2)[0] is whole
    lone = complete_mattes([unknown], [Placement(WIDE, np.eye(3), (50, 100), ("right",))])[0]
    assert np.array_equal(lone.alpha, unknown.alpha)
    assert lone.unknown.all()


def test_what_no_view_shows_above_the_frame_ends_as_a_dome():
    unknown = np.zeros((100, 100), bool)
    unknown[:50] = True
    alpha = np.zeros((100, 100), np.float32)
    alpha[50:80, 20:80] = 0.6
    warp = np.array([[1.0, 0, 0], [0, 1.0, -50.0], [0, 0, 1.0]])
    done = complete_mattes([view(alpha, unknown)], [Placement(WIDE, warp, (100, 50), ("top",))])[0]
    assert done.unknown is None
    assert np.array_equal(done.alpha[50:], alpha[50:])
    widths = (done.alpha[:50] > 0.3).sum(axis=1)
    assert (np.diff(widths) >= 0).all()
    assert widths[0] < 15
    assert widths[-1] in range(55, 62)
    assert np.allclose(done.alpha[:50][done.alpha[:50] > 0], 0.6, atol=0.05)
