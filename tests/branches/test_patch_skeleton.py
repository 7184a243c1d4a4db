from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.patch_skeleton import patch_skeleton
from flowtree.geometry.find_painted import find_painted
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from tests.skeletons import random_skeleton, skeleton_of

CAMERAS = [Camera(yaw, 0.1, (100.0, 190.0), 200, 200) for yaw in (0.0, 90.0)]
NOTHING = PaintedEdit()
HEIGHT = 10.0


def paint(left, right, low, high):
    """Full between these places of the first view's plane [m]."""
    picture = np.zeros((200, 200), np.float32)
    picture[
        round(190 - 10 * high) : round(190 - 10 * low), round(100 + 10 * left) : round(100 + 10 * right)
    ] = 1
    return picture


def cross(*arms, height=8.0):
    """A stem up the y axis with level arms (height, length to the right, depth)."""
    parent, points = [-1], [[0.0, 0.0, 0.0]]
    for y in np.arange(0.5, height + 0.1, 0.5):
        parent.append(len(points) - 1)
        points.append([0.0, y, 0.0])
    for y, length, depth in arms:
        last = round(y / 0.5)
        for share in np.linspace(0, 1, 13)[1:]:
            parent.append(last)
            last = len(points)
            points.append([length * share, y, depth * share])
    made = skeleton_of(np.array(parent), np.array(points), np.random.default_rng(0))
    return replace(made, twig=np.zeros(len(parent), bool))


def patched(plain, painted, edit):
    return patch_skeleton(plain, painted, CAMERAS, [edit, NOTHING], height=HEIGHT)


def test_what_is_erased_goes_and_all_else_stays():
    plain = cross((4.0, 3.0, 0.0), (6.0, -3.0, 0.0))
    patch = patched(plain, cross((6.0, -2.0, 1.0)), PaintedEdit(erase=paint(0.5, 4.0, 3.0, 5.0)))
    assert (patch.painted < 0).all(), "there is nothing of the other tree to take"
    points = patch.skeleton.points
    assert not ((points[:, 0] > 0.5) & (points[:, 1] == 4.0)).any()
    kept = np.isin(np.arange(len(plain.parent)), patch.plain)
    assert kept[plain.points[:, 0] <= 0.0].all()
    away = (plain.points[:, 0] < 0.0)[patch.plain]
    assert np.allclose(patch.skeleton.radius[away], plain.radius[patch.plain[away]])


def test_what_is_added_grows_from_the_branch_beside_it():
    plain = cross((4.0, 2.0, 0.0))
    painted = cross((4.1, 4.0, 0.0), height=7.5)
    patch = patched(plain, painted, PaintedEdit(add=paint(2.5, 5.0, 3.0, 5.0)))
    new = np.flatnonzero(patch.painted >= 0)
    assert patch.skeleton.points[new, 0].max() == 4.0
    assert patch.skeleton.points[new, 0].min() > 1.5, "up to there the old branch bears it"
    old = patch.plain[patch.plain >= 0]
    assert np.array_equal(np.sort(old), np.arange(len(plain.parent))), "nothing of the old tree is lost"
    assert patch.skeleton.particles[0] == plain.particles[0] + 1


def test_what_a_cut_branch_bore_is_borne_along_the_painted_trees_way():
    plain = cross((4.0, 4.0, 0.0))
    painted = cross((6.0, 2.5, 0.0))
    patch = patched(plain, painted, PaintedEdit(erase=paint(0.5, 2.0, 3.0, 5.0)))
    points, parent = patch.skeleton.points, patch.skeleton.parent
    tip = int(np.flatnonzero((points == [4.0, 4.0, 0.0]).all(axis=1))[0])
    assert patch.plain[tip] >= 0
    way = []
    while tip > 0:
        way.append(tip)
        tip = int(parent[tip])
    assert (patch.painted[way] >= 0).any()
    assert not find_painted(
        points[way], CAMERAS, [PaintedEdit(erase=paint(0.5, 2.0, 3.0, 5.0)), NOTHING]
    ).taken.any()


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    left=st.floats(-6, 5),
    low=st.floats(0, 9),
    size=st.floats(0.5, 6),
    kind=st.sampled_from(["add", "erase"]),
)
def test_whatever_is_painted_leaves_one_sound_tree(seed, left, low, size, kind):
    plain, painted = random_skeleton(seed), random_skeleton(seed + 1)
    edit = PaintedEdit(**{kind: paint(left, left + size, low, low + size)})
    patch = patched(plain, painted, edit)
    made = patch.skeleton
    count = len(made.parent)
    assert made.parent[0] == -1
    assert (made.parent[1:] >= 0).all()
    assert (made.parent < np.arange(count)).all()
    assert ((patch.plain >= 0) != (patch.painted >= 0)).all()
    assert (made.radius[1:] <= made.radius[made.parent[1:]] + 1e-7).all()
    old = patch.plain >= 0
    assert np.array_equal(made.points[old], plain.points[patch.plain[old]])
    if kind == "erase":
        places = find_painted(made.points[old], CAMERAS, [edit, NOTHING])
        assert not places.taken[1:].any()
