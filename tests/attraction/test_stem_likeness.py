import numpy as np

from flowtree.attraction.cut_working_grid import cut_working_grid
from flowtree.attraction.outline_crown import outline_crown
from flowtree.attraction.stem_likeness import stem_likeness
from tests.attraction.scenes import LEVEL, level_limbs


def middle_of(limb, corner=(0.0, 0.0), scale=1.0):
    """(row, column) of places along a limb, away from the stem."""
    share = np.linspace(0.25, 0.85, 20)[:, None]
    line = np.array(limb[0]) * (1 - share) + np.array(limb[1]) * share
    return tuple(np.floor((line - corner) * scale).astype(int)[:, ::-1].T)


def test_a_limb_thinner_than_a_cell_has_the_stems_colour_before_a_bright_sky():
    photo, matte, camera = level_limbs(leaves=True)
    grid = cut_working_grid(photo, matte, [camera.foot], 100)
    likeness = stem_likeness(grid, outline_crown(grid, grid.alpha.shape[0] - 5))
    for limb in LEVEL[:2]:
        assert np.median(likeness[middle_of(limb, grid.corner, grid.scale)]) > 0.8
    for limb in LEVEL[-2:]:
        assert np.median(likeness[middle_of(limb, grid.corner, grid.scale)]) < 0.2


def test_the_grids_colours_are_the_trees_and_not_the_skys():
    photo, matte, camera = level_limbs(leaves=True)
    fine = cut_working_grid(photo, matte, [camera.foot], 480)
    coarse = cut_working_grid(photo, matte, [camera.foot], 60)
    for limb in LEVEL:
        colors = [
            np.median(grid.lab[middle_of(limb, grid.corner, grid.scale)], axis=0) for grid in (fine, coarse)
        ]
        assert np.linalg.norm(colors[0] - colors[1]) < 8.0
