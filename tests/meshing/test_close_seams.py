import numpy as np

from flowtree.geometry.closed_surfaces import is_watertight
from flowtree.meshing.close_seams import close_seams
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.mesh import TreeMesh
from tests.skeletons import random_skeleton


def tetrahedron(shift=0.0):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32) + np.float32(shift)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    return corners, faces


def mesh_of(positions, triangles):
    n = len(positions)
    return TreeMesh(
        positions=np.asarray(positions, np.float32),
        normals=np.tile(np.float32([0, 1, 0]), (n, 1)),
        uvs=np.zeros((n, 2), np.float32),
        triangles=np.asarray(triangles, np.int32),
    )


def test_twins_become_one_vertex():
    corners, faces = tetrahedron()
    split = np.where(faces == 3, np.array([[3], [3], [4], [3]]), faces)
    positions, triangles = close_seams(mesh_of([*corners, corners[3]], split))
    assert len(positions) == 4
    assert is_watertight(triangles)
    assert not is_watertight(np.asarray(split, np.int32))


def test_coincident_pieces_stay_apart():
    corners, faces = tetrahedron()
    positions, triangles = close_seams(mesh_of([*corners, *corners], [*faces, *(faces + 4)]))
    assert len(positions) == 8
    assert is_watertight(triangles)


def test_the_surface_itself_does_not_change():
    mesh = sweep_rings(random_skeleton(2, 80))
    positions, triangles = close_seams(mesh)
    assert np.array_equal(positions[triangles], mesh.positions[mesh.triangles])


def test_what_is_closed_is_left_as_it_is():
    corners, _ = tetrahedron()
    folded = np.array([*corners, corners[3] + np.float32(1)], np.float32)
    folded[0] = folded[4]  # two vertices of one piece in one place, neither on a slit
    split = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 4, 2], [0, 3, 4], [2, 4, 3]])
    positions, triangles = close_seams(mesh_of(folded, split))
    assert is_watertight(split.astype(np.int32))
    assert len(positions) == 5
    assert is_watertight(triangles)
