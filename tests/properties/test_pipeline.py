"""Random mattes, volumes and parameters through the stages: a sound result or an input error."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.attraction.bend_direction_field import bend_direction_field
from flowtree.attraction.build_direction_field import build_direction_field
from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.branches.build_skeleton import build_skeleton
from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.configuration import override_params
from flowtree.density.solve_density import solve_density
from flowtree.errors import InputError
from flowtree.flow.trace_particles import trace_particles
from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.matting.extract_matte import extract_matte
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.edit import PaintedEdit
from flowtree.model.field import DirectionField
from flowtree.model.photo import Photo
from flowtree.model.volume import DensityVolume
from flowtree.params import Params
from flowtree.photos.frame_view import frame_view
from flowtree.pipeline.reconstruct import reconstruct

_COUNT, _SEED_POINTS = st.integers(1, 60), st.integers(0, 8)


@st.composite
def pictures(draw):
    """A random alpha (h, w): blobs, lines, noise, and the odd speck, with random colours."""
    height, width = draw(st.integers(24, 64)), draw(st.integers(20, 64))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    alpha = np.zeros((height, width), np.float32)
    rows, columns = np.mgrid[0:height, 0:width]
    for _ in range(draw(st.integers(0, 6))):
        y, x, size = rng.uniform(0, height), rng.uniform(0, width), rng.uniform(2, height / 2)
        alpha[np.hypot(rows - y, columns - x) < size] = rng.uniform(0.2, 1.0)
    if draw(st.integers(0, 4)):  # most have a trunk
        middle = rng.integers(2, width - 2)
        alpha[height // 3 :, middle - 1 : middle + 2] = 1.0
    if draw(st.booleans()):
        alpha *= rng.random(alpha.shape) < 0.7
    rgb = rng.integers(0, 256, (height, width, 3), dtype=np.uint8)
    return Photo("random.png", rgb, alpha)


@st.composite
def parameters(draw):
    """Parameters far from their defaults, and small."""
    return override_params(
        Params(),
        [
            f"density.resolution={draw(st.integers(4, 24))}",
            f"density.carve={draw(st.floats(0, 0.4))}",
            f"flow.particle_count={draw(_COUNT)}",
            f"flow.step={draw(st.floats(0.004, 0.05))}",
            f"flow.attraction={draw(st.floats(0, 4))}",
            f"attraction.grid_height={draw(st.integers(32, 64))}",
            f"attraction.seed_count={draw(_SEED_POINTS)}",
            f"attraction.seed_mode={draw(st.sampled_from(['farthest', 'random']))}",
            f"field.resolution={draw(st.integers(4, 40))}",
            f"field.blending={draw(st.sampled_from(['linear', 'constant']))}",
            f"branches.smoothing={draw(st.integers(0, 8))}",
            f"meshing.sides={draw(st.sampled_from([3, 4, 8]))}",
        ],
    )


def _assert_tree(parent):
    """One root, and every node's way leads there."""
    assert parent[0] == -1
    assert (parent[1:] >= 0).all()
    assert (parent[1:] < np.arange(1, len(parent))).all()


@settings(max_examples=12, deadline=None)
@given(front=pictures(), side=pictures(), params=parameters(), seed=st.integers(0, 1000))
def test_any_two_pictures_make_a_sound_tree_or_an_input_error(front, side, params, seed):
    try:
        made = reconstruct([front, side], height=7.0, params=params, seed=seed)
    except InputError:
        return
    assert made.volume.density.min() >= 0
    assert np.isfinite(made.volume.density).all()
    _assert_tree(made.traces.parent)
    _assert_tree(made.skeleton.parent)
    assert made.traces.particles[0] == made.traces.particles.max()
    assert np.isfinite(made.skeleton.points).all()
    assert (made.skeleton.radius > 0).all()
    assert (made.skeleton.radius[1:] <= made.skeleton.radius[made.skeleton.parent[1:]] * 1.0001).all()
    assert is_watertight(close_seams(made.tree.wood)[1])
    assert np.isfinite(made.tree.wood.positions).all()
    if made.tree.foliage is not None:
        assert np.isfinite(made.tree.foliage.position).all()
        assert (made.tree.foliage.scale > 0).all()
    assert all(0.0 <= view["soft_iou"] <= 1.0 for view in made.report["views"])


@settings(max_examples=12, deadline=None)
@given(
    sides=st.tuples(st.integers(1, 7), st.integers(2, 9), st.integers(1, 7)),
    filled=st.floats(0.02, 1.0),
    count=_COUNT,
    yaws=st.sampled_from([(0.0, 90.0), (10.0, 55.0, 100.0), (0.0, 60.0)]),
    seed=st.integers(0, 2**31),
)
def test_every_particle_reaches_the_root_of_any_volume(sides, filled, count, yaws, seed):
    rng = np.random.default_rng(seed)
    density = (rng.random(sides) * (rng.random(sides) < filled)).astype(np.float32)
    density.flat[int(rng.integers(density.size))] = 1.0
    voxel = 0.7
    origin = np.array([-sides[0] / 2, 0.0, -sides[2] / 2], np.float32) * voxel
    reach = np.float32(max(sides) * voxel)
    fields = [
        DirectionField(
            vectors=(rng.normal(size=(6, 6, 2)) * 0.5).clip(-0.7, 0.7).astype(np.float32),
            origin=np.array([-reach, 0.0], np.float32),
            cell=np.array([2 * reach / 6, reach / 6], np.float32),
            yaw=yaw,
        )
        for yaw in yaws
    ]
    params = override_params(Params(), [f"flow.particle_count={count}"])
    traces = trace_particles(
        DensityVolume(density, origin, voxel), fields, params=params.flow, seed=seed % 97
    )
    _assert_tree(traces.parent)
    assert np.isfinite(traces.points).all()
    assert np.allclose(traces.points[0], 0.0)
    assert (traces.particles[traces.parent[1:]] >= traces.particles[1:]).all()
    skeleton = da_vinci_radii(build_skeleton(traces, params=params.branches), params=params.thickness)
    _assert_tree(skeleton.parent)
    assert is_watertight(close_seams(sweep_rings(skeleton, params=params.meshing))[1])


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
def test_a_volume_with_nan_is_an_input_error(value):
    density = np.ones((4, 6, 4), np.float32)
    density[1, 2, 3] = value
    volume = DensityVolume(density, np.array([-1.0, 0.0, -1.0], np.float32), 0.5)
    field = DirectionField(
        np.zeros((4, 4, 2), np.float32), np.zeros(2, np.float32), np.ones(2, np.float32), 0.0
    )
    with pytest.raises(InputError):
        trace_particles(volume, [field])


@settings(max_examples=10, deadline=None)
@given(picture=pictures(), params=parameters(), seed=st.integers(0, 99), turn=st.floats(-180, 180))
def test_any_matte_has_a_graph_and_a_field_or_an_input_error(picture, params, seed, turn):
    try:
        matte = extract_matte(picture, params=params.matting)
        camera = frame_view(matte, yaw=turn, height=7.0)
        graph = trace_attractor_graph(picture, matte, camera, params=params.attraction, seed=seed)
    except InputError:
        return
    _assert_tree(graph.parent)
    assert np.allclose(graph.points[0], 0.0)
    field = build_direction_field(graph, camera, params=params.field)
    way = np.array([[5.0, 5.0], [9.0, 15.0]], np.float32)
    for directions in (
        field,
        bend_direction_field(field, camera, PaintedEdit(directions=(way,), reach=(6.0,))),
    ):
        assert np.isfinite(directions.vectors).all()
        assert (np.linalg.norm(directions.vectors, axis=2) <= 1.0 + 1e-5).all()
    volume = solve_density([matte, matte], [camera, frame_view(matte, yaw=turn + 90, height=7.0)])
    assert np.isfinite(volume.density).all()
    assert volume.density.min() >= 0.0
