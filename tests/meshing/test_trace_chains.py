import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.meshing.trace_chains import trace_chains
from tests.skeletons import random_skeleton


def walk_chains(skeleton):
    """The slow way: from every head upward, node by node."""
    n = len(skeleton.parent)
    children = [np.flatnonzero(skeleton.parent == i) for i in range(n)]

    def key(parent, child):
        def direction(a, b):
            way = skeleton.points[b].astype(float) - skeleton.points[a].astype(float)
            length = np.linalg.norm(way)
            return way / length if length > 0 else way

        grand = skeleton.parent[parent]
        straight = 0.0 if grand < 0 else float(np.sum(direction(parent, child) * direction(grand, parent)))
        return skeleton.radius[child], skeleton.particles[child], straight, -child

    best = {i: max(children[i], key=lambda c, i=i: key(i, c)) for i in range(n) if len(children[i])}
    heads = [i for i in range(n) if i == 0 or best[skeleton.parent[i]] != i]
    chains = []
    for head in heads:
        chain = [head] if head == 0 else [skeleton.parent[head], head]
        while chain[-1] in best:
            chain.append(best[chain[-1]])
        chains.append(chain)
    return heads, chains


@given(st.integers(0, 10_000), st.integers(2, 40), st.floats(0.2, 1.0))
@settings(max_examples=25, deadline=None)
def test_the_same_chains_as_walking_node_by_node(seed, nodes, stubborn):
    skeleton = random_skeleton(seed, nodes, stubborn=stubborn, step_in_thickness=0.3)
    chains = trace_chains(skeleton)
    heads, expected = walk_chains(skeleton)
    assert chains.sprout.tolist() == heads
    assert [chains.node[chains.chain == c].tolist() for c in range(len(heads))] == expected


def test_every_segment_belongs_to_exactly_one_chain():
    skeleton = random_skeleton(5, 500, stubborn=0.6)
    chains = trace_chains(skeleton)
    inner = chains.chain[1:] == chains.chain[:-1]
    child, parent = chains.node[1:][inner], chains.node[:-1][inner]
    assert sorted(child.tolist()) == list(range(1, 500))
    assert np.array_equal(skeleton.parent[child], parent)
