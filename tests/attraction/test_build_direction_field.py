import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.attraction.build_direction_field import build_direction_field
from flowtree.errors import InputError
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.params import FieldParams

CAMERA = Camera(90.0, 0.01, (100.0, 1000.0), 200, 1000)
STRAIGHT = AttractorGraph(
    np.arange(-1, 20, dtype=np.int32), np.stack([np.zeros(21), np.linspace(0, 10, 21)], 1).astype(np.float32)
)


def random_graph(seed, count):
    rng = np.random.default_rng(seed)
    parent = np.concatenate([[-1], [rng.integers(0, i) for i in range(1, count)]]).astype(np.int32)
    points = np.zeros((count, 2), np.float32)
    for i in range(1, count):
        points[i] = points[parent[i]] + rng.normal(0, 1, 2) + [0, 0.7]
    return AttractorGraph(parent, points)


def centres(field):
    rows, columns = field.vectors.shape[:2]
    x = field.origin[0] + (np.arange(columns) + 0.5) * field.cell[0]
    y = field.origin[1] + (np.arange(rows) + 0.5) * field.cell[1]
    return np.stack(np.meshgrid(x, y), axis=2)


def test_far_away_it_points_straight_at_the_graph():
    field = build_direction_field(
        STRAIGHT, CAMERA, bounds=(-5.0, 0.0, 5.0, 10.0), params=FieldParams(reach=0.2)
    )
    place = centres(field)
    far = np.abs(place[..., 0]) > 2.0
    assert np.allclose(
        field.vectors[far], np.stack([-np.sign(place[far][:, 0]), np.zeros(far.sum())], 1), atol=1e-5
    )
    assert field.yaw == 90.0
    assert field.vectors.shape == (100, 100, 2)


def test_on_the_graph_it_points_down_the_stem():
    field = build_direction_field(
        STRAIGHT, CAMERA, bounds=(-0.05, 1.0, 0.05, 10.0), params=FieldParams(resolution=5)
    )
    assert np.allclose(field.vectors[:, 2], [0.0, -1.0], atol=1e-6)


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 80.0, 90.0])
def test_constant_blending_keeps_its_angle(angle):
    params = FieldParams(blending="constant", angle=angle)
    field = build_direction_field(STRAIGHT, CAMERA, bounds=(-5.0, 0.5, 5.0, 9.5), params=params)
    got = np.degrees(np.arctan2(np.abs(field.vectors[..., 0]), -field.vectors[..., 1]))
    assert np.allclose(got, angle, atol=1e-3)


def test_linear_blending_turns_from_tangent_to_normal():
    field = build_direction_field(
        STRAIGHT, CAMERA, bounds=(0.0, 4.0, 1.8, 6.0), params=FieldParams(reach=0.18)
    )
    row = field.vectors[50]
    assert (np.diff(row[:, 0]) < 0).all()
    h = centres(field)[50, :, 0] / 1.8
    expected = np.stack([-h, -(1 - h)], axis=1)
    assert np.allclose(row, expected / np.linalg.norm(expected, axis=1, keepdims=True), atol=1e-5)


def test_below_the_foot_it_points_to_the_foot():
    field = build_direction_field(
        STRAIGHT, CAMERA, bounds=(-1.0, -2.0, 1.0, -0.5), params=FieldParams(resolution=8)
    )
    place = centres(field)
    assert ((field.vectors * -place).sum(axis=2) / np.linalg.norm(place, axis=2)).min() > 0.999


def test_a_join_is_a_curve():
    parent = np.array([-1, *range(10), *[5, *range(11, 20)]], np.int32)
    stem = np.stack([np.zeros(11), np.arange(11)], axis=1)
    branch = np.stack([np.arange(1, 11), np.full(10, 5)], axis=1)
    graph = AttractorGraph(parent, np.concatenate([stem, branch]).astype(np.float32))
    field = build_direction_field(
        graph, CAMERA, bounds=(0.2, 4.99, 9.0, 5.01), params=FieldParams(resolution=40)
    )
    middle = field.vectors[20]
    down = np.degrees(np.arctan2(-middle[:, 1], -middle[:, 0]))
    assert down[-1] < 3.0
    assert down[0] > 20.0
    assert (np.diff(down) < 1.0).all()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**16), count=st.integers(2, 30), blending=st.sampled_from(["linear", "constant"]))
def test_fast_equals_brute_force(seed, count, blending):
    graph = random_graph(seed, count)
    params = FieldParams(resolution=12, blending="constant", angle=90.0)
    field = build_direction_field(graph, CAMERA, params=params)
    place = centres(field).reshape(-1, 2).astype(float)
    child = np.arange(1, count)
    start, end = graph.points[graph.parent[child]].astype(float), graph.points[child].astype(float)
    along = end - start
    t = np.clip(
        ((place[:, None] - start) * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0, 1
    )
    offset = start + t[..., None] * along - place[:, None]
    distance = np.linalg.norm(offset, axis=2)
    best = distance.min(axis=1)
    # At an angle of 90 degrees the field is the direction to the nearest point: following it for the
    # brute-force distance must end on the graph.
    landed = place + best[:, None] * field.vectors.reshape(-1, 2)
    t = np.clip(
        ((landed[:, None] - start) * along).sum(axis=2) / np.maximum((along**2).sum(axis=1), 1e-12), 0, 1
    )
    missed = np.linalg.norm(start + t[..., None] * along - landed[:, None], axis=2).min(axis=1)
    height = max(np.ptp(graph.points, axis=0).max(), 1e-6)
    assert missed.max() < 1e-5 * height
    other = build_direction_field(graph, CAMERA, params=FieldParams(resolution=12, blending=blending))
    assert np.isfinite(other.vectors).all()
    assert np.allclose(np.linalg.norm(other.vectors, axis=2), 1.0, atol=1e-5)


def test_degenerate_graphs_have_no_nan():
    parent = np.array([-1, 0, 1, 1], np.int32)
    points = np.array([[0, 0], [0, 0], [0, 1], [0, 1]], np.float32)
    for blending in ("linear", "constant"):
        field = build_direction_field(
            AttractorGraph(parent, points), CAMERA, params=FieldParams(blending=blending)
        )
        assert np.allclose(np.linalg.norm(field.vectors, axis=2), 1.0, atol=1e-5)


def test_same_bytes_again_and_a_free_resolution():
    graph = random_graph(1, 25)
    a, b = (build_direction_field(graph, CAMERA, params=FieldParams(resolution=37)) for _ in range(2))
    assert a.vectors.shape == (37, 37, 2)
    assert a.vectors.tobytes() == b.vectors.tobytes()


@pytest.mark.parametrize(
    ("parent", "points"),
    [
        ([-1], [[0, 0]]),
        ([-1, 1], [[0, 0], [0, 1]]),
        ([0, 0], [[0, 0], [0, 1]]),
        ([-1, 0], [[0, 0], [0, np.nan]]),
    ],
)
def test_what_is_no_tree_is_refused(parent, points):
    graph = AttractorGraph(np.array(parent, np.int32), np.array(points, np.float32))
    with pytest.raises(InputError):
        build_direction_field(graph, CAMERA)


def test_bounds_without_area_are_refused():
    with pytest.raises(InputError, match="bounds"):
        build_direction_field(STRAIGHT, CAMERA, bounds=(1.0, 0.0, 1.0, 5.0))
