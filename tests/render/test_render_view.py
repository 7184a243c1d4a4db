"""Pictures: their alpha is the mask, light behaves like light, and equal input gives equal bytes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.projection import foreshorten
from flowtree.geometry.srgb import encode_srgb
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.camera import Camera
from flowtree.model.mesh import Material
from flowtree.model.tree import TreeModel
from flowtree.params import RenderParams
from flowtree.render.assemble_scene import assemble_scene
from flowtree.render.fit_camera import fit_camera
from flowtree.render.gather_sky_light import gather_sky_light
from flowtree.render.render_mask import render_mask
from flowtree.render.render_view import render_view
from flowtree.render.sample_texture import build_pyramid, sample_texture
from tests.trees import bare_tree, hand_made_skeleton, hand_made_tree, unusual_tree


@settings(max_examples=5, deadline=None)
@given(yaw=st.floats(-180, 180), samples=st.integers(1, 3), leaves=st.integers(0, 30))
def test_alpha_is_the_mask(yaw, samples, leaves):
    tree = hand_made_tree(leaves)
    camera = fit_camera(tree, yaw, 64)
    alpha = render_view(tree, camera, params=RenderParams(samples=samples))[:, :, 3]
    assert (alpha == np.rint(255 * render_mask(tree, camera, samples=samples))).all()


def test_equal_input_gives_equal_bytes(monkeypatch):
    tree = hand_made_tree(100)
    camera = fit_camera(tree, 30.0, 96)
    monkeypatch.setenv("FLOWTREE_THREADS", "1")
    alone = render_view(tree, camera)
    monkeypatch.setenv("FLOWTREE_THREADS", "2")
    assert render_view(tree, camera).tobytes() == alone.tobytes()


def test_an_eye_sees_the_tree_foreshortened():
    tree = hand_made_tree(60)
    camera = fit_camera(tree, 20.0, 96)
    near = replace(camera, distance=1.6 * tree.height, eye=0.2 * tree.height)
    bare = replace(tree, foliage=None)
    moved = foreshorten(bare.wood.positions, near).astype(np.float32)
    there = replace(bare, wood=replace(bare.wood, positions=moved))
    assert np.allclose(render_mask(bare, near), render_mask(there, camera), atol=0.07)
    assert not np.allclose(render_mask(bare, near), render_mask(bare, camera), atol=0.5)


def test_from_far_away_an_eye_sees_what_parallel_rays_do():
    tree = hand_made_tree(60)
    camera = fit_camera(tree, 20.0, 96)
    far = replace(camera, distance=1e4 * tree.height, eye=0.2 * tree.height)
    parallel, seen = (render_view(tree, view).astype(int) for view in (camera, far))
    assert np.quantile(np.abs(parallel - seen), 0.99) <= 4


def test_shadows_stay_on_what_they_fall_on_however_near_the_eye():
    # A floor under a roof: from near it is seen larger, and not any lighter.
    def slab(low, high, y, size):
        x, z = np.array([low, high, high, low]), np.array([low, low, high, high])
        return np.stack([x * size, np.full(4, y), z * size], axis=1)

    tree = bare_tree(hand_made_skeleton())
    points = np.concatenate([slab(-1, 1, 0.2, 1.0), slab(-1, 1, 2.5, 4.0)]).astype(np.float32)
    faces = np.array([[0, 2, 1], [0, 3, 2], [4, 6, 5], [4, 7, 6]], np.int32)
    normals = np.tile(np.float32([0, 1, 0]), (8, 1))
    wood = replace(
        tree.wood,
        positions=points,
        triangles=faces,
        normals=normals,
        uvs=np.zeros((8, 2), np.float32),
        tangents=None,
    )
    camera = Camera(0.0, 0.05, (40.0, 60.0), 80, 80, 6.0, 1.5)
    shaded = render_view(replace(tree, wood=wood), camera)
    bare = render_view(replace(tree, wood=replace(wood, triangles=faces[:2])), camera)
    floor = (bare[..., 3] == 255) & (np.arange(80)[:, None] > 50)
    assert floor.sum() > 200
    assert (shaded[floor][:, :3] < 0.8 * bare[floor][:, :3]).all()


def _brightness(picture):
    covered = picture[:, :, 3] == 255
    return picture[covered][:, :3].mean()


def test_more_light_is_brighter_and_none_is_black():
    tree = hand_made_tree(60)
    camera = fit_camera(tree, 0.0, 64)
    levels = [
        _brightness(render_view(tree, camera, params=RenderParams(sun=sun, sky=sky)))
        for sun, sky in ((0, 0), (0, 1), (2, 1), (4, 2))
    ]
    assert levels[0] == 0
    assert levels == sorted(levels)
    assert levels[0] < levels[1] < levels[2] < levels[3]


def _trunk(normal):
    """A stem whose bark is plain but for its relief."""
    skeleton = hand_made_skeleton(0)
    bark = Material("bark", np.full((16, 16, 3), 128, np.uint8), normal=normal)
    return TreeModel("stem", 3.5, skeleton, sweep_rings(skeleton), bark, None)


def test_a_flat_relief_changes_nothing_and_a_leaning_one_catches_the_sun():
    flat, right, left = (
        np.broadcast_to(np.array(color, np.uint8), (16, 16, 3)).copy()
        for color in ((128, 128, 255), (200, 128, 220), (55, 128, 220))
    )
    plain, same, rightward, leftward = (_trunk(normal) for normal in (None, flat, right, left))
    camera = fit_camera(plain, 0.0, 96)
    light = RenderParams(sun_azimuth=70.0, sun_elevation=20.0, sky=0.3)
    one, two, lit, unlit = (
        render_view(tree, camera, params=light).astype(float) for tree in (plain, same, rightward, leftward)
    )
    covered = one[:, :, 3] == 255
    assert np.abs(one - two)[covered].mean() < 4.0  # a face's normals are one direction at its vertices alone
    front = covered & (np.cumsum(covered, axis=1) * 2 < covered.sum(axis=1, keepdims=True))
    assert lit[front][:, :3].mean() > one[front][:, :3].mean() + 5
    assert unlit[front][:, :3].mean() < one[front][:, :3].mean() - 5


def test_light_shines_through_translucent_leaves():
    """With the sun behind the tree, its leaves glow the more they let through, and wood does not."""
    tree = hand_made_tree(200)
    camera = fit_camera(tree, 0.0, 96)
    behind = RenderParams(sun_azimuth=180.0, sky=0.2)
    pictures = []
    for share in (0.0, 0.3, 0.6):
        material = replace(tree.foliage.material, translucency=share)
        leafy = replace(tree, foliage=replace(tree.foliage, material=material))
        pictures.append(render_view(leafy, camera, params=behind).astype(float))
    leaf = (pictures[0] != pictures[2]).any(axis=2) & (pictures[0][:, :, 3] == 255)
    assert leaf.sum() > 50
    dark, half, bright = (picture[leaf][:, :3].mean() for picture in pictures)
    assert dark < half < bright
    assert bright > 1.3 * dark


def test_the_side_of_the_sun_is_the_bright_one():
    tree = hand_made_tree(0, branch_count=0)
    camera = fit_camera(tree, 0.0, 128)
    for azimuth, bright in ((-80.0, 0), (80.0, 1)):
        picture = render_view(tree, camera, params=RenderParams(sun_azimuth=azimuth, sun_elevation=20))
        middle = round(camera.foot[0])
        halves = [_brightness(picture[:, part]) for part in (slice(0, middle), slice(middle, None))]
        assert int(np.argmax(halves)) == bright


@pytest.mark.parametrize("tree", [unusual_tree(), bare_tree()], ids=["unusual", "bare"])
def test_odd_trees_are_drawn(tree):
    picture = render_view(tree, fit_camera(tree, 45.0, 48))
    assert picture.shape == (48, 48, 4)
    assert picture[:, :, 3].max() > 0


def test_an_empty_tree_is_an_empty_picture():
    tree = replace(bare_tree(), wood=replace(bare_tree().wood, triangles=np.zeros((0, 3), np.int32)))
    assert not render_view(tree, Camera(0.0, 0.1, (4, 8), 8, 6)).any()


def test_sky_light_is_whole_in_the_open_and_less_in_the_crown():
    scene = assemble_scene(hand_made_tree(3000, branch_count=9))
    sky = gather_sky_light(scene)
    assert (sky[:, 0] >= 0).all()
    assert (sky[:, 0] <= 0.5 + 1e-5).all(), "each half of the sphere is half of it"
    leaves = scene.positions[:, scene.wood_vertices :]
    middle = leaves.mean(axis=1, keepdims=True)
    far = np.linalg.norm(leaves - middle, axis=0)
    seen = sky[0, 0, scene.wood_vertices :]
    inner, outer = far < np.quantile(far, 0.2), far > np.quantile(far, 0.8)
    assert seen[inner].mean() < seen[outer].mean()
    alone = gather_sky_light(assemble_scene(unusual_tree()))
    assert alone[0, 0].mean() == pytest.approx(0.5, abs=0.1)


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 9), st.integers(1, 9), st.integers(0, 1000))
def test_a_texture_comes_back_at_its_texels(rows, columns, seed):
    picture = np.random.default_rng(seed).integers(0, 256, (rows, columns, 3)).astype(np.uint8)
    levels = build_pyramid(picture)
    assert levels[-1].shape[:2] == (1, 1)
    y, x = (part.ravel() for part in np.mgrid[:rows, :columns])
    uv = np.stack([(x + 0.5) / columns, (y + 0.5) / rows], axis=1).astype(np.float32)
    turned = uv + np.random.default_rng(seed).integers(-3, 4, uv.shape)  # the texture repeats
    found = sample_texture(levels, turned.astype(np.float32), np.zeros(len(uv), np.int8))
    assert np.abs(255 * encode_srgb(found) - picture[y, x]).max() < 1


def test_a_halved_texture_ignores_what_is_not_there():
    picture = np.zeros((8, 8, 4), np.uint8)
    picture[::2, :, :] = (50, 200, 90, 255)
    picture[1::2, :, :3] = 255
    levels = build_pyramid(picture)
    assert np.allclose(255 * encode_srgb(levels[-1])[0, 0], (50, 200, 90), atol=2)
    tree = hand_made_tree(20)
    green = Material("leaf", picture, alpha_cutoff=0.5)
    seen = render_view(
        replace(tree, foliage=replace(tree.foliage, material=green)), fit_camera(tree, 0.0, 32)
    )
    assert seen[:, :, 3].any()


@settings(max_examples=20, deadline=None)
@given(yaw=st.floats(-720, 720), size=st.integers(16, 200), leaves=st.integers(0, 20))
def test_the_camera_sees_the_whole_tree(yaw, size, leaves):
    tree = hand_made_tree(leaves)
    camera = fit_camera(tree, yaw, size)
    wide = replace(
        camera, width=3 * size, height=3 * size, foot=(camera.foot[0] + size, camera.foot[1] + size)
    )
    seen = render_mask(tree, wide, samples=1)
    assert seen.sum() > 0
    seen[size + 1 : size + camera.height - 1, size + 1 : size + camera.width - 1] = 0
    assert seen.sum() == 0, "something lies outside of the camera's picture or on its margin"
