import numpy as np
import pytest

from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.geometry.projection import plane_to_pixels
from tests.attraction.scenes import LEVEL, level_limbs


def distances(places, graph, camera):
    """Of pixels (n, 2) to the graph [pixels]."""
    nodes = plane_to_pixels(graph.points, camera)
    _, nearest = nearest_on_segments(places[:, None], nodes[graph.parent[1:]][None], nodes[1:][None])
    return np.linalg.norm(nearest - places[:, None], axis=2).min(axis=1)


@pytest.mark.parametrize("leafy", [True, False])
def test_a_limb_leaves_the_stem_where_the_picture_shows_it(leafy):
    photo, matte, camera = level_limbs()
    graph = trace_attractor_graph(photo, matte, camera, leafy=leafy)
    for start, end in LEVEL:
        share = np.linspace(0.15, 0.9, 40)[:, None]
        line = np.array(start) * (1 - share) + np.array(end) * share
        assert distances(line, graph, camera).max() < 4.0
    # Nothing slants from lower on the stem to a limb: off the limbs and the stem there is no line.
    nodes = plane_to_pixels(graph.points, camera)
    child = np.arange(1, len(graph.parent))
    middle = 0.5 * (nodes[child] + nodes[graph.parent[child]])
    inside = matte.alpha[tuple(np.floor(middle[:, ::-1]).astype(int).clip(0, (511, 399)).T)] > 0.5
    assert inside.mean() > 0.95
