import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.copy_twig import copy_twig
from flowtree.branches.grow_twigs import grow_twigs
from flowtree.branches.join_strokes import join_strokes
from flowtree.branches.sprout_twigs import sprout_twigs
from flowtree.branches.trim_sketch import trim_sketch
from tests.crowns import HEIGHT, ball_crown, branch_out

# A shoot with two side shoots, drawn downwards on paper, as every picture is.
SHOOT = np.array([[100, 290], [98, 200], [104, 110], [100, 20]])
TWIG = (SHOOT, np.array([[99, 220], [140, 170], [150, 150]]), np.array([[60, 60], [100, 130]]))

strokes = st.lists(
    st.lists(st.tuples(st.floats(0, 300), st.floats(0, 300)), min_size=2, max_size=6, unique=True),
    min_size=1,
    max_size=8,
)


def copies(lines, count=8, curl=0.1, seed=0):
    return copy_twig([np.array(line) for line in lines], count, curl=curl, random=np.random.default_rng(seed))


@settings(max_examples=25, deadline=None)
@given(strokes, st.integers(0, 1000))
def test_any_drawing_becomes_twigs(lines, seed):
    lengths = [np.ptp(np.array(line), axis=0).max() for line in lines]
    if min(lengths) < 1e-3:
        return
    made = copies(lines, seed=seed)
    count = len(made.parent)
    assert (made.parent < np.arange(count)).all()
    assert (made.parent >= -1).all()
    assert (made.parent == -1).any()
    assert np.isfinite(made.points).all()
    assert made.points.shape == (8, count, 3)
    inner = made.parent >= 0
    assert (made.thickness[inner] <= made.thickness[made.parent[inner]] + 1e-9).all()
    assert made.thickness.min() > 0
    assert count <= 60
    assert np.array_equal(made.parent[made.shoot[1:]], made.shoot[:-1])


def test_strokes_join_where_they_come_nearest_and_the_lowest_end_is_the_root():
    graph = join_strokes(TWIG)
    assert graph.parent[0] == -1
    assert np.allclose(graph.points[0], 0)
    children = np.bincount(graph.parent[1:], minlength=len(graph.parent))
    forks = graph.points[children > 1]
    assert len(forks) == 2
    assert np.allclose(sorted(forks[:, 1]), [290 - 220, 290 - 130], atol=6)
    assert (graph.parent[1:] < np.arange(1, len(graph.parent))).all()


def test_the_drawing_stands_upright_and_is_one_long():
    for turn in np.radians([0, 35, -60]):
        matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        sketch = trim_sketch(join_strokes([line @ matrix.T for line in TWIG]))
        assert np.allclose(sketch.points[sketch.shoot[-1]], [0, 1], atol=1e-6)
        assert sketch.begins.sum() == 2


def test_side_shoots_lean_as_drawn():
    straight = copies(TWIG, count=2, curl=0.0)
    first = np.flatnonzero(trim_sketch(join_strokes(TWIG)).begins)
    lean = straight.points[0, first] - straight.points[0, straight.parent[first]]
    angles = np.degrees(np.arccos(lean[:, 1] / np.linalg.norm(lean, axis=1)))
    assert np.allclose(sorted(angles), [30, 39.5], atol=16)


def test_every_second_copy_is_mirrored_and_all_differ():
    made = copies(TWIG, count=40, curl=0.0)
    first = int(np.flatnonzero(trim_sketch(join_strokes(TWIG)).begins)[0])
    side = np.sign(made.points[:, first, 0])
    assert (side[::2] == -side[1::2]).mean() > 0.9
    assert len(np.unique(made.points[:, first].round(6), axis=0)) == 40


def test_many_strokes_leave_few_nodes():
    rng = np.random.default_rng(0)
    lines = [SHOOT, *(np.array([[100, y], [100 + x, y - 30]]) for x, y in rng.uniform(40, 280, (60, 2)))]
    made = copies(lines)
    assert trim_sketch(join_strokes(lines)).begins.sum() == 12
    assert len(made.parent) < 45


def test_sketched_twigs_grow_with_and_without_photos():
    made = copies(TWIG)
    crown = ball_crown()
    with_photos = grow_twigs(*crown.inputs, shapes=made)
    usual = grow_twigs(*crown.inputs)
    without = sprout_twigs(branch_out(), height=HEIGHT, shapes=made)
    for tree in (with_photos, without):
        assert tree.twig.sum() % len(made.parent) == 0
        assert tree.twig.any()
        assert (tree.radius[1:] <= tree.radius[tree.parent[1:]] * (1 + 1e-6)).all()
    assert with_photos.twig.sum() > usual.twig.sum() / 3


def test_a_seed_gives_its_bytes():
    assert copies(TWIG, seed=3).points.tobytes() == copies(TWIG, seed=3).points.tobytes()
    assert copies(TWIG, seed=3).points.tobytes() != copies(TWIG, seed=4).points.tobytes()


def test_a_ring_still_has_a_tip():
    turn = np.linspace(0, 2 * np.pi, 30)
    made = copies([np.stack([np.sin(turn), np.cos(turn)], axis=1)])
    assert np.isfinite(made.points).all()
    assert np.abs(made.points).max() == pytest.approx(1.0, abs=0.6)
