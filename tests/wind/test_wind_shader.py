"""The recipe moves a tree as a tree moves: it holds together, its lengths stay, its foot rests."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.export.merge_leaves import merge_leaves
from flowtree.meshing.connect_ramifications import connect_ramifications
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.meshing.unwrap_quads import unwrap_quads
from flowtree.model.wind import VertexWind
from flowtree.params import MeshingParams
from flowtree.wind.spread_over_leaves import spread_over_leaves
from flowtree.wind.spread_over_wood import spread_over_wood
from flowtree.wind.weigh_wind import weigh_wind
from flowtree.wind.wind_shader import WIND_SHADER
from tests.skeletons import random_skeleton
from tests.trees import scatter_leaves
from tests.wind.recipe import sway

TIMES = (0.0, 1.3, 2.9, 7.7)


@pytest.fixture(scope="module", params=range(3))
def weighed(request):
    skeleton = random_skeleton(request.param, 400, stubborn=0.93)
    return skeleton, weigh_wind(skeleton, height=10.0)


def at_segments(skeleton, weights, share):
    """The places along all segments as vertices."""
    above = np.maximum(skeleton.parent, 0)
    extent = (1 - share) * weights.extent[above] + share * weights.extent
    place = (1 - share) * skeleton.points[above] + share * skeleton.points
    vertices = VertexWind(
        weights.depth,
        weights.pivot,
        np.pad(extent, ((0, 0), (0, 1))),
        np.pad(weights.phase, ((0, 0), (0, 1))),
    )
    return place, vertices


@pytest.mark.parametrize("time", TIMES)
def test_a_branch_stays_where_it_leaves_its_parent(weighed, time):
    skeleton, weights = weighed
    begin, end = (
        sway(place, 0 * place, vertices, time=time)
        for place, vertices in (at_segments(skeleton, weights, 0.0), at_segments(skeleton, weights, 1.0))
    )
    np.testing.assert_allclose(begin[1:], end[skeleton.parent[1:]], atol=1e-6)
    np.testing.assert_allclose(end[0], skeleton.points[0], atol=1e-12)
    assert 0.05 < np.linalg.norm(end - skeleton.points, axis=1).max() < 4.0


@pytest.mark.parametrize("time", TIMES)
def test_branches_keep_their_length(weighed, time):
    skeleton, weights = weighed
    begin, end = (
        sway(place, 0 * place, vertices, time=time)
        for place, vertices in (at_segments(skeleton, weights, 0.0), at_segments(skeleton, weights, 1.0))
    )
    rest = np.linalg.norm(skeleton.points[1:] - skeleton.points[skeleton.parent[1:]], axis=1)
    change = np.abs(np.linalg.norm(end - begin, axis=1)[1:] / rest - 1)
    assert change.max() < 0.07
    assert np.median(change) < 0.01


def test_the_surface_does_not_tear(weighed):
    skeleton, weights = weighed
    wood = sweep_rings(skeleton)
    vertices = spread_over_wood(skeleton, weights, wood)
    moved = sway(wood.positions, 0 * wood.normals, vertices, time=2.9)
    # Twins that differ in texture coordinates alone stay together.
    _, first, twin = np.unique(wood.positions, axis=0, return_index=True, return_inverse=True)
    one_node = wood.node[first][twin.ravel()] == wood.node
    apart = np.linalg.norm(moved - moved[first][twin.ravel()], axis=1)
    assert apart[one_node].max() < 1e-9
    edges = np.concatenate([wood.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    rest, now = (
        np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (wood.positions.astype(float), moved)
    )
    assert np.abs(now - rest).max() < 0.05
    assert np.quantile(np.abs(now / np.maximum(rest, 1e-4) - 1), 0.99) < 0.07


@pytest.mark.parametrize("seed", range(3))
def test_one_closed_surface_is_continuous_at_forks(seed):
    skeleton = random_skeleton(seed, 60)
    weights = weigh_wind(skeleton, height=10.0)
    wood = unwrap_quads(connect_ramifications(skeleton, params=MeshingParams(subdivisions=1)))
    moved = sway(wood.positions, 0 * wood.normals, spread_over_wood(skeleton, weights, wood), time=2.9)
    _, first, twin = np.unique(wood.positions, axis=0, return_index=True, return_inverse=True)
    assert np.linalg.norm(moved - moved[first][twin.ravel()], axis=1).max() < 1e-9, "seams stay closed"
    edges = np.concatenate([wood.triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    rest, now = (
        np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) for p in (wood.positions.astype(float), moved)
    )
    assert np.abs(now - rest).max() < 0.15 * skeleton.radius[0]


def test_leaves_stay_on_their_twigs_and_flutter(weighed):
    skeleton, weights = weighed
    foliage = scatter_leaves(skeleton, 200)
    leaves, corners = merge_leaves(foliage), len(foliage.leaf.positions)
    vertices = spread_over_leaves(skeleton, weights, foliage)
    stalk = dataclasses.replace(
        vertices,
        **{name: getattr(vertices, name)[::corners] for name in ("depth", "pivot", "extent", "phase")},
    )
    stalk.extent[:, 3] = 0.0
    options = {"time": 2.9, "flutter": 0.02}
    moved = sway(leaves.positions, leaves.normals, vertices, **options).reshape(200, corners, 3)
    still = sway(
        leaves.positions,
        leaves.normals,
        dataclasses.replace(vertices, extent=vertices.extent * [1, 1, 1, 0]),
        **options,
    )
    place = sway(foliage.position, 0 * foliage.position, stalk, **options)
    rest = np.linalg.norm(leaves.positions.reshape(200, corners, 3) - foliage.position[:, None], axis=2)
    stiff = np.linalg.norm(still.reshape(200, corners, 3) - place[:, None], axis=2)
    np.testing.assert_allclose(stiff, rest, atol=1e-4)
    fluttered = np.linalg.norm(moved - still.reshape(200, corners, 3), axis=2)
    reach = vertices.extent[:, 3].reshape(200, corners)
    assert (fluttered <= 0.02 * reach + 1e-6).all()
    assert np.ptp(fluttered.max(axis=1)) > 0.005, "each leaf by its own phase"


def test_no_wind_moves_nothing(weighed):
    skeleton, weights = weighed
    place, vertices = at_segments(skeleton, weights, 1.0)
    still = sway(place, np.ones_like(place), vertices, wind=(0.0, 0.0, 0.0), time=3.0, flutter=1.0)
    np.testing.assert_allclose(still, place, atol=1e-4)


def test_the_shader_is_short():
    assert len(WIND_SHADER.splitlines()) <= 22
