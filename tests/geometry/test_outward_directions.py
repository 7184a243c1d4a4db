import numpy as np
import pytest

from flowtree.geometry.outward_directions import outward_directions


def ball(count, seed=0):
    rng = np.random.default_rng(seed)
    out = rng.normal(size=(count, 3))
    return out / np.linalg.norm(out, axis=1, keepdims=True) * rng.random((count, 1)) ** (1 / 3)


@pytest.mark.parametrize("count", [9, 40, 5000])
def test_out_of_a_ball_is_away_from_its_middle(count):
    points = ball(count)
    found = outward_directions(points)
    assert np.allclose(np.linalg.norm(found, axis=1), 1.0, atol=1e-5)
    away = points - points.mean(axis=0)
    outer = np.linalg.norm(away, axis=1) >= 0.6
    cosine = (found * away).sum(axis=1) / np.linalg.norm(away, axis=1)
    assert cosine[outer].min() > 0.7


def test_out_of_two_clumps_the_gap_between_them_is_outside_too():
    apart = np.array([2.5, 0, 0])
    points = np.concatenate([ball(3000) - apart, ball(3000, 1) + apart])
    found = outward_directions(points)
    inner = (np.abs(points[:, 0]) < 1.9) & (np.abs(points[:, 1:]).max(axis=1) < 0.5)
    from_middle = np.sign(points[inner, 0]) * found[inner, 0]
    assert from_middle.mean() < 0.5, "the clumps' own shape counts, not only the way from the middle"
    assert (np.linalg.norm(found[np.abs(points[:, 0]) > 3], axis=1) > 0.99).all()


def test_no_extent_no_direction():
    assert not outward_directions(np.zeros((3, 3))).any()
    assert outward_directions(np.zeros((0, 3))).shape == (0, 3)
    flat = outward_directions(np.random.default_rng(0).random((200, 3)) * [1, 1, 0])
    assert np.isfinite(flat).all()
    assert not flat[:, 2].any()


def test_moving_and_scaling_the_cloud_changes_nothing():
    points = ball(500)
    moved = outward_directions(7.0 * points + [1, 2, 3])
    assert np.allclose(moved, outward_directions(points), atol=0.1)
