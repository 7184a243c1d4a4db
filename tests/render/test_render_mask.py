"""Coverage: what is known exactly, what must not matter, and bad input."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.model.camera import Camera
from flowtree.model.mesh import TreeMesh
from flowtree.render import camera_bands
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_mask import render_mask
from tests.trees import bare_tree, hand_made_tree, unusual_tree


def _flat_tree(points):
    """A tree whose wood is one triangle in the plane z = 0."""
    corners = np.concatenate([points, np.zeros((3, 1))], axis=1).astype(np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (3, 1))
    mesh = TreeMesh(corners, normals, np.zeros((3, 2), np.float32), np.array([[0, 1, 2]], np.int32))
    return replace(bare_tree(), wood=mesh)


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-0.9, 0.9), min_size=6, max_size=6), st.floats(-80, 80))
def test_covers_the_projected_area(numbers, yaw):
    points = np.reshape(numbers, (3, 2))
    b, c = points[1] - points[0], points[2] - points[0]
    area = 0.5 * abs(b[0] * c[1] - b[1] * c[0]) * np.cos(np.radians(yaw))
    mask = render_mask(_flat_tree(points), Camera(yaw, 2 / 64, (32, 32), 64, 64), samples=8)
    border = (
        8.0 * 64 / 2 / 8
    )  # rays that an outline of length 8 m or less can misjudge, in pixels, generously
    assert mask.sum() == pytest.approx(area * 32**2, abs=0.2 * border)


def test_a_steep_edge_has_as_many_shades_as_rays():
    mask = render_mask(
        _flat_tree(np.array([[0.0, -9], [0.0, 9], [-9, 0]])), Camera(0.0, 1 / 64, (32.43, 32), 64, 64)
    )
    assert mask[10:50, 32] == pytest.approx(0.43, abs=1 / 16)


def test_a_leaf_is_where_its_texture_is():
    tree = replace(hand_made_tree(40), wood=replace(bare_tree().wood, triangles=np.zeros((0, 3), np.int32)))
    camera = fit_camera(tree, 0.0, 96)
    clear = tree.foliage.material.base_color.copy()
    clear[..., 3] = 0
    solid = clear.copy()
    solid[..., 3] = 255

    def covered(picture):
        material = replace(tree.foliage.material, base_color=picture)
        return render_mask(replace(tree, foliage=replace(tree.foliage, material=material)), camera)

    assert covered(clear).sum() == 0
    shaped, full = render_mask(tree, camera), covered(solid)
    assert (shaped <= full).all()
    # An ellipse with the half axes 0.816 and 1 in a square from -1 to 1; leaves that overlap hide a little.
    assert shaped.sum() / full.sum() == pytest.approx(np.pi * 0.816 / 4, abs=0.06)


def test_the_other_side_is_the_mirror_image():
    tree = hand_made_tree(80)
    front = render_mask(tree, Camera(0.0, 0.05, (48.0, 90.0), 96, 96))
    back = render_mask(tree, Camera(180.0, 0.05, (48.0, 90.0), 96, 96))
    # The rays of a pixel are not their own mirror image.
    assert np.abs(front - back[:, ::-1]).mean() < 0.01


def test_bands_leave_no_trace(monkeypatch):
    tree = hand_made_tree(80)
    camera = fit_camera(tree, 20.0, 120)
    wanted = render_mask(tree, camera, samples=2)
    monkeypatch.setattr(camera_bands, "_MOST_RAYS", 120 * 4 * 17)
    # A band's rays count from its own top: float32 rounds their distance to an edge elsewhere.
    assert (render_mask(tree, camera, samples=2) != wanted).mean() < 1e-3


def test_unusual_counts_are_drawn():
    tree = unusual_tree()
    assert render_mask(tree, fit_camera(tree, 0.0, 32)).max() > 0


def test_nothing_gives_nothing():
    tree = bare_tree()
    empty = replace(tree, wood=replace(tree.wood, triangles=np.zeros((0, 3), np.int32)))
    assert not render_mask(empty, Camera(0.0, 0.1, (4, 8), 8, 8)).any()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"metres_per_pixel": 0.0}, "metres_per_pixel"),
        ({"metres_per_pixel": float("nan")}, "finite"),
        ({"width": 0}, "pixels a side"),
        ({"height": 10**6}, "pixels a side"),
        ({"yaw": float("inf")}, "finite"),
    ],
)
def test_a_camera_without_a_picture_is_refused(change, words):
    with pytest.raises(InputError, match=words):
        render_mask(bare_tree(), replace(Camera(0.0, 0.1, (4, 8), 8, 8), **change))


def test_broken_trees_are_refused():
    tree, camera = hand_made_tree(3), Camera(0.0, 0.1, (4, 8), 8, 8)
    positions = tree.wood.positions.copy()
    positions[0, 0] = np.nan
    beyond = tree.wood.triangles + len(positions)
    flat = replace(tree.bark, base_color=np.zeros((4, 4), np.uint8))
    for broken, words in (
        (replace(tree, wood=replace(tree.wood, positions=positions)), "wood positions"),
        (replace(tree, wood=replace(tree.wood, triangles=beyond)), "wood triangles"),
        (replace(tree, foliage=replace(tree.foliage, scale=tree.foliage.scale[:1])), "leaf scale"),
        (replace(tree, bark=flat), "bark texture"),
    ):
        with pytest.raises(InputError, match=words):
            render_mask(broken, camera)
    with pytest.raises(InputError, match="samples"):
        render_mask(tree, camera, samples=9)
    with pytest.raises(InputError, match="neither"):
        fit_camera(replace(tree, wood=replace(tree.wood, triangles=beyond[:0]), foliage=None), 0.0, 8)
