from __future__ import annotations

import numpy as np

from flowtree.render.resample_picture import resample_picture


def test_a_slope_is_met_between_centres_and_ends_go_on():
    y, x = np.meshgrid(np.arange(4.0), np.arange(6.0), indexing="ij")
    picture = (10 * y + x).astype(np.float32)
    down, across = np.array([-2.0, 0.0, 1.25, 9.0]), np.array([-1.0, 2.5, 5.0, 5.5])
    wanted = 10 * np.clip(down, 0, 3)[:, None] + np.clip(across, 0, 5)[None, :]
    assert np.allclose(resample_picture(picture, down, across), wanted, atol=1e-5)
    both = resample_picture(np.stack([picture, -picture], axis=2), down, across)
    assert np.allclose(both, np.stack([wanted, -wanted], axis=2), atol=1e-5)
