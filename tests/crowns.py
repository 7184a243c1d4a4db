"""A small tree with everything known: what tests of twigs and leaves start from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.geometry.parent_array import child_count, parents_first, sum_to_root
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.model.volume import DensityVolume

HEIGHT = 8.0  # [m]
CENTRE, RADIUS = 5.2, 2.4  # of the crown, a ball [m]
TRUNK = 0.06  # radius [m]
PIXEL = 0.05  # [m]
LEAF_GREEN, BARK_BROWN = (70, 120, 40), (96, 74, 52)


@dataclass(frozen=True)
class Crown:
    """What `grow_twigs` and `place_leaves` take."""

    skeleton: Skeleton
    volume: DensityVolume
    mattes: list[Matte]
    cameras: list[Camera]

    @property
    def inputs(self) -> tuple[Skeleton, DensityVolume, list[Matte], list[Camera]]:
        return self.skeleton, self.volume, self.mattes, self.cameras

    def with_skeleton(self, skeleton: Skeleton) -> Crown:
        return replace(self, skeleton=skeleton)


def ball_crown(alpha: float = 0.7, *, branches: int = 30, seed: int = 0) -> Crown:
    """A ball of even alpha on a stem, seen from two sides, with branches that reach all through it."""
    cameras = [camera_at(yaw) for yaw in (0.0, 90.0)]
    return Crown(
        branch_out(branches, seed), ball_volume(), [ball_matte(camera, alpha) for camera in cameras], cameras
    )


def camera_at(yaw: float) -> Camera:
    return Camera(yaw, PIXEL, (64.0, 168.0), 128, 176)


def plane_of(camera: Camera) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Image-right and up [m] of every pixel's centre: two of (h, w)."""
    rows, columns = np.mgrid[: camera.height, : camera.width] + 0.5
    return (columns - camera.foot[0]) * PIXEL, (camera.foot[1] - rows) * PIXEL


def ball_matte(camera: Camera, alpha: float) -> Matte:
    right, up = plane_of(camera)
    crown = np.hypot(right, up - CENTRE) < RADIUS
    stem = (np.abs(right) < TRUNK) & (up > 0) & (up < CENTRE)
    picture = np.where(crown, alpha, 0.0)
    picture[stem & ~crown] = 1.0
    color = np.where(crown[..., None], LEAF_GREEN, BARK_BROWN).astype(np.uint8)
    return Matte(picture.astype(np.float32), color, "trimap")


def ball_volume(density: float = 0.4, cells: int = 32) -> DensityVolume:
    voxel = HEIGHT / cells
    origin = np.float32([-cells / 2 * voxel, 0, -cells / 2 * voxel])
    place = origin + (np.stack(np.mgrid[:cells, :cells, :cells], axis=-1) + 0.5) * voxel
    inside = np.linalg.norm(place - [0, CENTRE, 0], axis=-1) < RADIUS
    return DensityVolume(np.where(inside, density, 0.0).astype(np.float32), origin, voxel)


def branch_out(branches: int = 30, seed: int = 0) -> Skeleton:
    """A trunk up into the crown's middle, and branches with side branches from it to the crown's edge."""
    rng = np.random.default_rng(seed)
    parent, points = list(range(-1, 23)), [[0.0, 0.24 * k, 0.0] for k in range(24)]

    def grow(fork: int, end: NDArray[np.float64], nodes: int) -> int:
        begin, at = np.array(points[fork]), fork
        for share in np.arange(1, nodes + 1) / nodes:
            parent.append(at)
            points.append((begin + share * (end - begin)).tolist())
            at = len(points) - 1
        return at - nodes // 2

    for _ in range(branches):
        out = rng.normal(size=3)
        end = np.array([0, CENTRE, 0]) + 0.9 * RADIUS * out / np.linalg.norm(out)
        fork = int(rng.integers(11, 22)) if end[1] > 3.4 else 11
        middle = grow(fork, end, 12)
        grow(middle, 0.5 * (end + points[middle]) + rng.normal(0, 0.35, 3), 6)
    order, array = parents_first(np.array(parent))
    particles = sum_to_root(array, (child_count(array) == 0).astype(np.int32))
    bare = Skeleton(
        parent=array,
        points=np.array(points, np.float32)[order],
        radius=np.zeros(len(array), np.float32),
        particles=particles,
        level=np.zeros(len(array), np.int32),
        twig=np.zeros(len(array), np.bool_),
    )
    return da_vinci_radii(bare, trunk_radius=TRUNK)


def lone_branch(along: tuple[float, float, float], *, nodes: int = 20, length: float = 4.0) -> Skeleton:
    """A stem to the crown's middle that is too thick for twigs, and one straight, thin branch from there."""
    step = np.array(along) / np.linalg.norm(along) * length / nodes
    start = np.array([0, CENTRE, 0]) - step * nodes / 2
    points = np.array([[0, 0, 0], start, *(start + step * (k + 1) for k in range(nodes))])
    return Skeleton(
        parent=np.arange(-1, nodes + 1, dtype=np.int32),
        points=points.astype(np.float32),
        radius=np.array([TRUNK, TRUNK, *np.linspace(0.03, 0.01, nodes)], np.float32),
        particles=np.array([1000, 1000, *[1] * nodes], np.int32),
        level=np.zeros(nodes + 2, np.int32),
        twig=np.zeros(nodes + 2, np.bool_),
    )
