import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.sprout_twigs import sprout_twigs
from flowtree.errors import InputError
from flowtree.foliage.make_leaf import leaf_coverage, make_leaf
from flowtree.foliage.scatter_leaves import scatter_leaves
from flowtree.params import LeafParams
from tests.crowns import HEIGHT, branch_out, lone_branch
from tests.skeletons import random_skeleton

TREE = sprout_twigs(branch_out(), height=HEIGHT)
LEAF = make_leaf("broad")


def covered(foliage):
    return leaf_coverage(foliage.leaf, foliage.material) * float((foliage.scale.astype(float) ** 2).sum())


@settings(max_examples=20, deadline=None)
@given(
    params=st.builds(
        LeafParams,
        size=st.floats(1e-3, 0.5),
        amount=st.floats(0, 4),
        most=st.integers(1, 5000),
        densest=st.floats(1, 100),
        divergence=st.floats(0, 360),
        angle=st.floats(0, 120),
        plagiotropism=st.floats(0, 1),
        hang=st.floats(0, 3),
        color_variation=st.floats(0, 1),
    ),
    seed=st.integers(0, 10_000),
)
def test_any_parameters_give_leaves_that_stand_on_thin_wood(params, seed):
    tree = random_skeleton(seed, 40)
    made = scatter_leaves(tree, LEAF, params=params, seed=seed)
    if made is None:
        return
    assert np.allclose(np.linalg.norm(made.rotation, axis=1), 1.0, atol=1e-4)
    assert ((made.color >= 0) & (made.color <= 1)).all()
    assert (made.scale > 0).all()
    start, end = tree.points[tree.parent[made.node]], tree.points[made.node]
    along = np.linalg.norm(made.position - start, axis=1) + np.linalg.norm(made.position - end, axis=1)
    assert np.allclose(along, np.linalg.norm(end - start, axis=1), atol=1e-3)
    assert (tree.twig | (tree.particles <= params.bearing_particles))[made.node].all()


def test_amount_scales_the_leaves_area_and_most_keeps_it():
    one, half, few = (
        scatter_leaves(TREE, LEAF, height=HEIGHT, params=LeafParams(size=0.02, **more))
        for more in ({}, {"amount": 0.5}, {"most": 800})
    )
    assert covered(half) == pytest.approx(0.5 * covered(one), rel=0.1)
    assert covered(few) == pytest.approx(covered(one), rel=0.1)
    assert len(few.scale) <= 1.1 * 800 < len(one.scale)


def test_nothing_thin_bears_nothing():
    bare = branch_out()
    thick = type(bare)(**{**vars(bare), "particles": np.full(len(bare.parent), 999, np.int32)})
    assert scatter_leaves(thick, LEAF) is None
    assert scatter_leaves(TREE, LEAF, params=LeafParams(amount=0.0)) is None


def test_the_colour_is_the_given_one_on_average():
    made = scatter_leaves(TREE, LEAF, params=LeafParams(color="#804020", color_variation=0.1))
    seen = 0.8 * made.color.mean(axis=0)
    assert np.allclose(seen, [0.2159, 0.0513, 0.0144], rtol=0.03)
    assert made.color.std(axis=0).max() > 0.02
    with pytest.raises(InputError, match="leaf color: must be auto or #rrggbb, but got 'green'"):
        scatter_leaves(TREE, LEAF, params=LeafParams(color="green"))


def test_every_shape_has_its_own_colour():
    hues = {s: scatter_leaves(TREE, make_leaf(s)).color.mean(axis=0) for s in ("broad", "needle", "blossom")}
    assert hues["blossom"].min() > 0.5
    assert hues["needle"].sum() < hues["broad"].sum()


def test_the_spiral_turns_by_the_divergence_angle():
    """With every leaf at the same angle to a straight twig, successive ones are turned by it."""
    stem = lone_branch((0, 1, 0), nodes=2)
    params = LeafParams(divergence=90.0, hang=0.0, size=0.01)
    made = scatter_leaves(stem, LEAF, height=HEIGHT, params=params)
    x, y, z, w = made.rotation.T.astype(float)
    along = np.stack([2 * (x * y - z * w), 2 * (y * z + x * w)], axis=1)  # of y, across the stem
    turn = np.degrees(np.arctan2(along[:, 0], along[:, 1]))
    step = np.angle(np.exp(1j * np.radians(np.diff(turn))))
    assert np.median(np.abs(np.degrees(step))) == pytest.approx(90.0, abs=8.0)


def test_a_seed_gives_its_bytes_and_another_gives_others():
    one, two, other = (scatter_leaves(TREE, LEAF, height=HEIGHT, seed=s) for s in (1, 1, 2))
    assert one.position.tobytes() == two.position.tobytes()
    assert one.color.tobytes() == two.color.tobytes()
    assert one.position.tobytes() != other.position.tobytes()
