import numpy as np

from flowtree.flow.join_traces import join_traces


def _paths(begin, end, joined, last, start_beside=False):
    """Places that name their particle and step."""
    records = [
        ([p, 10.0 + s, 0.0], s, p)
        for p, (b, e) in enumerate(zip(begin, end, strict=True))
        if b >= 0
        for s in range(b, (last if e < 0 else e) + 1)
    ]
    rng = np.random.default_rng(0)
    rng.shuffle(records)
    points, step, particle = zip(*records, strict=True)
    start = np.array([[p, 10.0 + b if start_beside else 0.0, 0.0] for p, b in enumerate(begin)], np.float32)
    return join_traces(
        start,
        np.array(points, np.float32),
        np.array(step, np.int32),
        np.array(particle, np.int32),
        begin_step=np.array(begin, np.int32),
        end_step=np.array(end, np.int32),
        joined=np.array(joined, np.int32),
        last=last,
    )


def test_a_particle_that_joined_continues_in_its_hosts_next_place():
    traces = _paths([0, 1], [5, 2], [-1, 0], 6)
    place = {tuple(p): k for k, p in enumerate(traces.points.tolist())}
    last_own = place[1.0, 12.0, 0.0]
    assert traces.parent[last_own] == place[0.0, 13.0, 0.0]
    assert traces.particles[place[0.0, 13.0, 0.0]] == 2
    assert traces.particles[place[0.0, 12.0, 0.0]] == 1
    assert traces.parent[place[0.0, 15.0, 0.0]] == 0
    assert traces.step[last_own] == 2


def test_a_path_enters_a_limb_at_a_slant():
    idle = [-1] * 4
    traces = _paths([0, *idle, 0], [30, *idle, 10], [-1, *idle, 0], 30)
    place = {tuple(p): k for k, p in enumerate(traces.points.tolist())}
    # Five to the side: five on is the first place within 50 degrees, the next one would be a square fork.
    assert traces.parent[place[5.0, 20.0, 0.0]] == place[0.0, 25.0, 0.0]
    assert traces.particles[place[0.0, 25.0, 0.0]] == 2
    assert traces.particles[place[0.0, 24.0, 0.0]] == 1


def test_who_set_off_inside_a_limb_goes_to_its_next_place():
    idle = [-1] * 4
    traces = _paths([0, *idle, 9], [30, *idle, 10], [-1, *idle, 0], 30, start_beside=True)
    place = {tuple(p): k for k, p in enumerate(traces.points.tolist())}
    assert traces.parent[place[5.0, 20.0, 0.0]] == place[0.0, 21.0, 0.0]


def test_who_joined_one_that_joined_is_counted_all_the_way():
    traces = _paths([0, 0, 0], [8, 4, 2], [-1, 0, 1], 8)
    assert traces.particles[0] == 3
    assert sorted(set(traces.particles.tolist())) == [1, 2, 3]
    assert len(traces.parent) == 1 + 9 + 5 + 3


def test_lost_ones_and_those_that_never_set_off_hang_on_the_nearest_path():
    traces = _paths([0, 2, -1], [5, -1, -1], [-1, -1, -1], 5)
    place = {tuple(p): k for k, p in enumerate(traces.points.tolist())}
    assert traces.parent[place[1.0, 15.0, 0.0]] == place[0.0, 15.0, 0.0]
    assert traces.parent[place[2.0, 0.0, 0.0]] == 0, "the root is nearer than any path"
    assert traces.particles[0] == 3


def test_where_nobody_arrived_the_foot_takes_all():
    traces = _paths([0, 0], [-1, -1], [-1, -1], 3)
    assert (traces.parent == 0).sum() == 2
    assert traces.particles[0] == 2
