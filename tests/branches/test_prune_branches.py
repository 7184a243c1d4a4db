import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.prune_branches import STUB, prune_branches
from flowtree.geometry.parent_array import sum_to_root
from tests.branches.traces import own_of, random_traces


def by_walking(parent, points, own, *, shortest, limb_radius, longest_lone):
    """Branch by branch, from the root out: which nodes stay, and how many particles each then has."""
    children = [np.flatnonzero(parent == k).tolist() for k in range(len(parent))]
    behind = {}

    def measure(node):  # particles and the way to the farthest tip
        found = [measure(child) for child in children[node]]
        ways = [
            way + np.linalg.norm(points[child] - points[node])
            for child, (_, way) in zip(children[node], found, strict=True)
        ]
        behind[node] = own[node] + sum(count for count, _ in found), max(ways, default=0.0)
        return behind[node]

    measure(0)
    kept, total = {}, behind[0][0]

    def visit(node):
        kept[node] = own[node]
        main = max(children[node], key=lambda k: (behind[k][0], -k), default=None)
        for child in children[node]:
            count, way = behind[child]
            length = way + np.linalg.norm(points[child] - points[node])
            inside = shortest + STUB * limb_radius * np.sqrt(behind[node][0] / max(total, 1))
            if child != main and (length < inside or length > longest_lone * np.sqrt(count)):
                kept[node] += count
            else:
                visit(child)

    visit(0)
    return kept


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    shortest=st.floats(0, 1),
    limb=st.floats(0, 0.3),
    longest_lone=st.floats(0.01, 3),
    collapsed=st.booleans(),
)
def test_equals_walking_the_branches(seed, shortest, limb, longest_lone, collapsed):
    traces = random_traces(seed, 60, collapsed=collapsed)
    points, own = traces.points.astype(float), own_of(traces.parent, traces.particles)
    rule = {"shortest": shortest, "limb_radius": limb, "longest_lone": longest_lone}
    parent, left, kept, _ = prune_branches(traces.parent, points, own, np.zeros(len(own), bool), **rule)
    expected = by_walking(traces.parent, points, own, **rule)
    stays = sorted(expected)
    assert np.array_equal(left, points[stays])
    assert kept.tolist() == [expected[k] for k in stays]
    assert [stays[p] if p >= 0 else -1 for p in parent] == [traces.parent[k] for k in stays]
    assert kept.sum() == traces.particles[0]
    assert sum_to_root(parent, kept)[0] == traces.particles[0]


def limb_with_a_side_branch(length, particles=1):
    parent = np.array([-1, 0, 1, 2, 1], np.int32)
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 3, 0], [length, 1, 0]], float)
    return parent, points, np.array([0, 0, 0, 20, particles])


def test_too_short_and_too_long_alone_go():
    rule = {"shortest": 0.1, "limb_radius": 0.1 / STUB, "longest_lone": 1.0}
    for length, particles, nodes in (
        *((0.15, 1, 4), (0.25, 1, 5), (0.9, 1, 5), (1.1, 1, 4)),
        *((1.9, 4, 5), (2.1, 4, 4)),
    ):
        tree = limb_with_a_side_branch(length, particles)
        parent, _, own, _ = prune_branches(*tree, np.zeros(len(tree[0]), bool), **rule)
        kept, _, _, limb = prune_branches(*tree, np.ones(len(tree[0]), bool), **rule)
        assert len(kept) == len(tree[0]), "a limb of the pictures stays, whatever it is"
        assert limb.all()
        assert len(parent) == nodes, f"a branch of {length} m and {particles} particles"
        assert own.sum() == 20 + particles


def test_the_main_branch_never_goes():
    parent, points, own = limb_with_a_side_branch(1.0)
    free = np.zeros(len(own), bool)
    left, _, kept, _ = prune_branches(
        parent, points, own, free, shortest=99, limb_radius=99, longest_lone=1e-9
    )
    assert left.tolist() == [-1, 0, 1, 2]
    assert kept.tolist() == [0, 1, 0, 20]
