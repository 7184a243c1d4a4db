import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.attraction.clear_painted import clear_painted, lead_painted
from flowtree.model.attractor import LimbTree
from flowtree.model.camera import Camera
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import LimbField
from tests.branches.traces import random_traces

CAMERAS = [Camera(yaw, 0.01, (100.0, 190.0), 200, 200) for yaw in (0.0, 90.0)]
NOTHING = PaintedEdit()


def stem():
    points = np.zeros((31, 3), np.float32)
    points[:, 1] = np.linspace(0, 1.5, 31)
    return LimbTree(np.arange(-1, 30, dtype=np.int32), points, np.full(31, np.nan, np.float32))


def painted(start, end, reach=10.0):
    return PaintedEdit(directions=(np.array([start, end], np.float32),), reach=(reach,))


def test_where_nothing_is_painted_limbs_and_field_stay():
    limbs = stem()
    assert clear_painted(limbs, CAMERAS, [NOTHING, NOTHING]) is limbs
    field = LimbField(np.ones((3, 4, 5, 3), np.float32), np.zeros(3, np.float32), 0.1)
    assert lead_painted(field, CAMERAS, [NOTHING, NOTHING]).vectors is field.vectors


def test_a_limb_ends_where_a_direction_is_painted_across_it_and_stays_along_it():
    across = painted([60, 90], [140, 90])  # a metre above the foot, to the right
    left = clear_painted(stem(), CAMERAS, [across, NOTHING])
    assert 0.8 < left.points[:, 1].max() < 0.95
    along = painted([100, 60], [100, 120])  # downwards, as sap flows
    assert len(clear_painted(stem(), CAMERAS, [along, NOTHING]).parent) == 31
    upward = painted([100, 120], [100, 60])
    assert len(clear_painted(stem(), CAMERAS, [upward, NOTHING]).parent) < 20


def test_on_a_painted_direction_the_limbs_field_goes_along_it_whatever_the_depth():
    vectors = np.tile(np.array([0.0, -1.0, 0.0], np.float32), (21, 21, 21, 1))
    field = LimbField(vectors, np.array([-1, 0, -1], np.float32), 0.1)
    made = lead_painted(field, CAMERAS, [painted([60, 90], [140, 90]), NOTHING]).vectors
    assert np.allclose(made[8:13, 10], [1, 0, 0], atol=1e-6)
    assert np.array_equal(made[:, 12:], vectors[:, 12:])
    assert np.array_equal(made[:, :9], vectors[:, :9])
    assert np.linalg.norm(made, axis=-1).max() < 1.0 + 1e-6


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), x=st.floats(0, 200), y=st.floats(0, 200), reach=st.floats(0.1, 80))
def test_whatever_is_painted_leaves_a_tree(seed, x, y, reach):
    traces = random_traces(seed)
    limbs = LimbTree(traces.parent, traces.points, np.full(len(traces.parent), np.nan, np.float32))
    left = clear_painted(limbs, CAMERAS, [painted([x, y], [y, x + 1], reach), NOTHING])
    count = len(left.parent)
    assert count == len(left.points) == len(left.radius) >= 2
    assert left.parent[0] == -1
    assert (left.parent[1:] >= 0).all()
    assert (left.parent < np.arange(count)).all()
    kept = {point.tobytes() for point in limbs.points}
    assert all(point.tobytes() in kept for point in left.points)
