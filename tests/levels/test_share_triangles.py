from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.levels.share_triangles import share_triangles
from flowtree.params import MeshingParams


@given(
    budget=st.integers(0, 10_000_000),
    branches=st.integers(1, 100_000),
    leaves=st.integers(0, 1_000_000),
    sides=st.integers(3, 64),
)
@settings(deadline=None, max_examples=25)
def test_shares_are_parameters_of_meshing_within_the_budget(budget, branches, leaves, sides):
    shares = share_triangles(budget, branches=branches, leaves=leaves, sides=sides)
    assert 0 <= shares.wood <= budget
    assert 3 <= shares.sides <= sides
    MeshingParams(sides=shares.sides, tolerance=shares.tolerance)


def test_wood_has_what_leaves_leave():
    assert share_triangles(60_000, branches=100).wood == 60_000
    assert share_triangles(60_000, branches=100, leaves=10_000).wood == 50_000
    assert share_triangles(60_000, branches=100, leaves=1_000_000).wood < 12_000


def test_a_bare_crown_keeps_most_of_its_branches():
    """Twigs that are gone cost more likeness than limbs that are a little straighter."""
    shares = share_triangles(50_000, branches=27_000)
    assert shares.tolerance > 0.009


def test_less_is_coarser():
    fine, coarse = (share_triangles(budget, branches=4000) for budget in (60_000, 4000))
    assert coarse.tolerance > fine.tolerance
    assert coarse.sides < fine.sides
