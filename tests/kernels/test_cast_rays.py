"""The kernel against its float64 twin, on every device present."""

from __future__ import annotations

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels.cast_rays import RayGrid, cast_rays
from flowtree.kernels.reference.cast_rays import cast_rays as cast_rays_twin
from tests.flows import DEVICES


def _scene(seed, triangles=12, size=20.0):
    rng = np.random.default_rng(seed)
    corner = rng.uniform(-4, size + 4, (3 * triangles, 3)).astype(np.float32)
    uv = rng.uniform(-1, 2, (3 * triangles, 2)).astype(np.float32)
    alpha = rng.random((5, 7)).astype(np.float32)
    return corner, uv, np.arange(3 * triangles, dtype=np.int32).reshape(-1, 3), alpha


def _grid(group, any_hit=0, opaque=6, tile=8, columns=20, rows=18):
    grid = RayGrid()
    grid.columns, grid.rows, grid.group, grid.tile, grid.tiles_across = (
        columns,
        rows,
        group,
        tile,
        -(-columns // tile),
    )
    grid.opaque, grid.cutoff, grid.any_hit = opaque, 0.5, any_hit
    return grid


def _cast(scene, grid, device):
    """Both ways; every tile gets every triangle."""
    corner, uv, triangle, alpha = scene
    tiles = grid.tiles_across * -(-grid.rows // grid.tile)
    lists = (
        np.arange(tiles, dtype=np.int32)[::-1].copy(),
        len(triangle) * np.arange(tiles + 1, dtype=np.int32),
        np.tile(np.arange(len(triangle), dtype=np.int32), tiles),
    )
    inputs = [
        devices.upload(corner, wp.vec3, device),
        devices.upload(uv, wp.vec2, device),
        devices.upload(triangle, wp.vec3i, device),
        devices.upload(alpha, wp.float32, device),
        *(devices.upload(part, wp.int32, device) for part in lists),
        grid,
    ]
    rays = grid.columns * grid.rows
    hit, near = devices.zeros(rays, wp.int32, device), devices.zeros(rays, wp.float32, device)
    devices.launch(cast_rays, tiles, inputs, [hit, near], device=device, split_from=2)
    slow_hit, slow_near = np.zeros(rays, np.int32), np.zeros(rays)
    cast_rays_twin(0, corner, uv, triangle, alpha, *lists, grid, slow_hit, slow_near)
    return hit.numpy(), near.numpy(), slow_hit, slow_near


@pytest.mark.parametrize("device", DEVICES)
@pytest.mark.parametrize("group", [1, 2, 3])
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_equals_its_twin(device, group, seed):
    hit, near, slow_hit, slow_near = _cast(_scene(seed), _grid(group), device)
    same = hit == slow_hit
    # float32 may place a ray on the other side of an edge, or of the cut-off's line, that it almost meets.
    assert same.mean() > 0.99
    # The nearness grows by up to 24 over a thin triangle's width: its weights carry a float32's 1e-6.
    assert np.abs(near - slow_near)[same].max() < 0.02
    assert np.median(np.abs(near - slow_near)[same]) < 1e-5


@pytest.mark.parametrize("device", DEVICES)
def test_any_hit_finds_what_the_nearest_hit_finds(device):
    for seed in range(5):
        nearest = _cast(_scene(seed), _grid(2), device)
        some = _cast(_scene(seed), _grid(2, any_hit=1), device)
        assert ((nearest[0] > 0) == (some[0] > 0)).all()
        assert (some[1] == 0).all(), "nearness is not asked for"
        assert ((some[2] > 0) == (nearest[2] > 0)).all()


@pytest.mark.parametrize("device", DEVICES)
def test_degenerate_and_far_triangles_are_harmless(device):
    corner, uv, triangle, alpha = _scene(3)
    corner[:3] = corner[0]
    corner[3:6] = 1e30
    corner[6] = (-1e7, 3, 0)
    hit, near, *_ = _cast((corner, uv, triangle, alpha), _grid(1), device)
    assert np.isfinite(near).all()
    assert hit.max() <= len(triangle)
    assert not np.isin([1, 2], hit).any()


@pytest.mark.parametrize("device", DEVICES)
def test_of_equally_near_triangles_the_first_counts(device):
    corner, uv, triangle, alpha = _scene(0, triangles=1)
    corner[:] = [[-50, -50, 1], [100, -50, 1], [-50, 100, 1]]
    twice = np.concatenate([triangle, triangle])
    hit, *_ = _cast((corner, uv, twice, alpha), _grid(2, opaque=2), device)
    assert set(hit[:100]) == {1}
