import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from flowtree.branches.build_skeleton import build_skeleton
from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.branches.order_branches import order_branches
from flowtree.errors import InputError
from flowtree.params import BranchParams, ThicknessParams
from tests.branches.traces import random_traces
from tests.skeletons import random_skeleton

PARAMS = st.builds(
    ThicknessParams,
    da_vinci=st.floats(1.0, 1.2),
    exponent=st.none() | st.floats(1.5, 4),
    trunk_radius=st.none() | st.floats(0.001, 20),
    slenderness=st.floats(1e-4, 0.2),
    taper=st.floats(0, 0.95),
    thinnest=st.floats(0, 0.01),
)


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    count=st.integers(2, 100),
    params=PARAMS,
    measured=st.none() | st.floats(0.001, 2),
    collapsed=st.booleans(),
)
# A taper that float32 does not show: of two branches that look alike only one is the thicker.
@example(
    seed=6, count=83, params=ThicknessParams(taper=1.6e-13, slenderness=0.1), measured=None, collapsed=False
)
@example(
    seed=6, count=83, params=ThicknessParams(taper=1.6e-13, slenderness=0.1), measured=None, collapsed=True
)
def test_no_radius_grows_toward_a_tip_and_the_trunks_is_the_one_asked_for(
    seed, count, params, measured, collapsed
):
    bare = build_skeleton(random_traces(seed, count, collapsed=collapsed), params=BranchParams(stride=1))
    made = da_vinci_radii(bare, trunk_radius=measured, params=params)
    assert np.isfinite(made.radius).all()
    assert (made.radius >= 0).all()
    assert (made.radius[1:] <= made.radius[made.parent[1:]]).all()
    height = float(np.ptp(bare.points[:, 1]))
    trunk = params.trunk_radius or measured or params.slenderness * height
    assert made.radius[0] == pytest.approx(trunk, rel=1e-5)
    assert made.radius.min() >= min(params.thinnest * height, trunk) * (1 - 1e-6)
    for name in ("parent", "points", "particles", "twig"):
        assert np.array_equal(getattr(made, name), getattr(bare, name))
    assert np.array_equal(made.level, order_branches(made.parent, made.radius))


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), exponent=st.none() | st.floats(1.5, 4), constant=st.floats(1, 1.2))
def test_the_rule_holds_before_taper(seed, exponent, constant):
    """At forks the e-th powers of the children add up to the parent's; in between a stem keeps its width."""
    params = ThicknessParams(da_vinci=constant, exponent=exponent, taper=0, thinnest=0)
    made = da_vinci_radii(random_skeleton(seed, 80), trunk_radius=0.3, params=params)
    power = made.radius.astype(float) ** (exponent or 2.0)
    for node in range(len(power)):
        children = np.flatnonzero(made.parent == node)
        if len(children):
            factor = constant if len(children) > 1 else 1.0
            assert power[node] == pytest.approx(factor * power[children].sum(), rel=1e-4)


def test_taper_thins_tips_by_its_share_and_leaves_the_foot():
    skeleton = random_skeleton(4, 60)
    even, thin = (
        da_vinci_radii(skeleton, trunk_radius=0.2, params=ThicknessParams(taper=t, thinnest=0))
        for t in (0, 0.5)
    )
    tips = ~np.isin(np.arange(60), skeleton.parent)
    assert np.allclose(thin.radius[tips], 0.5 * even.radius[tips])
    assert thin.radius[0] == even.radius[0]
    assert (thin.radius <= even.radius).all()


def test_a_larger_exponent_makes_thicker_limbs():
    skeleton = random_skeleton(2, 80)
    radii = [
        da_vinci_radii(skeleton, trunk_radius=0.2, params=ThicknessParams(exponent=e)).radius
        for e in (2.0, 2.5, 3.0)
    ]
    assert (radii[0] <= radii[1]).all()
    assert (radii[1] <= radii[2]).all()


def test_a_single_node_is_an_error():
    single = random_skeleton(0, 2)
    single = type(single)(**{name: getattr(single, name)[:1] for name in single.__dataclass_fields__})
    with pytest.raises(InputError, match="needs a segment"):
        da_vinci_radii(single)
