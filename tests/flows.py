"""Volumes, fields and particles made by hand or by chance: what tests of the flow start from."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import warp as wp

from flowtree import device as devices
from flowtree.geometry.projection import view_axes
from flowtree.kernels.advance_particles import FlowForces, TimeGrid
from flowtree.kernels.cell_list import CellGrid
from flowtree.kernels.flow_fields import FlowFields
from flowtree.model.field import DirectionField
from flowtree.model.volume import DensityVolume

DEVICES = ["cpu", *(["cuda:0"] if wp.is_cuda_available() else [])]


def smooth_noise(rng, shape, waves=3):
    """Values of a few random waves: neighbours on the grid differ little."""
    grid = np.stack(np.meshgrid(*(np.linspace(0, 1, n) for n in shape), indexing="ij"), axis=-1)
    total = np.zeros(shape)
    for _ in range(waves):
        total += np.sin(grid @ rng.uniform(-4, 4, len(shape)) + rng.uniform(0, 6))
    return total / waves


def chance_fields(seed, yaws=(0.0, 90.0), size=9):
    """Smooth random fields over a tree of 2 m, and a random route: what the twins read."""
    rng = np.random.default_rng(seed)
    rights = np.array([view_axes(yaw)[0] for yaw in yaws])
    seen = sum(np.outer(right, right) + np.diag([0.0, 1.0, 0.0]) for right in rights)
    vectors = np.stack([smooth_noise(rng, (size, size + 2)) for _ in range(2 * len(yaws))])
    vectors = vectors.reshape(len(yaws), 2, size, size + 2).transpose(0, 2, 3, 1)
    vectors[..., 1] -= 0.7  # on the whole, down
    route = np.stack([smooth_noise(rng, (6, 7, 5)) for _ in range(3)], axis=-1)
    route /= np.linalg.norm(route, axis=-1, keepdims=True)
    return SimpleNamespace(
        vectors=vectors.astype(np.float32),
        corner=np.tile(np.float32([-1.1, -0.1]), (len(yaws), 1)),
        cell=np.tile(np.float32([0.2, 0.25]), (len(yaws), 1)),
        right=rights.astype(np.float32),
        combine=np.linalg.pinv(seen).astype(np.float32),
        route=route.astype(np.float32),
        route_corner=np.float32([-1.2, -0.1, -1.1]),
        route_spacing=0.4,
        pull=0.4,
        basin=0.1,
    )


def upload_fields(fields, device):
    """The same for the kernels."""
    out = FlowFields()
    for name, dtype in (("vectors", wp.vec2), ("corner", wp.vec2), ("cell", wp.vec2), ("right", wp.vec3)):
        setattr(out, name, devices.upload(getattr(fields, name), dtype, device))
    out.combine = wp.mat33(*fields.combine.ravel().tolist())
    out.route = devices.upload(fields.route, wp.vec3, device)
    out.route_corner = wp.vec3(*map(float, fields.route_corner))
    out.route_spacing, out.pull, out.basin = fields.route_spacing, fields.pull, fields.basin
    return out


def chance_times(seed):
    rng = np.random.default_rng(seed)
    values = (1.5 + smooth_noise(rng, (5, 6, 4))).astype(np.float32)
    return SimpleNamespace(time=values, corner=np.float32([-1.0, 0.0, -1.0]), spacing=0.5)


def upload_times(times, device):
    out = TimeGrid()
    out.time = devices.upload(times.time, float, device)
    out.corner, out.spacing = wp.vec3(*map(float, times.corner)), times.spacing
    return out


def forces(attraction=0.6, attraction_radius=0.3, response=0.05, inertia=0.15, pace=3.0):
    out = FlowForces()
    out.attraction, out.attraction_radius = attraction, attraction_radius
    out.response, out.inertia, out.pace = response, inertia, pace
    return out


def cell_grid(low=(-1.0, 0.0, -1.0), edge=0.3, cells=(7, 7, 7)):
    grid = CellGrid()
    grid.corner, grid.edge = wp.vec3(*low), edge
    grid.nx, grid.ny, grid.nz = cells
    return grid


def particles(seed, count, kind="even"):
    """Places, velocities, masses and states; a part waits or has gone over to another."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(-1.3, 1.3, (count, 3)) + np.array([0.0, 1.0, 0.0])
    if kind == "clustered":
        place = place[rng.integers(0, min(count, 3), count)] + rng.normal(0, 0.05, (count, 3))
    elif kind == "coincident":
        place[:] = place[0]
    elif kind == "collinear":
        place = np.linspace(-1, 1, count)[:, None] * [0.513, 0.487, 0.211] + np.array([0.0, 1.003, 0.0])
    return SimpleNamespace(
        position=place.astype(np.float32),
        velocity=rng.normal(0, 0.7, (count, 3)).astype(np.float32),
        mass=rng.integers(1, 40, count).astype(np.float32),
        state=rng.choice([0, 1, 1, 1, 1, 2, 3], count).astype(np.int32),
    )


def cone_volume(size=16, height=2.0):
    """A crown like a cone on a stem of one voxel, and its box."""
    voxel = height / size
    y = (np.arange(size) + 0.5) / size
    side = (np.arange(size) + 0.5 - size / 2) * voxel
    far = np.hypot(*np.meshgrid(side, side, indexing="ij"))[:, None, :]
    crown = (far < 0.7 * (1.05 - y[None, :, None])) & (y[None, :, None] > 0.3)
    density = np.where(crown | (far < voxel), 1.5, 0.0).astype(np.float32)
    return DensityVolume(density, np.float32([-height / 2, 0.0, -height / 2]), voxel)


def stem_field(yaw, height=2.0, size=20):
    """Toward the axis and down it."""
    across = (np.arange(size) + 0.5) / size * height - height / 2
    vectors = np.zeros((size, size, 2))
    vectors[..., 0] = -0.95 * np.clip(across / (0.08 * height), -1, 1)
    vectors[..., 1] = -np.sqrt(1.0 - vectors[..., 0] ** 2)
    cell = height / size
    return DirectionField(
        vectors.astype(np.float32), np.float32([-height / 2, 0.0]), np.float32([cell, cell]), yaw
    )
