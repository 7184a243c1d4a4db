import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.footprint_means import OPAQUE, footprint_means, optical_depth
from flowtree.model.camera import Camera


def _by_area(picture, camera, left, bottom, cell, columns, rows):
    """Every pixel's share of every cell, one after the other."""
    scale, (fx, fy) = camera.metres_per_pixel, camera.foot
    sums = np.zeros((columns, rows))
    for c in range(columns):
        for r in range(rows):
            x0, x1 = fx + (left + c * cell) / scale, fx + (left + (c + 1) * cell) / scale
            y0, y1 = fy - (bottom + (r + 1) * cell) / scale, fy - (bottom + r * cell) / scale
            for i in range(picture.shape[0]):
                for j in range(picture.shape[1]):
                    wide = max(0.0, min(x1, j + 1) - max(x0, j))
                    high = max(0.0, min(y1, i + 1) - max(y0, i))
                    sums[c, r] += wide * high * picture[i, j]
    return sums / (cell / scale) ** 2


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    shape=st.tuples(st.integers(1, 7), st.integers(1, 7)),
    cell=st.floats(0.03, 0.5),
    left=st.floats(-1, 0.5),
    bottom=st.floats(-0.5, 0.5),
)
def test_means_are_exact(seed, shape, cell, left, bottom):
    rng = np.random.default_rng(seed)
    picture = rng.random(shape).astype(np.float32)
    camera = Camera(0.0, 0.1, (float(rng.uniform(-1, 8)), float(rng.uniform(-1, 8))), shape[1], shape[0])
    grid = {"left": left, "bottom": bottom, "cell": cell, "columns": 4, "rows": 3}
    assert np.allclose(footprint_means(picture, camera, **grid), _by_area(picture, camera, **grid), atol=1e-9)


def test_the_integral_is_kept_whatever_the_grid():
    picture = np.random.default_rng(0).random((20, 30)).astype(np.float32)
    camera = Camera(0.0, 0.1, (15.0, 20.0), 30, 20)
    for cell in (0.07, 0.1, 0.23, 1.9):
        count = int(np.ceil(6 / cell)) + 1
        means = footprint_means(picture, camera, left=-3, bottom=-0.5, cell=cell, columns=count, rows=count)
        assert np.isclose(means.sum() * cell**2, picture.sum(dtype=float) * 0.01)


@settings(max_examples=25, deadline=None)
@given(alpha=st.floats(0, 1))
def test_depth_is_what_the_alpha_means_until_it_is_opaque(alpha):
    depth = optical_depth(np.array([alpha]))[0]
    assert np.isfinite(depth)
    assert np.isclose(1 - np.exp(-depth), min(alpha, OPAQUE))
