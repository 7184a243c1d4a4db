"""Volumes, fields and particles made by hand or by chance: what tests of the flow start from."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp

from flowtree import device as devices
from flowtree.flow.flow_particles import _begin_steps, make_swarm
from flowtree.geometry.projection import view_axes
from flowtree.kernels.advance_particles import FlowForces, TimeGrid
from flowtree.kernels.cell_list import CellGrid
from flowtree.kernels.flow_fields import FlowFields
from flowtree.kernels.nearest_in_block import BLOCK
from flowtree.kernels.reference.run_flow import run_flow as run_flow_twin
from flowtree.kernels.run_flow import run_flow
from flowtree.kernels.swarm import (
    CELL,
    COUNTED,
    END_STEP,
    JOINED,
    KINDS,
    NEAREST,
    NOTES,
    NUMBER,
)
from flowtree.model.field import DirectionField
from flowtree.model.volume import DensityVolume

_NO_CUDA = pytest.mark.skipif(not wp.is_cuda_available(), reason="no CUDA device: not run")
DEVICES = [pytest.param("cpu"), pytest.param("cuda:0", marks=_NO_CUDA)]


def smooth_noise(rng, shape, waves=3):
    """Values of a few random waves: neighbours on the grid differ little."""
    grid = np.stack(np.meshgrid(*(np.linspace(0, 1, n) for n in shape), indexing="ij"), axis=-1)
    total = np.zeros(shape)
    for _ in range(waves):
        total += np.sin(grid @ rng.uniform(-4, 4, len(shape)) + rng.uniform(0, 6))
    return total / waves


def chance_fields(seed, yaws=(0.0, 90.0), size=9, closeness=0.0):
    """Smooth random fields over a tree of 2 m, and a random route: what the twins read.

    ``closeness`` is one over the distance of the last view's eye; other views are parallel projections.
    """
    rng = np.random.default_rng(seed)
    rights = np.array([view_axes(yaw)[0] for yaw in yaws])
    toward = np.array([view_axes(yaw)[2] for yaw in yaws])
    toward *= closeness * (np.arange(len(yaws)) == len(yaws) - 1)[:, None]
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
        toward=toward.astype(np.float32),
        eye=np.full(len(yaws), 0.4, np.float32),
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
    kinds = {"vectors": wp.vec2, "corner": wp.vec2, "cell": wp.vec2, "right": wp.vec3, "toward": wp.vec3}
    for name, dtype in {**kinds, "eye": wp.float32}.items():
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


def meeting(limbs, reach=0.1, growth=0.02, **others):
    """Forces of particles that join: 0, the paper's pairs; 1, limbs that take in and are paced."""
    out = forces(pace=3.0 * limbs, **others)
    out.reach, out.growth, out.limbs = reach, growth * limbs, limbs
    return out


def waits(start_time, steps, step, count):
    """When each particle sets off, their order, how many have by each step, and the latest time."""
    latest = 0.0 if start_time is None else float(start_time.max())
    begin = _begin_steps(start_time, latest, step, count)
    order = np.argsort(begin, kind="stable").astype(np.int32)
    off = np.searchsorted(begin[order], np.arange(steps + 1), side="right").astype(np.int32)
    return begin, order, off, latest


def flow_swarm(*arguments, **options):
    """The kernel itself, once: the record and what it leaves of the particles."""
    return flow_lists(*arguments, **options)[0]


def flow_lists(
    start, fields, force, *, steps, step, times, arrival=0.1, start_time=None, threads=2, prepare=None
):
    """The same, and what it leaves of each particle, (KINDS, size); ``prepare`` may set both beforehand."""
    count = len(start)
    _, order, off, latest = waits(start_time, steps, step, count)
    size, room = count + BLOCK, count * steps
    swarm = make_swarm(count, steps, threads)
    left, notes = np.zeros((KINDS, size), np.float32), np.full((NOTES, size), -1, np.int32)
    points, particle = np.zeros((room, 3), np.float32), np.zeros(room, np.int32)
    seen = SimpleNamespace(
        points=points,
        particle=particle,
        begin=swarm.begin.numpy(),  # the same memory, as all that follows
        progress=swarm.tally.numpy()[:COUNTED],
        number=notes[NUMBER, :count],
        cell=notes[CELL, :count],
        nearest=notes[NEAREST, :count],
        joined=notes[JOINED, :count],
        end_step=notes[END_STEP, :count],
    )
    if prepare is not None:
        prepare(seen, left)
    inputs = [steps, room, devices.upload(start, wp.vec3, "cpu")]
    inputs += [devices.upload(order, int, "cpu"), devices.upload(off, int, "cpu")]
    inputs += [upload_fields(fields, "cpu"), force, upload_times(times, "cpu"), latest, step, arrival]
    shared = [(left.ravel(), float), (np.zeros(KINDS * size, np.float32), float), (notes.ravel(), int)]
    shared += [(points, wp.vec3), (particle, int)]
    outputs = [devices.hand_over(values, dtype, "cpu") for values, dtype in shared]
    devices.launch_together(run_flow, inputs, [*outputs, swarm], threads=threads)
    return seen, left


def flow_twin(start, fields, force, *, steps, step, times, arrival=0.1, start_time=None):
    """The twin: its swarm, of NumPy arrays."""
    count = len(start)
    _, order, off, latest = waits(start_time, steps, step, count)
    swarm = SimpleNamespace(
        points=np.zeros((count * steps, 3)),
        particle=np.zeros(count * steps, int),
        begin=np.zeros(steps + 1, int),
        joined=np.full(count, -1),
        end_step=np.full(count, -1),
        progress=np.zeros(5, int),
    )
    run_flow_twin(
        0, 1, steps, count * steps, start, order, off, fields, force, times, latest, step, arrival,
        None, None, None, swarm.points, swarm.particle, swarm,
    )  # fmt: skip
    return swarm


def places(points, particle, begin, count):
    """(steps, n, 3) of a record by number; NaN where a particle is not under way."""
    out = np.full((len(begin) - 1, count, 3), np.nan)
    for k in range(len(begin) - 1):
        out[k, particle[begin[k] : begin[k + 1]]] = points[begin[k] : begin[k + 1]]
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
