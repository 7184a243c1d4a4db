import numpy as np

from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.geometry.projection import plane_to_pixels
from flowtree.params import AttractionParams
from tests.attraction.scenes import LEVEL, level_limbs


def test_a_leafy_trees_limbs_before_the_sky_are_all_followed_and_the_bare_ones_measured():
    photo, matte, camera = level_limbs(leaves=True)
    # One seed on the silhouette: the others' paths begin at what is seen of the limbs.
    graph = trace_attractor_graph(photo, matte, camera, leafy=True, params=AttractionParams(seed_count=1))
    nodes = plane_to_pixels(graph.points, camera)
    for start, end in LEVEL:
        line = np.array(start) * 0.3 + np.array(end) * 0.7
        nearest = int(np.linalg.norm(nodes - line, axis=1).argmin())
        assert np.linalg.norm(nodes[nearest] - line) < 8.0
        assert np.isnan(graph.half_width[nearest]) == (end[1] < 220)
