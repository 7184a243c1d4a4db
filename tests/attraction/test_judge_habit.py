import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.attraction.branch_levels import branch_levels
from flowtree.attraction.build_limb_field import build_limb_field
from flowtree.attraction.judge_habit import judge_habit
from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.geometry.projection import plane_to_pixels
from flowtree.model.attractor import LimbTree
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.volume import DensityVolume
from flowtree.params import AttractionParams, FieldParams
from tests.branches.traces import random_traces

CAMERA = Camera(0.0, 0.02, (150.0, 390.0), 300, 400)


def matte_of(picture):
    return Matte(
        picture.astype(np.float32) / 255, np.full((*picture.shape, 3), (60, 120, 50), np.uint8), "automatic"
    )


def palm():
    picture = np.zeros((400, 300), np.uint8)
    cv2.line(picture, (150, 390), (150, 110), 255, 8)
    for turn in np.linspace(-0.3, np.pi + 0.3, 11):
        tip = (150 + int(80 * np.cos(turn)), 110 - int(80 * np.sin(turn)))
        cv2.line(picture, (150, 110), tip, 255, 14)
    return picture


def cone():
    picture = np.zeros((400, 300), np.uint8)
    cv2.fillPoly(picture, [np.array([[150, 20], [240, 360], [60, 360]])], 255)
    cv2.rectangle(picture, (146, 350), (154, 390), 255, -1)
    return picture


def round_crown():
    picture = np.zeros((400, 300), np.uint8)
    cv2.circle(picture, (150, 160), 110, 255, -1)
    cv2.rectangle(picture, (145, 250), (155, 390), 255, -1)
    return picture


def bare(rise):
    """Twigs that leave a stem and go up by so much for their length to the side."""
    picture = np.zeros((400, 300), np.uint8)
    cv2.line(picture, (150, 390), (150, 60), 255, 8)
    for row in range(110, 260, 9):
        for side in (-1, 1):
            middle = (150 + side * 60, row - 40)
            cv2.line(picture, (150, row), middle, 255, 3)
            cv2.line(picture, middle, (middle[0] + side * 70, middle[1] - int(70 * rise)), 255, 2)
    return picture


@pytest.mark.parametrize(
    ("picture", "leafy", "habit"),
    [
        (palm(), True, "palm"),
        (cone(), True, "conifer"),
        (round_crown(), True, "spreading"),
        (bare(-1.0), False, "weeping"),
        (bare(0.2), False, "spreading"),
        (bare(2.0), False, "upright"),
    ],
)
def test_silhouette_and_twigs_show_the_habit(picture, leafy, habit):
    assert judge_habit([matte_of(picture)], [CAMERA], leafy=leafy) == habit
    given = AttractionParams(habit="upright")
    assert judge_habit([matte_of(picture)], [CAMERA], leafy=leafy, params=given) == "upright"


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), fill=st.floats(0, 1), leafy=st.booleans())
def test_any_matte_has_a_habit(seed, fill, leafy):
    noise = np.random.default_rng(seed).random((400, 300))
    made = judge_habit([matte_of(255.0 * (noise < fill))], [CAMERA], leafy=leafy)
    assert made in ("upright", "spreading", "weeping", "conifer", "palm")
    assert judge_habit([], [], leafy=leafy) == "spreading"


def traced(picture, habit):
    rgb = np.full((400, 300, 3), (60, 120, 50), np.uint8)
    return trace_attractor_graph(Photo("tree", rgb), matte_of(picture), CAMERA, habit=habit)


def test_a_conifers_leader_is_straight():
    graph = traced(cone(), "conifer")
    level = branch_levels(graph.parent, graph.points)
    stem = graph.points[level == 0]
    assert stem[:, 1].max() > 0.9 * 7.4
    assert np.abs(stem[stem[:, 1] < 6.5, 0]).max() < 0.12


def test_a_weeping_crowns_branches_climb_before_they_hang():
    weeping, plain = traced(round_crown(), "weeping"), traced(round_crown(), "spreading")

    def hanging(graph):  # length of branches that go down on their way to the tip, of all
        rise = graph.points[1:] - graph.points[graph.parent[1:]]
        length = np.linalg.norm(rise, axis=1)
        return float(length[rise[:, 1] < 0].sum() / length.sum())

    assert hanging(weeping) > hanging(plain) + 0.1
    low = plane_to_pixels(weeping.points, CAMERA)
    assert (low[:, 1] > 230).sum() > 5, "and end at the crown's underside"


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(2, 150))
def test_levels_rise_by_one_at_side_branches(seed, count):
    made = random_traces(seed, count)
    level = branch_levels(made.parent, made.points)
    assert level[0] == 0
    rise = level[1:] - level[made.parent[1:]]
    assert np.isin(rise, [0, 1]).all()
    for node in range(count):
        above = np.flatnonzero(made.parent == node)
        assert len(above) == 0 or (level[above] == level[node]).sum() == 1


def stem_and_limb():
    up = np.stack([np.zeros(41), np.linspace(0, 1, 41), np.zeros(41)], axis=1)
    side = np.stack([np.linspace(0.02, 0.4, 20), np.full(20, 0.5), np.zeros(20)], axis=1)
    parent = np.concatenate([np.arange(-1, 40), [20], np.arange(41, 60)]).astype(np.int32)
    points = np.concatenate([up, side]).astype(np.float32)
    return LimbTree(parent, points, np.full(61, np.nan, np.float32))


def field_at(place, **options):
    volume = DensityVolume(np.ones((48, 48, 48), np.float32), np.array([-0.5, 0, -0.5], np.float32), 1 / 48)
    field = build_limb_field(stem_and_limb(), volume, **options)
    index = np.round((np.array(place) - field.corner) / field.spacing).astype(int)
    return field.vectors[tuple(index)]


def test_each_level_has_its_angle():
    params = FieldParams(blending="constant", angles=(70.0, 20.0))
    beside_stem, beside_limb = (
        field_at([-0.1, 0.8, 0.0], params=params),
        field_at([0.3, 0.5, 0.1], params=params),
    )
    # The angle is measured where the limb is approached squarely.
    assert np.degrees(np.arccos(-beside_stem[1])) == pytest.approx(70, abs=8)
    assert np.degrees(np.arccos(-beside_limb[0])) == pytest.approx(20, abs=8)


def test_branches_hang_or_climb_with_the_habit():
    place = [-0.15, 0.8, 0.0]
    weeping, plain, upright = (field_at(place, habit=h)[1] for h in ("weeping", "spreading", "upright"))
    assert weeping > plain + 0.1
    assert upright < plain - 0.1
    assert field_at(place, params=FieldParams(climb=-0.5))[1] == weeping
