import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.relax_forks import relax_forks
from flowtree.geometry.parent_array import child_count, main_child, sum_to_root
from tests.branches.traces import own_of, random_traces

LONGEST = 14  # nodes beside a limb that are looked at


class Slow:
    """The same rule on dictionaries, branch by branch: every node knows its parent and its own particles."""

    def __init__(self, parent, points, own):
        self.parent = dict(enumerate(parent.tolist()))
        self.own = dict(enumerate(own.tolist()))
        self.points = points

    def look(self):
        """Children, what carries each node on, and orders, as they are now."""
        self.children = {node: [] for node in self.parent}
        for node, above in self.parent.items():
            if above >= 0:
                self.children[above].append(node)
        total = dict(self.own)
        walk = [0]
        for node in walk:
            walk += self.children[node]
        for node in reversed(walk[1:]):
            total[self.parent[node]] += total[node]
        self.ahead = {
            node: max(below, key=lambda k: (total[k], -k), default=None)
            for node, below in self.children.items()
        }
        self.order = {0: 0}
        for node in walk[1:]:
            above = self.parent[node]
            self.order[node] = self.order[above] + (self.ahead[above] != node)

    def beside(self, start, least_angle):
        """How far a side branch runs along its limb: [(its node, the limb's beside it)], or nothing."""
        side, limb, way = start, self.parent[start], []
        for _ in range(LONGEST):
            way.append((side, limb))
            if self.ahead[limb] is None:
                return way[:-1], way[-1]
            along = self.points[self.ahead[limb]] - self.points[limb]
            over = self.points[side] - self.points[limb]
            size = np.linalg.norm(along) * np.linalg.norm(over)
            if along @ over < np.cos(np.radians(least_angle)) * size:
                return way[:-1], way[-1]
            side, limb = self.ahead[side], self.ahead[limb]
            if side is None:
                break
        return [], None

    def relax(self, least_angle):
        order = 1
        while True:
            self.look()
            starts = [k for k in self.order if self.order[k] == order]
            if not starts:
                return
            starts = [k for k in starts if self.order[self.parent[k]] < order]
            moves = [self.beside(start, least_angle) for start in sorted(starts)]
            moves = [(way, end) for way, end in moves if way]
            for way, (last, limb) in moves:
                nodes = [node for node, _ in way]
                for node, at in way:
                    heir = self.ahead[at]
                    self.own[heir] += self.own.pop(node)
                    del self.parent[node]
                    for child in self.children[node]:
                        if child not in nodes and child != last:
                            self.parent[child] = heir
                self.parent[last] = limb
            order = max(order - 1, 1) if moves else order + 1


def named(parent, points, own):
    """What does not depend on numbers: every place with its particles and the place it grows from."""
    return sorted((bytes(points[k]), int(own[k]), bytes(points[p]) if p >= 0 else b"") for k, p in parent)


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(2, 90), least_angle=st.floats(0, 80))
def test_equals_the_slow_way(seed, count, least_angle):
    traces = random_traces(seed, count)
    points = traces.points.astype(float) + np.arange(count)[:, None] * 1e-9  # every place is another one
    own = own_of(traces.parent, traces.particles)
    parent, places, kept, _ = relax_forks(
        traces.parent, points, own, np.zeros(len(own), bool), least_angle=least_angle
    )
    slow = Slow(traces.parent, points, own)
    slow.relax(least_angle)
    assert named(enumerate(parent.tolist()), places, kept) == named(slow.parent.items(), points, slow.own)


def fork_angles(parent, points, own):
    """Of every side branch to what carries its limb on [degrees]."""
    ahead = main_child(parent, sum_to_root(parent, own))
    sides = np.flatnonzero((parent >= 0) & (ahead[np.maximum(parent, 0)] != np.arange(len(parent))))
    over, along = points[sides] - points[parent[sides]], points[ahead[parent[sides]]] - points[parent[sides]]
    size = np.linalg.norm(over, axis=1) * np.linalg.norm(along, axis=1)
    return sides, np.degrees(np.arccos(np.clip(np.sum(over * along, axis=1) / size, -1, 1)))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), least_angle=st.floats(5, 60))
def test_side_branches_leave_wide_wherever_they_part_in_time(seed, least_angle):
    traces = random_traces(seed, 120)
    points, own = traces.points.astype(float), own_of(traces.parent, traces.particles)
    free = np.zeros(len(own), bool)
    parent, points, own, _ = relax_forks(traces.parent, points, own, free, least_angle=least_angle)
    slow = Slow(parent, points, own)
    slow.look()
    sides, angles = fork_angles(parent, points, own)
    for side in sides[angles < least_angle - 1e-6]:
        assert slow.beside(int(side), least_angle) == ([], None), "it could have left farther out"


@settings(max_examples=20, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(1, 120),
    least_angle=st.floats(0, 80),
    collapsed=st.booleans(),
)
def test_no_particle_and_no_tip_is_lost(seed, count, least_angle, collapsed):
    traces = random_traces(seed, max(count, 2), collapsed=collapsed)
    own = own_of(traces.parent, traces.particles)
    free = np.zeros(len(own), bool)
    parent, points, kept, _ = relax_forks(
        traces.parent, traces.points.astype(float), own, free, least_angle=least_angle
    )
    assert parent[0] == -1
    assert (parent[1:] >= 0).all()
    assert (parent < np.arange(len(parent))).all()
    assert kept.sum() == own.sum()
    # A branch that runs past its limb's end carries that on: then the limb's tip is none any more.
    before, after = traces.points[child_count(traces.parent) == 0], points[child_count(parent) == 0]
    assert {bytes(p) for p in after} <= {bytes(p) for p in before.astype(float)}


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_relaxed_forks_are_left_alone(seed):
    traces = random_traces(seed, 100)
    own, free = own_of(traces.parent, traces.particles), np.zeros(len(traces.parent), bool)
    once = relax_forks(traces.parent, traces.points.astype(float), own, free, least_angle=30)
    again = relax_forks(*once, least_angle=30)
    for a, b in zip(once, again, strict=True):
        assert np.array_equal(a, b)


def test_a_branch_that_runs_along_its_limb_leaves_where_they_part():
    """A limb up the y axis; beside it, a tenth to the right, a branch that turns away at 0.5 m."""
    limb = [[0, 0.1 * k, 0] for k in range(11)]
    side = [[0.01, 0.1 * k, 0] for k in (1, 2, 3, 4)] + [[0.1, 0.5, 0], [0.3, 0.6, 0]]
    parent = np.array([*range(-1, 10), 0, *range(11, 16)], np.int32)
    own = np.zeros(17, int)
    own[[10, 16]] = 5, 2
    points = np.array([*limb, *side], float)
    made, places, kept, _ = relax_forks(parent, points, own, np.zeros(17, bool), least_angle=28)
    fork = int(np.flatnonzero(child_count(made) == 2)[0])
    assert places[fork].tolist() == pytest.approx([0, 0.4, 0])
    assert len(made) == 13
    assert kept.sum() == 7
    _, angles = fork_angles(made, places, kept)
    assert angles == pytest.approx([45.0])


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), least_angle=st.floats(1, 80))
def test_limbs_of_the_pictures_stay(seed, least_angle):
    """What carries every node on is such a limb: their nodes and forks are all there afterwards."""
    traces = random_traces(seed)
    own = own_of(traces.parent, traces.particles)
    main = main_child(traces.parent, traces.particles)
    still = np.zeros(len(own), bool)
    still[0] = True
    for node in range(len(own)):  # two branches in full: the trunk, and one that leaves it
        still[node] |= node > 0 and still[traces.parent[node]] and (main[traces.parent[node]] == node)
    parent, points, _, left = relax_forks(
        traces.parent, traces.points.astype(float), own, still, least_angle=least_angle
    )
    assert left.sum() == still.sum()
    assert np.array_equal(np.sort(points[left], axis=0), np.sort(traces.points[still].astype(float), axis=0))
    assert left[parent[left & (parent >= 0)]].all()
