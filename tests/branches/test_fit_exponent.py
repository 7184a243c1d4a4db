from dataclasses import replace

import numpy as np
import pytest

from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.branches.fit_exponent import fit_exponent
from flowtree.errors import InputError
from flowtree.geometry.plane_grid import PlaneGrid
from flowtree.geometry.segment_depth import rods_depth
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.params import ThicknessParams
from tests.crowns import ball_crown

CROWN = ball_crown(branches=60)
CELL = float(np.ptp(CROWN.skeleton.points[:, 1])) / 64  # of the grid that is compared: a pixel each
CAMERAS = [Camera(yaw, CELL, (40.0, 70.0), 80, 72) for yaw in (0.0, 90.0)]


def silhouettes(exponent):
    """Mattes of the branches with that exponent, and of as much besides as a bare tree has in twigs."""
    wood = da_vinci_radii(CROWN.skeleton, trunk_radius=0.12, params=ThicknessParams(exponent=exponent))
    mattes = []
    for camera in CAMERAS:
        grid = PlaneGrid(camera.yaw, -40 * CELL, -2 * CELL, CELL, 80, 72)
        depth = rods_depth(grid, wood.parent, wood.points, wood.radius) / 0.65
        alpha = -np.expm1(-depth.reshape(80, 72).T[::-1])
        mattes.append(Matte(alpha.astype(np.float32), np.zeros((72, 80, 3), np.uint8), "trimap"))
    return mattes


@pytest.mark.parametrize("exponent", [2.1, 2.3, 2.5])
def test_a_known_exponent_is_found_again(exponent):
    found = fit_exponent(CROWN.skeleton, silhouettes(exponent), CAMERAS, trunk_radius=0.12)
    # A little less: where limbs cross, a matte shows no more than that it is opaque.
    assert exponent - 0.08 < found < exponent + 0.02


def test_it_stays_within_its_bounds_whatever_the_mattes():
    for alpha, bound in ((0.0, 2.0), (1.0, 2.7)):
        mattes = [replace(m, alpha=np.full_like(m.alpha, alpha)) for m in CROWN.mattes]
        found = fit_exponent(CROWN.skeleton, mattes, CROWN.cameras, trunk_radius=0.12)
        assert found == pytest.approx(bound, abs=0.01)


def test_a_flat_skeleton_is_an_error():
    flat = replace(CROWN.skeleton, points=CROWN.skeleton.points * np.float32([1, 0, 1]))
    with pytest.raises(InputError, match="must rise"):
        fit_exponent(flat, CROWN.mattes, CROWN.cameras)
