import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.connect_ramifications import connect_ramifications
from flowtree.meshing.unwrap_quads import unwrap_quads
from flowtree.model.mesh import QuadMesh
from flowtree.params import MeshingParams
from tests.meshing.test_sweep_rings import texel_sizes
from tests.skeletons import random_skeleton


@given(st.integers(0, 10_000), st.floats(0.1, 1.0))
@settings(max_examples=15, deadline=None)
def test_triangles_are_the_quads_cut_in_two(seed, stubborn):
    quads = connect_ramifications(
        random_skeleton(seed, 40, stubborn=stubborn), params=MeshingParams(subdivisions=1)
    )
    mesh = unwrap_quads(quads)
    assert len(mesh.triangles) == 2 * len(quads.quads)
    positions, triangles = close_seams(mesh)
    assert is_watertight(triangles)
    assert len(positions) == len(quads.positions)
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-5)
    assert np.allclose(np.linalg.norm(mesh.tangents[:, :3], axis=1), 1.0, atol=1e-5)
    assert np.abs(np.sum(mesh.tangents[:, :3] * mesh.normals, axis=1)).max() < 1e-4
    corners = mesh.positions[mesh.triangles].astype(float)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    agrees = np.sum(facing * mesh.normals[mesh.triangles].sum(axis=1), axis=1) > 0.0
    size = np.linalg.norm(facing, axis=1)
    assert size[agrees].sum() > 0.97 * size.sum()


def test_tangents_point_to_growing_u_and_bitangents_up_the_texture():
    mesh = unwrap_quads(connect_ramifications(random_skeleton(2, 300, stubborn=0.6)))
    corners, uvs = mesh.positions[mesh.triangles].astype(float), mesh.uvs[mesh.triangles].astype(float)
    (e, f), (g, h) = (corners[:, k] - corners[:, 0] for k in (1, 2)), (uvs[:, k] - uvs[:, 0] for k in (1, 2))
    turn = np.sign(g[:, 0] * h[:, 1] - g[:, 1] * h[:, 0])[:, None]
    along_u = (h[:, 1, None] * e - g[:, 1, None] * f) * turn
    up_texture = -(g[:, 0, None] * f - h[:, 0, None] * e) * turn
    area = np.linalg.norm(np.cross(e, f), axis=1)
    tangent = mesh.tangents[mesh.triangles][..., :3].sum(axis=1)
    bitangent = np.cross(mesh.normals[mesh.triangles].sum(axis=1), tangent)
    assert area[np.sum(along_u * tangent, axis=1) > 0.0].sum() > 0.97 * area.sum()
    assert area[np.sum(up_texture * bitangent, axis=1) > 0.0].sum() > 0.97 * area.sum()
    assert (mesh.tangents[:, 3] == 1.0).all()


def test_the_bark_is_not_stretched_even_at_forks():
    skeleton = random_skeleton(4, 400, height=15.0, stubborn=0.6)
    mesh = unwrap_quads(connect_ramifications(skeleton))
    area, least, most, _ = texel_sizes(mesh)
    order = np.argsort(most / np.maximum(least, 1e-12))
    share = np.cumsum(area[order]) / area.sum()
    ratio = (most / np.maximum(least, 1e-12))[order]
    assert ratio[np.searchsorted(share, 0.5)] < 1.25
    assert ratio[np.searchsorted(share, 0.9)] < 1.8


def test_quads_that_share_a_diagonal_are_cut_along_the_others():
    # A lens of two times two quads: the two at vertex 4 share corners 0 and 2, near each other.
    points = np.array(
        [[0, 0, 0], [1, 2, 0], [0.2, 0, 0.1], [1, -2, 0], [0.1, 0, 0.5], [0.1, 0.1, -1.0]], np.float32
    )
    quads = np.array([[0, 1, 2, 4], [0, 4, 2, 3], [0, 3, 2, 5], [0, 5, 2, 1]], np.int32)
    mesh = QuadMesh(points, quads, np.ones(6, np.int32), np.zeros((4, 4, 2), np.float32))
    assert is_watertight(close_seams(unwrap_quads(mesh))[1])
