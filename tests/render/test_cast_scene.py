"""Sorting triangles into tiles changes speed, never a hit; nor does the number of cores."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.projection import project, view_axes
from flowtree.kernels.reference.cast_rays import cast_rays as cast_rays_twin
from flowtree.model.camera import Camera
from flowtree.render import cast_scene as casting
from flowtree.render.assemble_scene import assemble_scene
from flowtree.render.cast_scene import ParallelView, cast_scene
from tests.trees import bare_tree, hand_made_tree


def _view(yaw, samples=2, size=40, metres=0.1, foot=(20.0, 38.0)):
    return ParallelView(np.stack(view_axes(yaw)), metres, foot, size, size - 3, samples)


@settings(max_examples=10, deadline=None)
@given(yaw=st.floats(-360, 360), samples=st.integers(1, 3), metres=st.sampled_from([0.02, 0.1, 0.5]))
def test_equals_every_ray_against_every_triangle(yaw, samples, metres):
    scene = assemble_scene(hand_made_tree(8, branch_count=1))
    view = _view(yaw, samples, metres=metres)
    hits = cast_scene(scene, view)
    rows, columns = hits.hit.shape
    grid = SimpleNamespace(
        columns=columns,
        rows=rows,
        group=samples,
        tile=max(rows, columns),
        tiles_across=1,
        opaque=scene.wood_triangles,
        cutoff=scene.cutoff,
        any_hit=0,
    )
    hit, near = np.zeros(rows * columns, np.int32), np.zeros(rows * columns)
    lists = (np.zeros(1, np.int32), np.zeros(2, np.int32), np.zeros(0, np.int32))
    cast_rays_twin(0, hits.corner, scene.uvs, scene.triangles, scene.alpha, *lists, grid, hit, near)
    # Prisms of one branch touch along whole edges: there float32 may name the neighbour, equally near.
    assert ((hit > 0) == (hits.hit.ravel() > 0)).mean() > 0.995
    both = (hit > 0) & (hits.hit.ravel() > 0)
    far = np.abs(near - hits.near.ravel())[both] > 1e-3
    assert far.mean() < 0.01 if len(far) else True


def test_projects_as_the_project_does():
    scene = assemble_scene(hand_made_tree(20))
    view = _view(33.0, samples=3)
    camera = Camera(33.0, view.metres_per_pixel, view.foot, view.width, view.height)
    wanted = 3 * project(scene.positions.T, camera)
    assert np.allclose(cast_scene(scene, view).corner[:, :2], wanted, atol=1e-3)


@pytest.mark.parametrize("threads", ["1", "2", "3"])
def test_cores_do_not_change_a_byte(monkeypatch, threads):
    scene = assemble_scene(hand_made_tree(200))
    view = _view(20.0, size=200, metres=0.02, foot=(100, 190))
    alone = cast_scene(scene, view)
    monkeypatch.setenv("FLOWTREE_THREADS", threads)
    shared = cast_scene(scene, view)
    assert alone.hit.tobytes() == shared.hit.tobytes()
    assert alone.near.tobytes() == shared.near.tobytes()


def test_tile_size_does_not_change_a_byte(monkeypatch):
    scene = assemble_scene(hand_made_tree(60))
    wanted = cast_scene(scene, _view(10.0))
    monkeypatch.setattr(casting, "_TILE", 8)
    small = cast_scene(scene, _view(10.0))
    monkeypatch.setattr(casting, "_MOST_TILES", 4)
    large = cast_scene(scene, _view(10.0))
    for other in (small, large):
        assert wanted.hit.tobytes() == other.hit.tobytes()
        assert wanted.near.tobytes() == other.near.tobytes()


def test_a_tree_out_of_the_picture_is_not_met():
    scene = assemble_scene(bare_tree())
    assert not cast_scene(scene, _view(0.0, foot=(-500.0, 20.0))).hit.any()
