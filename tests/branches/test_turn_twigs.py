from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.turn_twigs import turn_twigs
from flowtree.geometry.cover_canvas import CELLS, lay_canvas
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.params import TwigParams
from tests.crowns import CENTRE, HEIGHT, ball_crown, camera_at, plane_of

CROWN = ball_crown(0.35, branches=60)
FIELDS = ("parent", "points", "radius", "particles", "level", "twig")
#: As many twigs that nothing need be thickened for them.
ENOUGH = TwigParams(most=200_000)


def turned(scene, params=ENOUGH, seed=0, leafy=False):
    return turn_twigs(*scene.inputs, height=HEIGHT, leafy=leafy, params=params, seed=seed)


def error(skeleton, scene):
    """Squared error of the wood's alpha over the cells of all views."""
    total = 0.0
    for matte, camera in zip(scene.mattes, scene.cameras, strict=True):
        canvas = lay_canvas(matte.alpha, matte.unknown, camera, cell=HEIGHT / CELLS)
        stood = canvas.with_tree(skeleton.parent, skeleton.points, skeleton.radius)
        total += float((stood.missing() ** 2).sum())
    return total


def check_tree(made):
    count = len(made.parent)
    assert made.parent[0] == -1
    assert ((made.parent[1:] >= 0) & (made.parent[1:] < np.arange(1, count))).all()
    assert np.isfinite(made.points).all()
    assert (made.radius[1:] <= made.radius[made.parent[1:]] * (1 + 1e-6)).all()
    assert (made.particles[1:] <= made.particles[made.parent[1:]]).all()
    for name in FIELDS:
        assert len(getattr(made, name)) == count


def forked(tilt):
    """A stem with one long thin branch to the right, that many degrees above the level."""
    out = np.array([np.cos(np.radians(tilt)), np.sin(np.radians(tilt)), 0.0])
    points = [[0, 0, 0], [0, 5.0, 0], *([0, 5.0, 0] + 0.2 * k * out for k in range(1, 9)), [0, 6.0, 0]]
    parent = [-1, 0, *range(1, 9), 1]
    return Skeleton(
        parent=np.array(parent, np.int32),
        points=np.array(points, np.float32),
        radius=np.array([0.06, 0.05, *[0.02] * 8, 0.04], np.float32),
        particles=np.array([60, 60, *[1] * 8, 59], np.int32),
        level=np.array([0, 0, *[1] * 8, 0], np.int32),
        twig=np.zeros(11, np.bool_),
    )


def drawn(skeleton):
    """The mattes of a skeleton, as it would be seen."""
    mattes = []
    cameras = [camera_at(yaw) for yaw in (0.0, 90.0)]
    for camera in cameras:
        right, up = plane_of(camera)
        axis = np.array([np.cos(np.radians(camera.yaw)), -np.sin(np.radians(camera.yaw))])
        alpha = np.zeros(right.shape, np.float32)
        for node in range(1, len(skeleton.parent)):
            for share in np.linspace(0, 1, 60):
                place = (1 - share) * skeleton.points[skeleton.parent[node]] + share * skeleton.points[node]
                gap = np.hypot(right - place[[0, 2]] @ axis, up - place[1])
                alpha = np.maximum(alpha, gap < 0.03)
        mattes.append(Matte(alpha.astype(np.float32), np.zeros((*alpha.shape, 3), np.uint8), "trimap"))
    return mattes, cameras


@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.floats(0, 90), most=st.integers(0, 5000))
def test_any_parameters_give_a_tree(seed, turn, most):
    made = turned(CROWN, TwigParams(turn=turn, most=most), seed)
    check_tree(made)
    thick = CROWN.skeleton.particles > 16
    assert np.array_equal(made.points[made.particles > 16], CROWN.skeleton.points[thick]), "limbs stay"


def test_the_wood_comes_nearer_to_the_mattes():
    assert error(turned(CROWN), CROWN) < error(CROWN.skeleton, CROWN)


def test_a_branch_turns_to_where_both_mattes_show_it():
    right, wrong = forked(25.0), forked(14.0)
    mattes, cameras = drawn(right)
    scene = replace(CROWN, skeleton=wrong, mattes=mattes, cameras=cameras)
    ends = []
    for seed in range(30):
        made = turned(scene, seed=seed)
        check_tree(made)
        ends += [np.linalg.norm(tip - right.points[9]) for tip in made.points[made.particles == 1][-1:]]
    before = np.linalg.norm(wrong.points[9] - right.points[9])
    assert min(ends) < 0.5 * before, "of few draws one fits"


def test_what_stands_right_stays_and_what_no_matte_shows_goes():
    right = forked(25.0)
    mattes, cameras = drawn(right)
    scene = replace(CROWN, skeleton=right, mattes=mattes, cameras=cameras)
    assert np.array_equal(turned(scene).points, right.points)
    stem = right.particles > 1
    mattes, _ = drawn(Skeleton(*(getattr(right, name)[: 2 if name else 0] for name in FIELDS)))
    gone = turned(replace(scene, mattes=mattes))
    assert len(gone.parent) == stem.sum()


def test_turned_by_nothing_and_with_twigs_enough_all_stays():
    made = turned(CROWN, TwigParams(turn=0, most=200_000))
    for name in FIELDS:
        assert np.array_equal(getattr(made, name), getattr(CROWN.skeleton, name))


def test_branches_thicker_than_the_mattes_show_them_become_thinner():
    skeleton = CROWN.skeleton
    thick = replace(skeleton, radius=np.maximum(skeleton.radius, 0.5 * skeleton.radius.max()))
    made = turned(replace(CROWN, skeleton=thick))
    check_tree(made)
    assert made.radius[made.particles == 1].mean() < 0.95 * thick.radius[thick.particles == 1].mean()


def test_the_last_branches_of_a_leafy_tree_turn_and_none_becomes_thicker():
    made = turned(CROWN, leafy=True)
    check_tree(made)
    assert error(made, CROWN) < error(CROWN.skeleton, CROWN)
    assert np.array_equal(
        made.points[made.particles > 2], CROWN.skeleton.points[CROWN.skeleton.particles > 2]
    )
    assert made.radius.max() == CROWN.skeleton.radius.max()
    assert made.radius.min() >= 0.49 * CROWN.skeleton.radius.min()


def test_too_few_twigs_thicken_the_branches_that_bear_them():
    dense = ball_crown(0.8, branches=30)
    made = turned(dense, TwigParams(turn=0, most=50))
    check_tree(made)
    thin = dense.skeleton.particles == 1
    assert made.radius[thin].mean() > 1.5 * dense.skeleton.radius[thin].mean()
    assert made.radius[0] == pytest.approx(dense.skeleton.radius[0])


def test_equal_seeds_give_equal_bytes_and_others_do_not():
    one, same, other = (turned(CROWN, seed=s) for s in (5, 5, 6))
    for name in FIELDS:
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert one.points.shape != other.points.shape or not np.array_equal(one.points, other.points)


def test_a_hole_loses_its_branches():
    right, up = plane_of(CROWN.cameras[0])
    hole = np.hypot(right - 0.8, up - CENTRE) < 0.8
    alpha = np.where(hole, 0, CROWN.mattes[0].alpha).astype(np.float32)
    holed = replace(CROWN, mattes=[replace(CROWN.mattes[0], alpha=alpha), CROWN.mattes[1]])

    def inside(made):
        return (np.hypot(made.points[:, 0] - 0.8, made.points[:, 1] - CENTRE) < 0.7).sum()

    assert inside(turned(holed)) < 0.8 * inside(CROWN.skeleton)
