from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from flowtree.branches.grow_twigs import grow_twigs
from flowtree.density.look_between import look_between
from flowtree.foliage.place_leaves import place_leaves
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.geometry.projection import project
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material
from flowtree.model.tree import TreeModel
from flowtree.model.volume import DensityVolume
from flowtree.params import LeafParams, MeshingParams
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou
from tests.crowns import CENTRE, HEIGHT, RADIUS, ball_crown, ball_volume, lone_branch, plane_of

BRANCHES = ball_crown(branches=100)
CROWN = BRANCHES.with_skeleton(grow_twigs(*BRANCHES.inputs))
WOOD = sweep_rings(CROWN.skeleton, params=MeshingParams(sides=3))
ARRAYS = ("position", "rotation", "scale", "color", "node")
PARAMS = st.builds(
    LeafParams,
    shape=st.sampled_from(["auto", "broad", "needle"]),
    size=st.floats(1e-3, 0.5),
    amount=st.floats(0, 4),
    most=st.integers(1, 3000),
    choice=st.floats(1, 5),
    densest=st.floats(1, 100),
    divergence=st.floats(0, 360),
    angle=st.floats(0, 120),
    plagiotropism=st.floats(0, 1),
    hang=st.floats(0, 3),
    color_variation=st.floats(0, 1),
    bearing_particles=st.integers(1, 1000),
)


def check_leaves(foliage, skeleton, most):
    if foliage is None:
        return
    count = len(foliage.scale)
    assert count > 0
    for name in ARRAYS:
        values = getattr(foliage, name)
        assert len(values) == count
        assert np.isfinite(values).all()
    assert np.allclose(np.linalg.norm(foliage.rotation, axis=1), 1, atol=1e-5)
    assert foliage.color.min() >= 0
    assert foliage.color.max() <= 1
    assert (foliage.scale > 0).all()
    assert (foliage.node > 0).all()
    # The stalk's end lies on the node's segment.
    end = skeleton.points[foliage.node]
    start = skeleton.points[skeleton.parent[foliage.node]]
    _, nearest = nearest_on_segments(foliage.position, start, end)
    assert np.linalg.norm(nearest - foliage.position, axis=1).max() < 1e-4
    assert count <= most


@settings(max_examples=15, deadline=None)
@given(params=PARAMS, seed=st.integers(0, 10_000))
def test_any_parameters_give_leaves_on_the_wood_or_none(params, seed):
    foliage = place_leaves(*CROWN.inputs, params=params, seed=seed)
    check_leaves(foliage, CROWN.skeleton, params.most)
    if params.amount == 0:
        assert foliage is None


@pytest.mark.parametrize("low", [True, False])
def test_parameters_at_their_bounds(low):
    bounds = {
        "size": (1e-4, 0.5),
        "most": (1, 5000),
        "choice": (1, 20),
        "densest": (1, 100),
        "divergence": (0, 360),
        "angle": (0, 120),
        "plagiotropism": (0, 1),
        "hang": (0, 3),
        "color_variation": (0, 1),
        "bearing_particles": (1, 1000),
        "amount": (0, 4),
    }
    params = LeafParams(**{name: pair[not low] for name, pair in bounds.items()})
    check_leaves(place_leaves(*CROWN.inputs, params=params), CROWN.skeleton, params.most)


@pytest.mark.parametrize("most", [50, 500, 5000])
@pytest.mark.parametrize("plagiotropism", [0.0, 1.0])
def test_never_more_leaves_than_allowed_and_larger_ones_instead(most, plagiotropism):
    params = LeafParams(size=0.004, most=most, plagiotropism=plagiotropism, amount=2)
    foliage = place_leaves(*CROWN.inputs, params=params)
    check_leaves(foliage, CROWN.skeleton, most)
    assert len(foliage.scale) > 0.2 * most
    assert foliage.scale.mean() > 0.004 * HEIGHT


def test_leaves_hang_on_twigs_and_thin_branches_only():
    for bearing in (1, 4):
        foliage = place_leaves(*CROWN.inputs, params=LeafParams(bearing_particles=bearing))
        thin = CROWN.skeleton.twig | (CROWN.skeleton.particles <= bearing)
        assert thin[foliage.node].all()


def rendered(foliage):
    bark = Material("bark", np.full((2, 2, 3), 90, np.uint8))
    tree = TreeModel("ball", HEIGHT, CROWN.skeleton, WOOD, bark, foliage)
    return [render_mask(tree, camera) for camera in CROWN.cameras]


def in_crown(camera, share=0.85):
    right, up = plane_of(camera)
    return np.hypot(right, up - CENTRE) < share * RADIUS


def test_the_crown_gets_the_depth_of_its_mattes():
    """The mattes show 0.7; leaves that cover a pixel twice count once, so a little less is shown."""
    foliage = place_leaves(*CROWN.inputs)
    for camera, mask in zip(CROWN.cameras, rendered(foliage), strict=True):
        assert 0.5 < mask[in_crown(camera)].mean() < 0.8


def test_amount_scales_the_leaves():
    """More than in proportion: the wood's own depth is taken off first."""
    made = [place_leaves(*CROWN.inputs, params=LeafParams(amount=amount)).scale for amount in (0.4, 0.8, 1.6)]
    area = [float((scale**2).sum()) for scale in made]
    assert 2 * area[0] < area[1]
    assert 1.6 < area[2] / area[1] < 2.6


def test_where_few_leaves_do_they_are_small_and_where_many_are_asked_for_large():
    """A leaf as long as a cell of the measure blurs the gaps of an open crown."""
    lengths, counts = [], []
    for amount in (0.1, 1.0, 4.0):
        foliage = place_leaves(*CROWN.inputs, params=LeafParams(amount=amount, most=14_000))
        lengths.append(float(foliage.scale.mean()) / HEIGHT / LeafParams().size)
        counts.append(len(foliage.scale))
    assert lengths[0] == pytest.approx(0.7, abs=0.05)
    assert lengths == sorted(lengths)
    assert lengths[-1] > 1.2
    assert max(counts) <= 14_000


def with_hole(scene, centre, radius):
    """The first matte without what lies in a disc of its crown."""
    right, up = plane_of(scene.cameras[0])
    hole = np.hypot(right - centre[0], up - centre[1]) < radius
    alpha = np.where(hole, 0.0, scene.mattes[0].alpha).astype(np.float32)
    return hole, [replace(scene.mattes[0], alpha=alpha), scene.mattes[1]]


def test_a_hole_in_a_matte_stays_a_hole():
    """A tenth of the crown, as sky through the leaves; the volume knows nothing of it."""
    hole, mattes = with_hole(CROWN, (0.9, CENTRE + 0.4), np.sqrt(0.1) * RADIUS)
    foliage = place_leaves(CROWN.skeleton, CROWN.volume, mattes, CROWN.cameras)
    mask, wood = rendered(foliage)[0], rendered(None)[0]
    around = in_crown(CROWN.cameras[0]) & ~hole
    assert hole.sum() > 0.09 * in_crown(CROWN.cameras[0], 1.0).sum()
    assert (mask - wood)[hole].mean() < 0.05
    assert mask[around].mean() > 0.5


def test_no_leaf_projects_where_a_matte_is_empty():
    foliage = place_leaves(*CROWN.inputs)
    along = Rotation.from_quat(foliage.rotation).apply(np.tile([0.0, 1, 0], (len(foliage.scale), 1)))
    middle = foliage.position + 0.5 * foliage.scale[:, None] * along
    for camera in CROWN.cameras:
        pixel = project(middle, camera)
        right, up = (pixel[:, 0] - camera.foot[0]) * 0.05, (camera.foot[1] - pixel[:, 1]) * 0.05
        assert np.hypot(right, up - CENTRE).max() < RADIUS + 1.5 * HEIGHT / 80
    assert (middle[:, 1] > CENTRE - RADIUS - 0.15).all(), "no leaf hangs on the stem"


def test_dense_voxels_hold_more_leaves():
    """Where mattes hardly tell: opposite quarters of the crown, which each view sees before the others."""
    volume = ball_volume()
    density = volume.density.copy()
    x, z = (np.indices(density.shape)[[0, 2]] + 0.5) * volume.voxel - HEIGHT / 2
    density[x * z > 0] *= 6  # two opposite quarters: either view sees as much of them left as right
    uneven = DensityVolume(density, volume.origin, volume.voxel)
    foliage = place_leaves(CROWN.skeleton, uneven, CROWN.mattes, CROWN.cameras)
    dense = (foliage.position[:, 0] * foliage.position[:, 2] > 0).mean()
    even = place_leaves(*CROWN.inputs).position
    assert dense > (even[:, 0] * even[:, 2] > 0).mean()


def test_plagiotropism_turns_the_upper_side_to_the_sky():
    up = []
    for strength in (0.0, 1.0):
        foliage = place_leaves(*CROWN.inputs, params=LeafParams(plagiotropism=strength))
        count = len(foliage.scale)
        upper = Rotation.from_quat(foliage.rotation).apply(np.tile([0.0, 0, 1], (count, 1)))
        up.append(upper[:, 1].mean())
    assert up[1] > up[0] + 0.2
    assert up[1] > 0.5


def test_more_hang_hangs_lower():
    tips = []
    for hang in (0.0, 1.0, 3.0):
        foliage = place_leaves(*CROWN.inputs, params=LeafParams(hang=hang))
        count = len(foliage.scale)
        tips.append(Rotation.from_quat(foliage.rotation).apply(np.tile([0.0, 1, 0], (count, 1)))[:, 1].mean())
    assert tips[0] > tips[1] > tips[2]


@pytest.mark.parametrize("divergence", [90.0, 137.5, 180.0])
def test_from_leaf_to_leaf_it_turns_by_the_divergence(divergence):
    """Along a plain twig whose leaves all stay: more are asked for than there are places."""
    twig = lone_branch((1, 0, 0), nodes=1, length=4.0)
    scene = ball_crown(0.99).with_skeleton(twig)
    params = LeafParams(
        divergence=divergence, plagiotropism=1, hang=0, densest=2, size=0.02, amount=4, most=2_000_000
    )
    foliage = place_leaves(*scene.inputs, params=params)
    order = np.argsort(foliage.position[:, 0])
    count = len(order)
    along = Rotation.from_quat(foliage.rotation[order]).apply(np.tile([0.0, 1, 0], (count, 1)))
    turn = np.arctan2(along[:, 2], along[:, 1])
    assert count > 20
    steps = np.exp(1j * np.diff(turn))
    mean = np.degrees(np.angle(steps.mean())) % 360
    assert min(abs(mean - divergence), abs(mean - (360 - divergence))) < 15  # 20 degrees of jitter each
    assert np.abs(steps.mean()) > 0.6


def test_colours_are_those_of_the_photo():
    left = plane_of(CROWN.cameras[0])[0] < 0
    red_green = np.where(left[..., None], (160, 30, 20), (40, 150, 30)).astype(np.uint8)
    mattes = [replace(matte, foreground=red_green) for matte in CROWN.mattes]
    foliage = place_leaves(CROWN.skeleton, CROWN.volume, mattes[:1], CROWN.cameras[:1])
    is_red = foliage.color[:, 0] > foliage.color[:, 1]
    assert is_red[foliage.position[:, 0] < -0.3].all()
    assert not is_red[foliage.position[:, 0] > 0.3].any()


def test_equal_seeds_give_equal_bytes_and_others_do_not():
    one, same, other = (place_leaves(*CROWN.inputs, seed=s) for s in (5, 5, 6))
    for name in ARRAYS:
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert one.position.shape != other.position.shape or not np.array_equal(one.position, other.position)


def test_where_there_is_no_room_there_are_no_leaves():
    empty = [replace(m, alpha=np.zeros_like(m.alpha)) for m in CROWN.mattes]
    assert place_leaves(CROWN.skeleton, CROWN.volume, empty, CROWN.cameras) is None
    limbs = replace(CROWN.skeleton, particles=np.full_like(CROWN.skeleton.particles, 99))
    limbs = replace(limbs, twig=np.zeros_like(limbs.twig))
    assert place_leaves(limbs, CROWN.volume, CROWN.mattes, CROWN.cameras) is None


def test_odd_inputs_break_nothing():
    speck = DensityVolume(np.float32([[[1.0]]]), np.float32([0, 0, 0]), HEIGHT)
    check_leaves(place_leaves(CROWN.skeleton, speck, CROWN.mattes, CROWN.cameras), CROWN.skeleton, 24_000)
    stem = lone_branch((1, 0, 0), nodes=1)
    check_leaves(place_leaves(*CROWN.with_skeleton(stem).inputs), stem, 24_000)
    points = CROWN.skeleton.points.copy()
    thin = np.flatnonzero(CROWN.skeleton.twig)[::3]
    points[thin] = points[CROWN.skeleton.parent[thin]]
    flat = replace(CROWN.skeleton, points=points)
    check_leaves(place_leaves(*CROWN.with_skeleton(flat).inputs), flat, 24_000)
    one_pixel = Matte(np.ones((1, 1), np.float32), np.zeros((1, 1, 3), np.uint8), "trimap")
    camera = replace(CROWN.cameras[0], width=1, height=1, foot=(0.5, 1.0), metres_per_pixel=HEIGHT)
    check_leaves(place_leaves(CROWN.skeleton, CROWN.volume, [one_pixel], [camera]), CROWN.skeleton, 24_000)


def test_leaves_come_near_the_volume_between_the_photographs():
    between = look_between(CROWN.volume, CROWN.cameras, loose=True)
    assert between

    def wrong(foliage):
        tree = TreeModel(
            "tree", HEIGHT, CROWN.skeleton, WOOD, Material("bark", np.full((2, 2, 3), 90, np.uint8)), foliage
        )
        return sum(
            1.0
            - soft_iou(render_mask(tree, view.camera), view.camera, view.alpha, view.camera, height=HEIGHT)
            for view in between
        )

    without, led = (place_leaves(*CROWN.inputs, between=views) for views in ((), between))
    assert wrong(led) < 0.9 * wrong(without)
