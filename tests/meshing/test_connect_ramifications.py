import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.connect_ramifications import connect_ramifications
from flowtree.meshing.unwrap_quads import unwrap_quads
from flowtree.params import MeshingParams
from tests.skeletons import random_skeleton, skeleton_of

skeletons = st.builds(
    random_skeleton,
    st.integers(0, 10_000),
    st.integers(2, 60),
    height=st.sampled_from([0.05, 2.0, 80.0]),
    stubborn=st.floats(0.0, 1.0),
    step_in_thickness=st.sampled_from([0.0, 0.5]),
    steep=st.booleans(),
)


def is_one_closed_surface(mesh):
    """Whether every edge is passed once in each direction, and Euler's characteristic is a sphere's."""
    quads, count = mesh.quads.astype(np.int64), len(mesh.positions)
    start, end = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    passed = np.sort(start * count + end)
    closed = np.array_equal(passed, np.sort(end * count + start)) and bool(np.all(np.diff(passed) > 0))
    corners = np.sort(quads, axis=1)
    whole = bool(np.all(np.diff(corners, axis=1) > 0)) and len(np.unique(quads)) == count
    # A vertex where two sheets touch would raise the count of vertices that a sphere needs.
    return closed and whole and count - len(passed) // 2 + len(quads) == 2


def furcation(children, angle=50.0, radius=None, seed=0):
    """A trunk with so many branches at one node, one of which goes on."""
    rng = np.random.default_rng(seed)
    parent, points, size = [-1, 0], [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]], [0.1, 0.1]
    for k in range(children):
        turn = 2.0 * np.pi * k / children + 0.1 * rng.normal()
        tilt = np.radians(angle if k else 5.0)
        out = np.array([np.sin(tilt) * np.cos(turn), np.cos(tilt), np.sin(tilt) * np.sin(turn)])
        thick = radius or 0.1 / np.sqrt(children)
        for step, at in enumerate((0.5, 1.0)):
            parent.append(1 if step == 0 else len(points) - 1)
            points.append((np.array(points[1]) + at * out).tolist())
            size.append(thick * (1.0 - 0.3 * step) * (1.01 if k == 0 else 1.0))
    skeleton = skeleton_of(np.array(parent), np.array(points), rng)
    return dataclasses.replace(skeleton, radius=np.array(size, np.float32))


@given(skeletons, st.sampled_from([0, 1, 2]), st.booleans())
@settings(max_examples=25, deadline=None)
def test_any_skeleton_becomes_one_closed_surface(skeleton, subdivisions, all_additional):
    mesh = connect_ramifications(
        skeleton, params=MeshingParams(subdivisions=subdivisions), all_additional=all_additional
    )
    assert is_one_closed_surface(mesh)
    assert np.isfinite(mesh.positions).all()
    assert np.isfinite(mesh.uvs).all()
    assert mesh.node.min() >= 1
    assert mesh.node.max() < len(skeleton.parent)
    triangles = unwrap_quads(mesh)
    assert is_watertight(close_seams(triangles)[1])


@pytest.mark.parametrize("children", range(2, 13))
def test_furcations_pasted_at_one_node_stay_closed(children):
    assert is_one_closed_surface(connect_ramifications(furcation(children), all_additional=True))
    assert is_one_closed_surface(connect_ramifications(furcation(children)))


def test_bad_skeletons_get_one_clear_line():
    skeleton = furcation(2)
    for broken, message in (
        (dataclasses.replace(skeleton, points=skeleton.points * np.nan), "points: must be finite"),
        (dataclasses.replace(skeleton, points=skeleton.points * 0), "needs a branch of some length"),
        (dataclasses.replace(skeleton, radius=-skeleton.radius), "radius: must be at least 0"),
    ):
        with pytest.raises(InputError, match=message):
            connect_ramifications(broken)
