import numpy as np

from flowtree.meshing.branch_axes import BranchAxes
from flowtree.meshing.ease_forks import ease_forks

TRUNK = np.array([[0.0, y, 0.0] for y in (0.0, 0.5, 1.0, 1.5)])
LIMB = np.array([[0.0, 1.0, 0.0], [0.5, 1.5, 0.0], [1.0, 2.0, 0.0]])
POINTS = np.concatenate([TRUNK, LIMB[1:]])
PARENT = np.array([-1, 0, 1, 2, 2, 4])


def eased(radius=0.1, *, limb=LIMB, thick=True):
    axes = BranchAxes(
        np.concatenate([TRUNK, limb]),
        np.repeat([radius, 0.7 * radius], [4, len(limb)]),
        np.repeat([0, 1], [4, len(limb)]),
        np.array([1, 1, 2, 3, 4, 4, 5])[: 4 + len(limb)],
    )
    return axes, *ease_forks(
        axes, POINTS, PARENT, np.array([0, 2]), np.full(2, radius), np.array([False, thick])
    )


def test_a_thick_branch_runs_on_from_below_the_fork():
    before, after, bent = eased()
    assert bent.tolist() == [False, True]
    limb = after.center[after.chain == 1]
    assert np.allclose(limb[0], [0.0, 1.0 - 0.16, 0.0])
    way = np.diff(limb, axis=0)
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    turns = np.degrees(np.arccos(np.clip(np.sum(way[1:] * way[:-1], axis=1), -1.0, 1.0)))
    assert turns.max() < 20.0  # at once it would be 45
    assert way[0] @ [0.0, 1.0, 0.0] > 0.95
    assert np.array_equal(limb[-2:], before.center[-2:])
    assert np.array_equal(after.center[after.chain == 0], TRUNK)


def test_the_curve_ends_on_the_branch_and_begins_inside_the_parent():
    _, after, _ = eased()
    limb, radius = after.center[after.chain == 1], after.radius[after.chain == 1]
    assert after.node[after.chain == 1][:5].tolist() == [4] * 5
    assert np.allclose(limb[4], [0.15 / np.sqrt(2.0), 1.0 + 0.15 / np.sqrt(2.0), 0.0])
    assert np.hypot(limb[:2, 0], limb[:2, 2]).max() + radius[:2].max() < 0.1


def test_thin_and_short_branches_stay_as_they_are():
    before, after, bent = eased(thick=False)
    assert not bent.any()
    assert np.array_equal(before.center, after.center)
    stub = np.array([[0.0, 1.0, 0.0], [0.1, 1.1, 0.0]])
    before, after, bent = eased(limb=stub)
    assert not bent.any()
    assert np.array_equal(before.center, after.center)


def test_below_the_root_there_is_nothing():
    _, after, _ = eased(radius=0.3)  # the limb's curve fits, and 1.6 radii below reach half way down
    assert np.allclose(after.center[after.chain == 1][0], [0.0, 1.0 - 0.48, 0.0])
    axes = BranchAxes(np.concatenate([TRUNK, LIMB]), np.full(7, 0.1), np.repeat([0, 1], [4, 3]), np.arange(7))
    far, bent = ease_forks(axes, POINTS, PARENT, np.array([0, 0]), np.full(2, 0.1), np.array([False, True]))
    assert bent[1]
    assert np.allclose(far.center[far.chain == 1][0], 0.0)
