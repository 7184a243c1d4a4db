from __future__ import annotations

import numpy as np

from flowtree.render.dilate_colors import dilate_colors


def test_dilated_colours_go_on_outside_and_stay_inside():
    values = np.zeros((9, 13, 2), np.float32)
    weight = np.zeros((9, 13), np.float32)
    weight[2:5, 3:6] = 1.0
    values[2:5, 3:6] = (0.25, 0.75)
    filled = dilate_colors(values, weight)
    assert np.allclose(filled, (0.25, 0.75), atol=1e-6)
    assert np.array_equal(dilate_colors(values, np.zeros_like(weight)), values)
