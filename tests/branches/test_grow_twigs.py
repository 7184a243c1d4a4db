from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.branches.grow_twigs import grow_twigs
from flowtree.geometry.cover_canvas import CELLS, lay_canvas
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.mesh import Material
from flowtree.model.tree import TreeModel
from flowtree.model.volume import DensityVolume
from flowtree.params import TwigParams
from flowtree.render.render_mask import render_mask
from tests.crowns import CENTRE, HEIGHT, RADIUS, ball_crown, ball_volume, lone_branch, plane_of

CROWN = ball_crown()
FIELDS = ("parent", "points", "radius", "particles", "level", "twig")
PARAMS = st.builds(
    TwigParams,
    length=st.floats(1e-3, 0.5),
    bare_length=st.floats(1e-3, 0.5),
    frequency=st.floats(0, 300),
    most=st.integers(0, 5000),
    divergence=st.floats(0, 360),
    angle=st.floats(0, 120),
    plagiotropism=st.floats(0, 1),
    rigidity=st.floats(0, 1),
    curl=st.floats(0, 1),
    side_twigs=st.integers(0, 12),
    radius=st.floats(1e-6, 0.01),
    bearing_particles=st.integers(1, 10_000),
)


def check_grown(made, before):
    count, own = len(made.parent), len(before.parent)
    assert made.parent[0] == -1
    assert (made.parent[1:] >= 0).all()
    assert (made.parent < np.arange(count)).all()
    assert np.isfinite(made.points).all()
    assert (made.radius[1:] <= made.radius[made.parent[1:]] * (1 + 1e-6)).all()
    assert not (made.twig[made.parent[1:]] & ~made.twig[1:]).any(), "a branch grows from a twig"
    assert (made.particles[made.twig] == 1).all()
    # What was there stays.
    assert count - made.twig.sum() == own
    assert np.array_equal(made.points[~made.twig], before.points)
    assert np.array_equal(made.radius[~made.twig], before.radius)
    assert np.array_equal(made.particles[~made.twig], before.particles)
    for name in FIELDS:
        assert len(getattr(made, name)) == count


def bases(made):
    """Of every twig: the branch's node that it grows from, its first node and its shoot's tip."""
    above = np.maximum(made.parent, 0)
    first = np.flatnonzero(made.twig & ~made.twig[above])
    ahead = {int(p): k for k, p in reversed(list(enumerate(made.parent)))}
    tips = [ahead[ahead[int(k)]] for k in first]
    return made.parent[first], first, np.array(tips)


@settings(max_examples=25, deadline=None)
@given(params=PARAMS, seed=st.integers(0, 10_000), leafy=st.booleans())
def test_any_parameters_give_a_tree(params, seed, leafy):
    made = grow_twigs(*CROWN.inputs, leafy=leafy, params=params, seed=seed)
    check_grown(made, CROWN.skeleton)
    if params.most == 0 or params.frequency == 0:
        assert not made.twig.any()


@pytest.mark.parametrize("low", [True, False])
def test_parameters_at_their_bounds(low):
    bounds = {
        "length": (1e-6, 0.5),
        "bare_length": (1e-6, 0.5),
        "frequency": (1, 600),
        "most": (1, 200_000),
        "divergence": (0, 360),
        "angle": (0, 120),
        "plagiotropism": (0, 1),
        "rigidity": (0, 1),
        "curl": (0, 1),
        "side_twigs": (0, 12),
        "radius": (1e-9, 0.01),
        "bearing_particles": (1, 1_000_000),
    }
    params = TwigParams(**{name: pair[not low] for name, pair in bounds.items()})
    for leafy in (True, False):
        check_grown(grow_twigs(*CROWN.inputs, leafy=leafy, params=params), CROWN.skeleton)


def every_twig(along, **params):
    """All twigs that a straight branch can bear: the mattes ask for more than it has."""
    scene = ball_crown(0.99).with_skeleton(lone_branch(along))
    plain = TwigParams(
        frequency=20 * HEIGHT / 4.0,
        most=200_000,
        bare_length=0.03,
        curl=0,
        side_twigs=0,
        bearing_particles=1,
    )
    made = grow_twigs(*scene.inputs, leafy=False, params=plain.model_copy(update=params))
    check_grown(made, scene.skeleton)
    return made, *bases(made)


@pytest.mark.parametrize("divergence", [137.5, 90.0, 180.0])
@pytest.mark.parametrize("along", [(1, 0.3, 0.2), (0, 1, 0)])
def test_from_twig_to_twig_it_turns_by_the_divergence(divergence, along):
    made, base, first, _ = every_twig(along, divergence=divergence, plagiotropism=0, rigidity=1)
    axis = np.array(along) / np.linalg.norm(along)
    out = made.points[first] - made.points[base]
    across = out - np.outer(out @ axis, axis)
    one = np.cross(axis, [0.3, 0.5, -0.8])
    one /= np.linalg.norm(one)
    turn = np.degrees(np.arctan2(across @ np.cross(axis, one), across @ one))[np.lexsort((first, base))]
    assert len(turn) > 15
    steps = np.exp(1j * np.radians(np.diff(turn)))
    mean = np.degrees(np.angle(steps.mean())) % 360
    assert min(abs(mean - divergence), abs(mean - (360 - divergence))) < 8  # 12 degrees of jitter each
    assert np.abs(steps.mean()) > 0.85, "the steps are alike"


def test_twigs_leave_their_branch_at_the_angle():
    for angle in (30.0, 60.0):
        made, base, first, _ = every_twig((1, 0.2, 0), angle=angle, plagiotropism=0, rigidity=1)
        axis = np.array([1, 0.2, 0]) / np.hypot(1, 0.2)
        out = made.points[first] - made.points[base]
        found = np.degrees(np.arccos(out @ axis / np.linalg.norm(out, axis=1)))
        assert found.min() >= 0.7 * angle - 0.1
        assert found.max() <= 1.2 * angle + 0.1


def rises(along, **params):
    """Of every twig, from its base to its tip, as a share of its length."""
    made, base, _, tips = every_twig(along, **params)
    out = made.points[tips] - made.points[base]
    return out[:, 1] / np.linalg.norm(out, axis=1)


def test_plagiotropism_turns_twigs_to_the_horizontal():
    slopes = [np.abs(rises((0, 1, 0), plagiotropism=p, rigidity=1)).mean() for p in (0.0, 0.5, 1.0)]
    assert slopes[0] > slopes[1] > slopes[2]
    assert slopes[2] == pytest.approx(0, abs=1e-5)


def test_what_is_not_rigid_hangs():
    stiff, soft, limp = (rises((1, 0, 0), rigidity=r).mean() for r in (1.0, 0.5, 0.0))
    assert stiff > soft > limp


def test_upright_twigs_on_an_upright_branch_keep_their_length():
    made, base, _, tips = every_twig((0, 1, 0), angle=0, plagiotropism=1, rigidity=1)
    length = np.linalg.norm(made.points[tips] - made.points[base], axis=1)
    assert length.min() > 0.4 * 0.03 * HEIGHT


@pytest.mark.parametrize("leafy", [True, False])
def test_lengths_are_the_ones_asked_for_and_no_twig_ends_outside(leafy):
    params = TwigParams(length=0.03, bare_length=0.05, curl=0, rigidity=1)
    made = grow_twigs(*CROWN.inputs, leafy=leafy, params=params)
    base, _, tips = bases(made)
    length = np.linalg.norm(made.points[tips] - made.points[base], axis=1) / HEIGHT
    mean = 0.03 if leafy else 0.05
    assert length.min() > 0.4 * mean - 1e-5
    assert length.max() < 1.45 * mean + 1e-5
    voxel = np.floor((made.points[tips] - CROWN.volume.origin) / CROWN.volume.voxel).astype(int)
    assert (CROWN.volume.density[tuple(voxel.T)] > 0).all()


def test_no_twig_grows_on_thick_limbs_or_on_the_stem():
    made = grow_twigs(*CROWN.inputs, params=TwigParams(bearing_particles=2))
    base, _, tips = bases(made)
    assert (made.particles[base] <= 2).all()
    assert (made.points[tips, 1] > CENTRE - 2.4 - 0.3).all()


def test_a_bare_tree_gets_the_alpha_of_its_mattes():
    """In sum over the crown, of the finished wood."""
    scene = ball_crown(0.35, branches=60)
    made = grow_twigs(*scene.inputs, leafy=False)
    bark = Material("bark", np.full((2, 2, 3), 90, np.uint8))
    for matte, camera in zip(scene.mattes, scene.cameras, strict=True):
        crown = np.hypot(plane_of(camera)[0], plane_of(camera)[1] - CENTRE) < 0.9 * RADIUS
        before, after = (
            render_mask(TreeModel("ball", HEIGHT, s, sweep_rings(s), bark, None), camera)[crown].mean()
            for s in (scene.skeleton, made)
        )
        assert before < 0.6 * matte.alpha[crown].mean()
        assert after == pytest.approx(matte.alpha[crown].mean(), rel=0.15)


def test_a_hole_in_the_mattes_gets_fewer_twigs():
    right, up = plane_of(CROWN.cameras[0])
    hole = np.hypot(right - 0.8, up - CENTRE) < 0.6
    mattes = [replace(CROWN.mattes[0], alpha=np.where(hole, 0, CROWN.mattes[0].alpha)), CROWN.mattes[1]]

    def inside(made):
        tips = made.points[made.twig]
        return (np.hypot(tips[:, 0] - 0.8, tips[:, 1] - CENTRE) < 0.5).sum()

    whole = inside(grow_twigs(*CROWN.inputs))
    holed = inside(grow_twigs(CROWN.skeleton, CROWN.volume, mattes, CROWN.cameras))
    assert whole > 50
    assert holed < 0.25 * whole


def test_of_twigs_that_serve_the_mattes_alike_those_in_dense_places_are_likelier():
    skeleton, volume, mattes, cameras = ball_crown(alpha=0.1).inputs
    depth = (np.arange(volume.density.shape[2]) + 0.5) * volume.voxel + volume.origin[2]
    uneven = replace(volume, density=volume.density * np.where(depth > 0, 1.0, 0.1).astype(np.float32))
    share = []
    for crown in (volume, uneven):
        made = grow_twigs(skeleton, crown, mattes[:1], cameras[:1], leafy=False)
        share.append((made.points[bases(made)[2], 2] > 0).mean())
    assert share[1] > share[0] + 0.03, share


def test_equal_seeds_give_equal_bytes_and_others_do_not():
    one, same, other = (grow_twigs(*CROWN.inputs, seed=s) for s in (3, 3, 4))
    for name in FIELDS:
        assert getattr(one, name).tobytes() == getattr(same, name).tobytes()
    assert len(other.points) != len(one.points) or not np.array_equal(other.points, one.points)


def test_where_nothing_can_grow_nothing_does():
    empty = [replace(m, alpha=np.zeros_like(m.alpha)) for m in CROWN.mattes]
    speck = DensityVolume(np.float32([[[1.0]]]), np.float32([0, 0, 0]), HEIGHT)
    stem = lone_branch((1, 0, 0), nodes=1)
    for leafy in (True, False):
        assert not grow_twigs(CROWN.skeleton, CROWN.volume, empty, CROWN.cameras, leafy=leafy).twig.any()
        check_grown(
            grow_twigs(CROWN.skeleton, speck, CROWN.mattes, CROWN.cameras, leafy=leafy), CROWN.skeleton
        )
        check_grown(grow_twigs(*CROWN.with_skeleton(stem).inputs, leafy=leafy), stem)
        nowhere = ball_volume(density=0.0)
        assert grow_twigs(CROWN.skeleton, nowhere, CROWN.mattes, CROWN.cameras, leafy=leafy) is CROWN.skeleton


def test_segments_without_length_bear_nothing_and_break_nothing():
    points = CROWN.skeleton.points.copy()
    thin = np.flatnonzero(CROWN.skeleton.particles == 1)[::3]
    points[thin] = points[CROWN.skeleton.parent[thin]]
    flat = replace(CROWN.skeleton, points=points)
    check_grown(grow_twigs(*CROWN.with_skeleton(flat).inputs), flat)


@pytest.mark.parametrize("leafy", [True, False])
def test_a_canvas_shows_the_wood_as_it_is_rendered(leafy):
    made = grow_twigs(*CROWN.inputs, leafy=leafy, seed=3)
    camera = CROWN.cameras[0]
    bark = Material(name="bark", base_color=np.zeros((2, 2, 3), np.uint8))
    tree = TreeModel("", HEIGHT, made, sweep_rings(made), bark, None)
    seen = lay_canvas(render_mask(tree, camera, samples=6), None, camera, cell=HEIGHT / CELLS).wanted
    canvas = lay_canvas(
        np.zeros((camera.height, camera.width), np.float32), None, camera, cell=HEIGHT / CELLS
    )
    shown = canvas.with_tree(made.parent, made.points, made.radius).shown()
    assert shown.sum() == pytest.approx(seen.sum(), rel=0.04)
    assert np.abs(shown - seen).sum() < 0.1 * seen.sum()
