import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.density.footprint_matrix import footprint_matrix
from flowtree.geometry.projection import view_axes

YAWS = st.one_of(st.sampled_from([0.0, 45.0, 90.0, 180.0, 270.0, -90.0]), st.floats(-360, 360))


@settings(max_examples=25, deadline=None)
@given(yaw=YAWS, nx=st.integers(1, 7), nz=st.integers(1, 7), cell=st.floats(0.01, 3.0))
def test_a_voxel_is_seen_whole_and_a_ray_is_as_long_as_the_slice_is_deep(yaw, nx, nz, cell):
    x, z = (np.arange(nx) + 0.3) * cell, (np.arange(nz) - 1.7) * cell
    matrix = footprint_matrix(x, z, yaw, left=-30 * cell, cell=cell, columns=60).toarray()
    assert matrix.shape == (60, nx * nz)
    assert (matrix >= 0).all()
    assert np.allclose(matrix.sum(axis=0), cell)
    # No path through one voxel is longer than its diagonal, none through all longer than theirs.
    assert matrix.max() <= np.sqrt(2) * cell * (1 + 1e-9)
    assert matrix.sum(axis=1).max() <= np.hypot(nx, nz) * cell * (1 + 1e-9)
    assert ((matrix > 0).sum(axis=0) <= 3).all()


@pytest.mark.parametrize("yaw", [0.0, 90.0, 13.0, 45.0, 77.7, 121.0, 200.3, -33.0])
def test_equals_the_area_counted_in_small_pieces(yaw):
    cell, fine = 0.5, 200
    x, z = np.array([-0.4, 0.1, 0.6]), np.array([0.05, 0.55])
    left, columns = -2.03, 9
    matrix = footprint_matrix(x, z, yaw, left=left, cell=cell, columns=columns).toarray()
    right, _, _ = view_axes(yaw)
    piece = ((np.arange(fine) + 0.5) / fine - 0.5) * cell
    px, pz = (a.ravel() for a in np.meshgrid(piece, piece, indexing="ij"))
    for k, (cx, cz) in enumerate((a, b) for a in x for b in z):
        column = np.floor(((cx + px) * right[0] + (cz + pz) * right[2] - left) / cell).astype(int)
        share = np.bincount(column[(column >= 0) & (column < columns)], minlength=columns) / fine**2
        assert np.allclose(matrix[:, k], share * cell, atol=2.5 * cell / fine)


def test_opposite_views_are_mirror_images():
    x = z = (np.arange(6) - 2.5) * 0.2
    front, back = (
        footprint_matrix(x, z, yaw, left=-1.0, cell=0.2, columns=10).toarray() for yaw in (25.0, 205.0)
    )
    assert np.allclose(front, back[::-1], atol=1e-12)


def test_what_lies_outside_the_view_is_left_out():
    matrix = footprint_matrix(np.array([5.0]), np.array([0.0]), 0.0, left=-1.0, cell=0.5, columns=4)
    assert matrix.nnz == 0
