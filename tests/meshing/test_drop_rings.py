from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.meshing.branch_axes import BranchAxes
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.drop_rings import drop_rings
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.params import MeshingParams
from tests.skeletons import random_skeleton


def _axes(seed: int, count: int = 40) -> BranchAxes:
    rng = np.random.default_rng(seed)
    chain = np.sort(rng.integers(0, 4, count))
    chain = np.cumsum(np.diff(chain, prepend=chain[0]) > 0)
    center = np.cumsum(rng.normal(size=(count, 3)) * [0.05, 0.2, 0.05], axis=0)
    return BranchAxes(center, rng.uniform(0.01, 0.03, count), chain, np.arange(count))


@given(seed=st.integers(0, 10_000), tolerance=st.floats(0.0, 0.3))
@settings(deadline=None, max_examples=25)
def test_what_is_left_out_lies_near_the_straight_between_what_stays(seed, tolerance):
    axes = _axes(seed)
    kept = drop_rings(axes, np.full(len(axes.first), tolerance))
    assert kept[axes.first].all()
    assert kept[axes.last].all()
    rows, arc = np.flatnonzero(kept), axes.arc()
    for row in np.flatnonzero(~kept):
        a, b = rows[rows < row][-1], rows[rows > row][0]
        share = (arc[row] - arc[a]) / (arc[b] - arc[a])
        center = axes.center[a] + share * (axes.center[b] - axes.center[a])
        radius = axes.radius[a] + share * (axes.radius[b] - axes.radius[a])
        away = np.linalg.norm(axes.center[row] - center) + abs(axes.radius[row] - radius)
        assert away <= tolerance + 1e-9


def test_a_straight_cone_keeps_its_ends():
    up = np.linspace(0.0, 3.0, 12)
    center = np.stack([0 * up, up, 0 * up], axis=1)
    axes = BranchAxes(center, 0.2 - 0.05 * up, np.zeros(12, np.int64), np.arange(12))
    assert np.flatnonzero(drop_rings(axes, np.array([1e-6]))).tolist() == [0, 11]


@given(seed=st.integers(0, 10_000), tolerance=st.floats(1e-5, 0.5), sides=st.sampled_from([3, 4, 6, 12]))
@settings(deadline=None, max_examples=20)
def test_wood_with_a_tolerance_stays_closed_and_has_fewer_triangles(seed, tolerance, sides):
    skeleton = random_skeleton(seed, 80, step_in_thickness=0.1)
    fine = sweep_rings(skeleton, params=MeshingParams(sides=sides), device="cpu")
    coarse = sweep_rings(skeleton, params=MeshingParams(sides=sides, tolerance=tolerance), device="cpu")
    assert len(coarse.triangles) <= len(fine.triangles)
    assert is_watertight(close_seams(coarse)[1])
    assert np.isfinite(coarse.positions).all()
    assert np.isfinite(coarse.normals).all()


def test_more_tolerance_needs_fewer_triangles():
    skeleton = random_skeleton(3, 400)
    counts = [
        len(sweep_rings(skeleton, params=MeshingParams(tolerance=each), device="cpu").triangles)
        for each in (0.0, 0.0005, 0.002, 0.01, 0.1)
    ]
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] < 0.5 * counts[0]


@pytest.mark.parametrize(("radius", "triangles"), [(0.01, 4), (0.0002, 2)])
def test_a_straight_twig_is_a_spike_and_a_thin_one_a_blade(radius, triangles):
    skeleton = random_skeleton(0, 3, stubborn=1.0)
    made = dataclasses.replace(
        skeleton,
        parent=np.array([-1, 0, 0], np.int32),
        points=np.array([[0, 0, 0], [0, 5, 0], [1, 6, 0]], np.float32),
        radius=np.array([0.2, 0.1, radius], np.float32),
        particles=np.array([2, 1, 1], np.int32),
    )
    trunk = dataclasses.replace(
        made, **{name: getattr(made, name)[:2] for name in ("parent", "points", "radius", "particles")}
    )
    params = MeshingParams(tolerance=0.004)
    both, alone = (sweep_rings(each, params=params, device="cpu") for each in (made, trunk))
    assert len(both.triangles) - len(alone.triangles) == triangles
    assert is_watertight(close_seams(both)[1])
    if triangles == 2:  # a front and a back, each lit from its own side
        own = both.triangles[(both.node[both.triangles] == 2).all(axis=1)]
        a, b, c = (both.positions[own[:, k]] for k in range(3))
        facing, lit = np.cross(b - a, c - a), both.normals[own].mean(axis=1)
        assert len(own) == 2
        assert (np.sum(facing * lit, axis=1) > 0).all()
