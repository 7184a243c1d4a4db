import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from flowtree.attraction.build_limb_field import build_limb_field
from flowtree.attraction.lift_graphs import lift_graphs
from flowtree.errors import InputError
from flowtree.geometry.polylines import subdivide_polyline
from flowtree.geometry.projection import Viewpoint, growth, to_plane
from flowtree.model.attractor import AttractorGraph, LimbTree
from flowtree.model.volume import DensityVolume
from flowtree.params import FieldParams


def volume(size=24):
    """A round crown, 1 m high, around the axis."""
    corner = np.array([-0.5, 0.0, -0.5], np.float32)
    place = (np.stack(np.meshgrid(*[np.arange(size)] * 3, indexing="ij"), axis=-1) + 0.5) / size + corner
    inside = np.linalg.norm(place - [0, 0.5, 0], axis=-1) < 0.5
    return DensityVolume(inside.astype(np.float32), corner, 1 / size)


def limbs_of(*lines):
    """A tree of straight limbs; each line begins at a node of one before it."""
    parent, points = [-1], [np.zeros(3)]
    for line in lines:
        dense = subdivide_polyline(np.array(line, float), 0.015)
        at = int(np.linalg.norm(np.array(points) - dense[0], axis=1).argmin())
        for point in dense[1:]:
            parent.append(at)
            points.append(point)
            at = len(points) - 1
    return LimbTree(
        np.array(parent, np.int32), np.array(points, np.float32), np.full(len(parent), np.nan, np.float32)
    )


TREE = limbs_of(
    [[0, 0, 0], [0, 0.8, 0]],
    [[0, 0.3, 0], [0.25, 0.55, 0.1]],
    [[0, 0.45, 0], [-0.15, 0.65, 0.2]],
    [[0, 0.2, 0], [-0.1, 0.35, -0.3]],
)


STEEP = [(0.15, 0.2, 0.05), (0.3, -0.2, 0.1), (0.4, 0.1, -0.2), (0.55, -0.1, -0.15)]  # low, side, away


FROM_FRONT_AND_SIDE = (Viewpoint(0), Viewpoint(90))
FROM_NEAR = tuple(Viewpoint(yaw, distance=1.5, eye=0.2) for yaw in (0, 90))


def graph_of(limbs, sight):
    return AttractorGraph(limbs.parent, to_plane(limbs.points, sight).astype(np.float32))


def far_apart(a, b):
    return float(cKDTree(b).query(a)[0].max())


@pytest.mark.parametrize("sights", [FROM_FRONT_AND_SIDE, FROM_NEAR], ids=["parallel", "from near"])
def test_limbs_seen_from_two_sides_are_found(sights):
    made = lift_graphs([graph_of(TREE, sight) for sight in sights], sights, volume())
    assert far_apart(TREE.points, made.points) < 0.05
    assert far_apart(made.points, TREE.points) < 0.05
    assert int((np.bincount(made.parent[1:], minlength=len(made.parent)) == 0).sum()) == 4


def test_a_branch_starts_at_the_limb_behind_from_which_it_stays_inside_the_tree():
    # From the front one limb hides half of the other, whose tip seems to leave it.
    before = [[0, 0.25, 0], [0.2, 0.45, 0.3], [0.22, 0.75, 0.3]]
    behind = [[0, 0.25, 0], [0.2, 0.45, -0.3], [0.45, 0.6, -0.3]]
    tree = limbs_of([[0, 0, 0], [0, 0.8, 0]], before, behind)
    seen = limbs_of([[0, 0, 0], [0, 0.8, 0]], before, [[0.2, 0.45, 0.3], [0.45, 0.6, 0.3]])
    graphs = [graph_of(seen, FROM_FRONT_AND_SIDE[0]), graph_of(tree, FROM_FRONT_AND_SIDE[1])]
    centres = (np.stack(np.meshgrid(*[np.arange(40)] * 3, indexing="ij"), axis=-1) + 0.5) / 40 - [0.5, 0, 0.5]
    near = cKDTree(tree.points).query(centres)[0] < 0.06
    wood = DensityVolume(near.astype(np.float32), np.float32([-0.5, 0, -0.5]), 1 / 40)
    made = lift_graphs(graphs, FROM_FRONT_AND_SIDE, wood)
    assert far_apart(tree.points, made.points) < 0.05


def test_boughs_toward_the_viewers_do_not_stand_above_the_tree():
    # Each view sees its own bough above the top, near the stem: taken for one they would stand up there.
    toward = [[0.03, 0.9, 0.4], [0.4, 0.9, 0.03]]
    graphs = []
    for sight, tip in zip(FROM_NEAR, toward, strict=True):
        seen = limbs_of([[0, 0, 0], [0, 0.9, 0]], [[0, 0.4, 0], tip])
        graphs.append(graph_of(seen, sight))
        assert graphs[-1].points[:, 1].max() > 1.1
    box = DensityVolume(np.ones((24, 24, 24), np.float32), np.float32([-0.5, 0, -0.5]), 1 / 24)
    made = lift_graphs(graphs, FROM_NEAR, box)
    assert made.points[:, 1].max() < 1.02
    assert (made.points[:, [0, 2]].max(axis=0) > 0.2).all(), "they reach out"


def test_a_limb_toward_the_viewer_is_as_thick_as_it_is_not_as_it_looks():
    tree = limbs_of([[0, 0, 0], [0, 0.8, 0]], [[0, 0.3, 0], [0.1, 0.5, 0.25]])
    graphs = []
    for sight in FROM_NEAR:
        half = (0.01 * growth(tree.points, sight)).astype(np.float32)
        graphs.append(AttractorGraph(tree.parent, to_plane(tree.points, sight).astype(np.float32), half))
    made = lift_graphs(graphs, FROM_NEAR, volume())
    assert np.nanmax(np.abs(made.radius / 0.01 - 1)) < 0.08, "the picture shows the tip a fifth thicker"


def test_branches_that_begin_along_the_stem_neither_bend_nor_thin_it():
    steep = [[[0, low, 0], [0.012, low + 0.15, 0.01], [side, low + 0.25, away]] for low, side, away in STEEP]
    tree = limbs_of([[0, 0, 0], [0, 0.95, 0]], *steep)
    graphs = []
    for sight in FROM_FRONT_AND_SIDE:
        on_stem = np.abs(tree.points[:, [0, 2]]).max(axis=1) < 1e-6
        half = np.where(on_stem, 0.02, 0.004).astype(np.float32)
        graphs.append(AttractorGraph(tree.parent, to_plane(tree.points, sight).astype(np.float32), half))
    made = lift_graphs(graphs, FROM_FRONT_AND_SIDE, volume())
    stem = np.stack([np.zeros(200), np.linspace(0, 0.95, 200), np.zeros(200)], axis=1)
    distance, node = cKDTree(made.points).query(stem)
    assert distance.max() < 0.009, "half of what lies between two nodes, and a little"
    aside = np.abs(made.points[node][:, [0, 2]]).max(axis=1)
    assert aside.max() < 0.004
    assert np.nanmin(made.radius[node]) > 0.015


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 1000), turn=st.floats(40, 140), views=st.integers(1, 3))
def test_every_view_finds_its_graph_in_the_limbs(seed, turn, views):
    rng = np.random.default_rng(seed)
    sights = [Viewpoint(turn * k) for k in range(views)]
    graphs = []
    for _ in sights:
        lines = [[[0, 0, 0], [0, rng.uniform(0.4, 0.9), 0]]]
        for _ in range(int(rng.integers(1, 5))):
            low = rng.uniform(0.1, 0.4)
            lines.append([[0, low, 0], [rng.uniform(-0.4, 0.4), rng.uniform(low, 0.9), 0]])
        graphs.append(graph_of(limbs_of(*lines), sights[0]))
    made = lift_graphs(graphs, sights, volume())
    assert made.parent[0] == -1
    assert (made.parent[1:] >= 0).all()
    assert (made.parent < np.arange(len(made.parent))).all()
    assert np.isfinite(made.points).all()
    assert not made.points[0].any()
    for graph, sight in zip(graphs, sights, strict=True):
        assert far_apart(graph.points, to_plane(made.points, sight)) < 0.06


def test_without_a_branch_there_is_nothing_to_lift():
    with pytest.raises(InputError, match="attractor graphs"):
        lift_graphs([], [], volume())
    flat = AttractorGraph(np.array([-1, 0], np.int32), np.array([[0, 0], [1, 0]], np.float32))
    with pytest.raises(InputError, match="attractor graphs"):
        lift_graphs([flat], FROM_FRONT_AND_SIDE[:1], volume())


@pytest.mark.parametrize("blending", ["linear", "constant"])
def test_the_field_leads_to_the_foot_along_the_limbs(blending):
    field = build_limb_field(TREE, volume(), params=FieldParams(blending=blending))
    size = np.linalg.norm(field.vectors, axis=-1)
    assert size.max() <= 1.0001
    place = np.array([0.12, 0.5, 0.02])
    for _ in range(400):
        index = np.round((place - field.corner) / field.spacing).astype(int)
        step = field.vectors[tuple(index)]
        assert step.any()
        place = place + 0.004 * step
        if np.linalg.norm(place) < 0.04:
            break
    else:
        pytest.fail(f"never came to the foot, but to {place}")


def test_far_from_all_limbs_the_views_lead():
    stem = limbs_of([[0, 0, 0], [0, 0.3, 0]])
    field = build_limb_field(stem, volume(), params=FieldParams(reach=0.1))
    index = np.round((np.array([0.1, 0.8, 0.1]) - field.corner) / field.spacing).astype(int)
    assert not field.vectors[tuple(index)].any()
