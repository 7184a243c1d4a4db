import math

import numpy as np
import pytest

from flowtree.density.fit_sights import fit_sights
from flowtree.density.project_density import project_density
from flowtree.density.solve_density import solve_density
from flowtree.geometry.projection import Viewpoint, growth, to_plane
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.render.soft_iou import soft_iou

SIDE, ROWS, CELL = 32, 32, 1 / 32
COLUMNS, TALL = 50, 44
LEFT = -COLUMNS / 2 * CELL
BALLS = np.array(
    [[0.2, 0.6, 0.15, 0.15], [-0.2, 0.75, -0.2, 0.12], [0.1, 0.4, -0.25, 0.1]]
)  # x, y, z, radius


def seen(sight, rng, count=400_000):
    """Depth (columns, rows) of the balls, each of depth 1 a metre, by points that the eye sees."""
    points, weight = [], []
    for x, y, z, radius in BALLS:
        ball = rng.uniform(-1, 1, (count, 3))
        ball = ball[np.linalg.norm(ball, axis=1) < 1]
        points.append(radius * ball + [x, y, z])
        weight.append(np.full(len(ball), 4 / 3 * np.pi * radius**3 / len(ball)))
    place, weight = (
        np.concatenate(points),
        np.concatenate(weight) * growth(np.concatenate(points), sight) ** 2,
    )
    column, row = (np.floor((to_plane(place, sight) - [LEFT, 0]) / CELL).astype(int)).T
    depth = np.bincount(column * TALL + row, weight, COLUMNS * TALL) / CELL**2
    return depth.reshape(COLUMNS, TALL)


def truth():
    centre = (np.stack(np.meshgrid(*[np.arange(SIDE)] * 3, indexing="ij"), axis=-1) + 0.5) * CELL - [
        0.5,
        0,
        0.5,
    ]
    return np.any([np.linalg.norm(centre - b[:3], axis=-1) < b[3] for b in BALLS], axis=0).astype(float)


def fitted(sights, depths, known=None):
    known = [np.ones_like(d, bool) for d in depths] if known is None else known
    start = np.full((SIDE, ROWS, SIDE), 0.1, np.float32)
    return (
        fit_sights(depths, known, sights, start=start, left=LEFT, cell=CELL, least=1e-4, device="cpu") / CELL
    )


def overlap(a, b):
    return np.minimum(a, b).sum() / np.maximum(a, b).sum()


def test_eyes_near_the_tree_find_what_parallel_rays_put_elsewhere():
    rng = np.random.default_rng(0)
    sights = [Viewpoint(yaw, distance=1.6, eye=0.15) for yaw in (0.0, 60.0, 120.0, 180.0)]
    depths = [seen(sight, rng) for sight in sights]
    near = overlap(fitted(sights, depths), truth())
    far = overlap(fitted([Viewpoint(sight.yaw) for sight in sights], depths), truth())
    assert near > 0.5
    assert near > 1.25 * far


def test_a_far_eye_sees_as_parallel_rays_do():
    rng = np.random.default_rng(1)
    depths = [seen(Viewpoint(yaw), rng) for yaw in (0.0, 90.0)]
    parallel = fitted([Viewpoint(yaw) for yaw in (0.0, 90.0)], depths)
    far = fitted([Viewpoint(yaw, distance=1e5, eye=0.2) for yaw in (0.0, 90.0)], depths)
    assert np.allclose(parallel, far, atol=1e-3 * parallel.max())


def test_what_no_view_knows_keeps_to_the_start():
    rng = np.random.default_rng(2)
    sights = [Viewpoint(yaw, distance=1.6, eye=0.15) for yaw in (0.0, 90.0)]
    nothing = [np.zeros((COLUMNS, TALL), bool)] * 2
    kept = fitted(sights, [seen(sight, rng) for sight in sights], nothing) * CELL
    assert np.array_equal(kept, np.full_like(kept, 0.1))


@pytest.mark.parametrize("distance", [math.inf, 1.6])
def test_the_volume_looks_from_its_cameras_as_their_mattes(distance):
    rng = np.random.default_rng(3)
    pixel = CELL / 2
    cameras = [Camera(yaw, pixel, (60.0, 80.0), 120, 84, distance, 0.15) for yaw in (0.0, 90.0)]
    mattes = []
    for camera in cameras:
        depth = 4 * seen(camera, rng)
        alpha = np.zeros((84, 120), np.float32)
        grown = np.repeat(np.repeat(1 - np.exp(-depth), 2, axis=0), 2, axis=1).T[::-1]
        alpha[:80, 10:110] = grown[-80:]
        mattes.append(Matte(alpha, np.zeros((84, 120, 3), np.uint8), "alpha channel"))
    volume = solve_density(mattes, cameras, height=1.0)
    for matte, camera in zip(mattes, cameras, strict=True):
        assert soft_iou(project_density(volume, camera), camera, matte.alpha, camera, height=1.0) > 0.9
