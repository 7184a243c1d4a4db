import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.build_skeleton import build_skeleton
from flowtree.geometry.parent_array import child_count, sum_to_root
from flowtree.model.traces import FlowTraces
from flowtree.params import BranchParams
from tests.branches.traces import own_of, random_traces

PARAMS = st.builds(
    BranchParams,
    stride=st.integers(1, 50),
    smoothing=st.integers(0, 100),
    least_angle=st.floats(0, 80),
    longest_lone=st.floats(0.001, 10),
    shortest=st.floats(0, 0.5),
    limb_radius=st.floats(0, 0.2),
)
# Nothing is pruned and no fork moves: what is left is thinning and smoothing.
GENTLE = {"shortest": 0, "limb_radius": 0, "longest_lone": 10, "least_angle": 0}


def check_tree(skeleton, traces):
    count = len(skeleton.parent)
    assert skeleton.parent[0] == -1
    assert (skeleton.parent[1:] >= 0).all()
    assert (skeleton.parent < np.arange(count)).all()
    assert np.isfinite(skeleton.points).all()
    assert np.array_equal(skeleton.points[0], traces.points[0])
    assert skeleton.particles[0] == traces.particles[0]
    own = own_of(skeleton.parent, skeleton.particles)
    assert (own >= 0).all()
    assert (own[child_count(skeleton.parent) == 0] > 0).all()
    assert (skeleton.radius == 0).all()
    assert not skeleton.twig.any()
    rise = np.diff(np.stack([skeleton.level[skeleton.parent[1:]], skeleton.level[1:]]), axis=0)
    assert skeleton.level[0] == 0
    assert np.isin(rise, [0, 1]).all()
    for name in ("parent", "points", "radius", "particles", "level", "twig"):
        assert len(getattr(skeleton, name)) == count


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(2, 150), params=PARAMS, collapsed=st.booleans())
def test_any_traces_and_parameters_give_a_tree_with_all_particles(seed, count, params, collapsed):
    traces = random_traces(seed, count, collapsed=collapsed)
    check_tree(build_skeleton(traces, params=params), traces)


@pytest.mark.parametrize("low", [True, False])
def test_parameters_at_their_bounds(low):
    bounds = {
        "stride": (1, 50),
        "smoothing": (0, 100),
        "least_angle": (0, 80),
        "longest_lone": (1e-9, 10),
        "shortest": (0, 0.5),
        "limb_radius": (0, 0.2),
    }
    params = BranchParams(**{name: pair[not low] for name, pair in bounds.items()})
    traces = random_traces(5)
    check_tree(build_skeleton(traces, params=params), traces)


def test_without_smoothing_nodes_stay_where_the_particles_were():
    traces = random_traces(1, 200)
    made = build_skeleton(traces, params=BranchParams(smoothing=0, stride=4))
    was = {point.tobytes() for point in traces.points}
    assert all(point.tobytes() in was for point in made.points)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), stride=st.integers(1, 8), smoothing=st.integers(0, 20))
def test_every_tip_stays_where_nothing_is_pruned(seed, stride, smoothing):
    traces = random_traces(seed)
    made = build_skeleton(traces, params=BranchParams(stride=stride, smoothing=smoothing, **GENTLE))
    tips, ends = child_count(traces.parent) == 0, child_count(made.parent) == 0
    assert {p.tobytes() for p in traces.points[tips]} == {p.tobytes() for p in made.points[ends]}


def test_a_stride_of_one_keeps_every_point():
    traces = random_traces(3)
    made = build_skeleton(traces, params=BranchParams(stride=1, smoothing=0, **GENTLE))
    assert sorted(map(bytes, made.points)) == sorted(map(bytes, traces.points))
    assert sorted(made.particles) == sorted(traces.particles)


def test_smoothing_takes_out_the_zigzag():
    zigzag = np.zeros((41, 3), np.float32)
    zigzag[:, 1] = np.arange(41) * 0.1
    zigzag[1:, 0] = np.where(np.arange(40) % 2, 0.05, -0.05)
    traces = FlowTraces(
        parent=np.arange(-1, 40, dtype=np.int32),
        points=zigzag,
        particles=np.full(41, 10, np.int32),
        step=np.arange(41, dtype=np.int32)[::-1].copy(),
    )
    bend = [
        np.abs(np.diff(build_skeleton(traces, params=BranchParams(stride=1, smoothing=n)).points[:, 0], n=2))
        for n in (0, 10)
    ]
    assert bend[1][2:-2].max() < 0.02 * bend[0][2:-2].min()


def test_two_points_are_a_tree():
    traces = FlowTraces(
        parent=np.int32([-1, 0]),
        points=np.float32([[0, 0, 0], [0, 1, 0]]),
        particles=np.int32([3, 3]),
        step=np.int32([1, 0]),
    )
    made = build_skeleton(traces)
    check_tree(made, traces)
    assert made.points.tolist() == [[0, 0, 0], [0, 1, 0]]


def test_equal_traces_give_equal_bytes():
    one, same = (build_skeleton(random_traces(7)) for _ in range(2))
    for name in ("parent", "points", "particles", "level"):
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()


def test_particles_pass_every_node_of_those_behind_it():
    made = build_skeleton(random_traces(9))
    assert np.array_equal(sum_to_root(made.parent, own_of(made.parent, made.particles)), made.particles)
