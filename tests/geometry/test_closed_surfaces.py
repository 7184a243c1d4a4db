import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.closed_surfaces import is_closed, is_watertight, weld

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.mark.parametrize("judge", [is_closed, is_watertight])
def test_a_hole_and_a_flipped_triangle_are_found(judge):
    assert judge(TETRAHEDRON)
    assert judge(TETRAHEDRON[:, ::-1])  # inside out encloses as much
    assert not judge(TETRAHEDRON[1:])
    assert not judge(np.concatenate([TETRAHEDRON[:1, ::-1], TETRAHEDRON[1:]]))
    assert not judge(np.zeros((0, 3), np.int32))
    assert not judge(np.array([[3, 3, 3], [1, 1, 2]]))


def test_coincident_pieces_are_closed_but_no_manifold():
    twins = np.concatenate([TETRAHEDRON, TETRAHEDRON])
    assert is_closed(twins)
    assert not is_watertight(twins)
    assert is_watertight(np.concatenate([TETRAHEDRON, TETRAHEDRON + 4]))


def test_a_collapsed_triangle_opens_nothing_but_is_a_flaw():
    collapsed = np.concatenate([TETRAHEDRON, [[0, 0, 1]]])
    assert is_closed(collapsed)
    assert not is_watertight(collapsed)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_welding_undoes_any_split_of_vertices(seed):
    rng = np.random.default_rng(seed)
    corners = rng.normal(size=(4, 3)).astype(np.float32)
    order = rng.permutation(12)  # every corner of every triangle is a vertex of its own, in any order
    positions = np.empty((12, 3), np.float32)
    positions[order] = corners[TETRAHEDRON.ravel()]
    split = order.reshape(4, 3)
    assert not is_closed(split)
    welded = weld(positions, split)
    assert is_watertight(welded)
    numbers, where = np.unique(welded, return_index=True)
    assert len(numbers) == 4
    assert len(np.unique(positions[split.ravel()[where]], axis=0)) == 4


def test_welding_nothing_gives_nothing():
    assert weld(np.zeros((0, 3), np.float32), np.zeros((0, 3), np.int32)).shape == (0, 3)
