import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.errors import InputError
from flowtree.geometry.projection import pixels_to_plane, plane_to_pixels
from flowtree.params import AttractionParams
from tests.attraction.scenes import BARE, assert_tree, bare, lollipop, scene, spire

DATA = Path(__file__).parents[2] / ".." / "shared" / "data"


def tips(graph):
    return np.setdiff1d(np.arange(len(graph.parent)), graph.parent)


def distance_to(points, graph):
    """Of each point to the nearest segment of the graph."""
    child = np.arange(1, len(graph.parent))
    start, end = graph.points[graph.parent[child]].astype(float), graph.points[child].astype(float)
    along = end - start
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    t = np.clip(((points[:, None] - start) * along).sum(axis=2) / square, 0, 1)
    return np.linalg.norm(points[:, None] - start - t[..., None] * along, axis=2).min(axis=1)


def first_fork(graph):
    return int(np.flatnonzero(np.bincount(graph.parent[1:], minlength=len(graph.parent)) > 1)[0])


@pytest.mark.parametrize("make", [lollipop, spire, bare])
def test_shapes_give_a_tree_that_fills_the_crown(make):
    photo, matte, camera = scene(make())
    graph = trace_attractor_graph(photo, matte, camera)
    assert_tree(graph)
    assert len(tips(graph)) >= (4 if make is bare else 10)
    assert graph.points[:, 1].max() > 9.5
    steps = np.linalg.norm(graph.points[1:] - graph.points[graph.parent[1:]], axis=1)
    assert steps.max() < 0.3
    pixels = plane_to_pixels(graph.points, camera).astype(int)
    inside = matte.alpha[np.clip(pixels[:, 1], 0, 239), np.clip(pixels[:, 0], 0, matte.alpha.shape[1] - 1)]
    assert (inside > 0.1).mean() > 0.9


def test_the_stem_is_one_line_up_to_the_crown():
    photo, matte, camera = scene(lollipop())
    graph = trace_attractor_graph(photo, matte, camera)
    fork = first_fork(graph)
    assert graph.points[fork, 1] > 2.0
    assert np.abs(graph.points[: fork + 1, 0]).max() < 0.25


def test_a_spire_has_a_leader():
    photo, matte, camera = scene(spire())
    graph = trace_attractor_graph(photo, matte, camera)
    node = int(graph.points[:, 1].argmax())
    while node > 0:
        assert abs(graph.points[node, 0]) < 0.6
        node = int(graph.parent[node])


def test_bare_branches_are_followed():
    photo, matte, camera = scene(bare())
    graph = trace_attractor_graph(photo, matte, camera)
    for start, end in BARE:
        line = np.linspace(0.0, 1.0, 12)[:, None] * (np.array(end) - start) + start
        assert np.median(distance_to(pixels_to_plane(line, camera), graph)) < 0.15


def test_same_input_and_seed_give_the_same_bytes_and_other_seeds_another_tree():
    photo, matte, camera = scene(lollipop())
    a, b, c = (trace_attractor_graph(photo, matte, camera, seed=seed) for seed in (3, 3, 4))
    assert a.points.tobytes() == b.points.tobytes()
    assert a.parent.tobytes() == b.parent.tobytes()
    assert a.points.tobytes() != c.points.tobytes()


def test_seeds_by_hand_are_tips():
    photo, matte, camera = scene(lollipop())
    seeds = np.array([[60.0, 60.0], [150.0, 100.0]])
    graph = trace_attractor_graph(photo, matte, camera, seeds=seeds, params=AttractionParams(seed_count=0))
    assert_tree(graph)
    assert len(tips(graph)) == 2
    assert distance_to(pixels_to_plane(seeds, camera), graph).max() < 0.1


def test_seeds_by_hand_are_the_whole_graph_where_the_automatic_one_is_off():
    photo, matte, camera = scene(lollipop())
    seeds = np.array([[60.0, 60.0], [150.0, 100.0]])
    graph = trace_attractor_graph(photo, matte, camera, seeds=seeds, params=AttractionParams(automatic=False))
    assert len(tips(graph)) == 2


def test_paths_lead_to_the_given_fork():
    photo, matte, camera = scene(lollipop())
    target = (105.0, 130.0)
    graph = trace_attractor_graph(photo, matte, camera, target=target)
    assert_tree(graph)
    place = pixels_to_plane([target], camera)[0]
    assert distance_to(place[None], graph)[0] < 0.1
    assert graph.points[first_fork(graph), 1] > place[1] - 0.4


@pytest.mark.parametrize("make", [lollipop, spire, bare])
@pytest.mark.parametrize("target", [(105.0, 130.0), (88.3, 170.2), (80.0, 60.0), (99.0, 225.0)])
def test_the_stem_passes_exactly_through_the_given_fork(make, target):
    """Even where it lies beside the trunk: no branch leaves the stem before."""
    photo, matte, camera = scene(make())
    graph = trace_attractor_graph(photo, matte, camera, target=target)
    place = pixels_to_plane([target], camera)[0]
    node = int(np.linalg.norm(graph.points - place, axis=1).argmin())
    assert np.allclose(graph.points[node], place, atol=1e-4)
    children = np.bincount(graph.parent[1:], minlength=len(graph.parent))
    assert children[node] >= 1, "branches leave from there"
    while node > 0:
        node = int(graph.parent[node])
        assert children[node] == 1


def test_strokes_alone_are_the_graph_exactly_as_drawn():
    photo, matte, camera = scene(lollipop())
    trunk = np.array([[100.0, 233.0], [102.0, 150.0], [100.0, 100.0]])
    limb = np.array([[101.0, 120.0], [130.0, 90.0], [150.0, 60.0]])
    crossing = np.array([[60.0, 60.0], [170.0, 85.0]])
    strokes = [trunk, limb[::-1], crossing]
    graph = trace_attractor_graph(
        photo, matte, camera, strokes=strokes, params=AttractionParams(automatic=False)
    )
    assert_tree(graph)
    drawn = pixels_to_plane(np.concatenate(strokes), camera)
    nearest = np.linalg.norm(drawn[:, None] - graph.points[None], axis=2).min(axis=1)
    assert nearest.max() < 1e-4  # every drawn point is a node
    # Foot to trunk, a limb that touches it and a line across the limb: four free ends, none of them made up.
    assert len(tips(graph)) == 4


def test_strokes_and_the_automatic_graph_go_together():
    photo, matte, camera = scene(lollipop())
    stroke = np.array([[100.0, 130.0], [60.0, 60.0]])
    graph = trace_attractor_graph(photo, matte, camera, strokes=[stroke])
    assert_tree(graph)
    assert len(tips(graph)) > 8
    assert distance_to(pixels_to_plane(stroke, camera), graph).max() < 1e-4


def test_a_stroke_far_from_everything_is_connected():
    photo, matte, camera = scene(lollipop())
    stroke = np.array([[5.0, 30.0], [5.0, 10.0]])
    graph = trace_attractor_graph(
        photo, matte, camera, strokes=[stroke], params=AttractionParams(automatic=False)
    )
    assert_tree(graph)
    assert len(tips(graph)) == 1


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        ({"alpha": np.zeros((64, 48))}, "needs a tree"),
        ({"seeds": [[500.0, 10.0]]}, "inside the picture"),
        ({"seeds": [[np.nan, 10.0]]}, "finite"),
        ({"target": (-4.0, 3.0)}, "inside the picture"),
        ({"target": (24.0, 63.5)}, "above the foot"),
        ({"strokes": [[[3.0, 3.0], [3.0, 3.0]]]}, "two different points"),
        ({"strokes": [[[3.0, np.inf], [3.0, 3.0]]]}, "finite"),
        ({"params": AttractionParams(seed_count=0)}, "at least one seed"),
    ],
)
def test_bad_input_is_named(change, rule):
    photo, matte, camera = scene(change.pop("alpha", lollipop(64, 48)))
    with pytest.raises(InputError, match=rule):
        trace_attractor_graph(photo, matte, camera, **change)


def test_a_matte_of_another_size_is_refused():
    photo, _, camera = scene(lollipop(64, 48))
    _, matte, _ = scene(lollipop(80, 48))
    with pytest.raises(InputError, match="photo's size"):
        trace_attractor_graph(photo, matte, camera)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**16),
    size=st.tuples(st.integers(4, 40), st.integers(4, 40)),
    fill=st.floats(0.02, 1.0),
    count=st.integers(0, 4),
    mode=st.sampled_from(["farthest", "random"]),
    automatic=st.booleans(),
)
def test_random_mattes_and_strokes_always_give_a_rooted_tree(seed, size, fill, count, mode, automatic):
    rng = np.random.default_rng(seed)
    alpha = rng.random(size) * (rng.random(size) < fill)
    alpha.flat[rng.integers(alpha.size)] = 1.0
    photo, matte, camera = scene(alpha)
    strokes = [rng.uniform(-10, 50, (rng.integers(2, 6), 2)) for _ in range(count)]
    params = AttractionParams(grid_height=48, seed_count=9, seed_mode=mode, automatic=automatic)
    seeds = rng.uniform(0, 1, (2, 2)) * size[::-1]
    graph = trace_attractor_graph(
        photo, matte, camera, strokes=strokes, seeds=seeds, params=params, seed=seed
    )
    assert_tree(graph)
    for stroke in strokes:
        drawn = pixels_to_plane(stroke, camera)
        scale = max(1.0, np.abs(drawn).max())
        assert np.linalg.norm(drawn[:, None] - graph.points[None], axis=2).min(axis=1).max() < 1e-4 * scale


@pytest.mark.skipif(not DATA.is_dir(), reason="the shared test data is not beside the project")
def test_the_true_stem_is_found():
    folder = DATA / "truth" / "birch"
    picture = np.asarray(Image.open(folder / "ortho_000.png"))
    photo, matte, camera = scene(picture[..., 3] / 255)
    photo = type(photo)("birch", np.ascontiguousarray(picture[..., :3]))
    graph = trace_attractor_graph(photo, matte, camera)
    assert_tree(graph)
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    scale = 10.0 / truth["height"]
    stem = np.array(truth["stems"][0])[:, :2] * scale
    lower = stem[stem[:, 1] < 4.0]
    assert np.median(distance_to(lower, graph)) < 0.15


def test_a_brush_stroke_is_a_limb_of_its_width():
    photo, matte, camera = scene(lollipop())
    line = np.array([[100.0, 150.0], [80.0, 100.0], [60.0, 60.0]])
    pen = trace_attractor_graph(photo, matte, camera, strokes=[line])
    brush = trace_attractor_graph(photo, matte, camera, strokes=[np.c_[line, np.full(3, 12.0)]])
    assert (pen.points == brush.points).all()
    assert (pen.parent == brush.parent).all()
    changed = ~((pen.half_width == brush.half_width) | np.isnan(pen.half_width) & np.isnan(brush.half_width))
    assert changed.sum() >= 5
    assert np.allclose(brush.half_width[changed], 6.0 * camera.metres_per_pixel)
    drawn = pixels_to_plane(line, camera)
    low, high = drawn.min(axis=0) - 0.1, drawn.max(axis=0) + 0.1
    assert ((brush.points[changed] >= low) & (brush.points[changed] <= high)).all()
