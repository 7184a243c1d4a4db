"""Particles flow from the crown to the foot and join on their way (Particle Flows, section 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device
from flowtree.flow.check_inputs import check_fields, check_volume
from flowtree.flow.count_particles import count_particles
from flowtree.flow.join_traces import join_traces
from flowtree.flow.route_to_foot import route_to_foot
from flowtree.flow.seed_particles import seed_particles
from flowtree.geometry.projection import view_axes
from flowtree.kernels.advance_particles import FlowForces, TimeGrid, advance_particles
from flowtree.kernels.cell_list import CellGrid, assign_cells, bound_cells
from flowtree.kernels.find_nearest import find_nearest
from flowtree.kernels.flow_fields import FlowFields
from flowtree.kernels.join_particles import join_particles
from flowtree.kernels.time_flow import time_flow
from flowtree.model.field import DirectionField
from flowtree.model.traces import FlowTraces
from flowtree.model.volume import DensityVolume
from flowtree.params import FlowParams

_ARRIVAL = 0.012  # of the height: closer to the foot than this has arrived
_BASIN = 0.05  # of the height: nearer than this the foot alone attracts
_TIME_POINTS = 14  # points along the height of the grid of free-flow times
_BLOCK = 8  # steps between two looks at who is still on the way
_LONGEST = 8.0  # tree heights of way after which the rest is taken as lost
_SPLIT_FROM = 512  # starts from which a second core pays: following a field to the foot is much work for each


def trace_particles(
    volume: DensityVolume,
    fields: Sequence[DirectionField],
    *,
    params: FlowParams = FlowParams(),
    seed: int = 0,
    device: str | None = None,
) -> FlowTraces:
    """Traces particles from the crown to the foot; their joined paths are one tree.

    Each particle is a mass with a velocity (equation 2). The force on it turns the velocity into the wanted
    one: the average of the views' direction fields, a pull to the nearest neighbour that fades to nothing at
    ``attraction_radius``, and a pull to the basis. The system is solved with the classical fourth-order
    Runge-Kutta method. Particles under a threshold join; mass and momentum are kept.

    Deviations, each measured on trees with known truth:
      * A component of the world vector is averaged over the views that see it. A plain average halves what
        only one view sees, and every branch comes out steeper than it was drawn.
      * Particles join only when they meet, so those that start near the foot wait. A grid of free-flow times
        (the way a lone particle has from there) says when each sets off, and while they flow, particles that
        are late hurry: all come to the trunk together and leave it as one.
      * The threshold grows with the root of the joint mass, as limbs do, and a particle joins the heavier one
        whose threshold it has gone past farthest, not only its nearest neighbour and not only in pairs: a
        limb takes in at once all that have come into it. (In pairs, hundreds of those that started inside
        the trunk reached the foot on their own, each beside the next.)
      * The mass acts as a time of response ``response * mass**inertia``: with the full mass in it no trunk of
        2,000 particles could follow a bend.
      * Who has not arrived after twice the expected time is joined to the nearest path that has.

    Args:
        volume: where particles start, in proportion to its density.
        fields: one a view, all of one resolution.
        params: number of particles and forces; lengths in tree heights.
        seed: of the random starts.
        device: where the kernels run; None picks.

    Raises:
        InputError: fields that cannot be sampled together, a volume that is empty or not finite.
    """
    check_volume(volume)
    check_fields(fields)
    where = _device(device)
    start = seed_particles(volume, params.particle_count or count_particles(volume), seed=seed)
    flow = _Flow(volume, fields, start, params, where)
    last = flow.run()
    points, step, particle = flow.recorded()
    begin, end, joined = flow.ends()
    return join_traces(
        start, points, step, particle, begin_step=begin, end_step=end, joined=joined, last=last
    )


def _device(name: str | None) -> str:
    return device.pick_device(name)


@dataclass
class _Buffers:
    """What a step reads and writes, on the device; the second of each pair is the step's between-state."""

    velocity: tuple[Any, Any]
    mass: tuple[Any, Any]
    state: tuple[Any, Any]
    position: Any
    nearest: Any
    host: Any
    key: Any
    index: Any
    begin: Any


class _Flow:
    """The simulation: arrays on the device, and one method a phase."""

    def __init__(
        self,
        volume: DensityVolume,
        fields: Sequence[DirectionField],
        start: NDArray[np.float32],
        params: FlowParams,
        where: str,
    ) -> None:
        self.where = where
        self.params = params
        self.count = len(start)
        low = np.asarray(volume.origin, np.float64)
        size = np.array(volume.density.shape) * float(volume.voxel)
        # The unit of all lengths; not the height where a box lies so far aside that there is no tree's shape.
        aside = 0.5 * float(np.abs([low, low + size]).max())
        self.height = max(float(low[1] + size[1]), aside)
        self.fields = self._upload_fields(volume, fields)
        self.times = self._free_flow_times(low, size)
        self.radius = max(params.attraction_radius, params.join_distance) * self.height
        self.grid = _cell_grid(low, size, self.radius)
        start_time = self._flow_times(start)
        self.start_time = device.upload(start_time, float, where)
        self.front = float(start_time.max())
        self.steps = int(min(2 * self.front / self.height, _LONGEST) / params.step) + 64
        # The places at the beginning of a block of steps and after each of them.
        self.block = device.zeros((_BLOCK + 1, self.count), wp.vec3, where)
        self.block[0].assign(start)
        self.records: list[tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.int32]]] = []
        self.joined = device.upload(np.full(self.count, -1, np.int32), int, where)
        self.begin_step = device.upload(np.full(self.count, -1, np.int32), int, where)
        self.end_step = device.upload(np.full(self.count, -1, np.int32), int, where)

    def run(self) -> int:
        """Steps until nobody moves or waits; returns the number of steps taken."""
        buffers = self._buffers()
        length = self.params.step * self.height
        number = 0
        while number < self.steps:
            for row in range(_BLOCK):
                self._find_nearest(buffers, row)
                self._join(buffers, row, number + row)
                self._advance(buffers, row, number + row, self.front - (number + row) * length, length)
            self._record(number, _BLOCK)
            number += _BLOCK
            self.block[0].assign(self.block[_BLOCK])
            if (self.end_step.numpy() >= 0).all():
                break
        self._record(number, 1)
        return number

    def recorded(self) -> tuple[NDArray[np.float32], NDArray[np.int32], NDArray[np.int32]]:
        """Places (m, 3), steps (m,) and particles (m,) of everybody who was on the way."""
        points, steps, particles = zip(*self.records, strict=True)
        return np.concatenate(points), np.concatenate(steps), np.concatenate(particles)

    def _record(self, number: int, rows: int) -> None:
        """Keeps, of the block's first rows, the places of those on the way: a thirtieth of all."""
        begin, end = self.begin_step.numpy(), self.end_step.numpy()
        steps = number + np.arange(rows)[:, None]
        there = (begin >= 0) & (steps >= begin) & ((end < 0) | (steps <= end))
        row, particle = np.nonzero(there)
        places = self.block.numpy()[row, particle]
        self.records.append((places, (number + row).astype(np.int32), particle.astype(np.int32)))

    def ends(self) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
        """First step, last step (-1: still under way) and the particle joined (-1: none), of each."""
        return self.begin_step.numpy(), self.end_step.numpy(), self.joined.numpy()

    def _buffers(self) -> _Buffers:
        n, where = self.count, self.where
        return _Buffers(
            velocity=(device.zeros(n, wp.vec3, where), device.zeros(n, wp.vec3, where)),
            mass=(device.upload(np.ones(n, np.float32), float, where), device.zeros(n, float, where)),
            state=(device.zeros(n, int, where), device.zeros(n, int, where)),
            position=device.zeros(n, wp.vec3, where),
            nearest=device.zeros(n, int, where),
            host=device.zeros(n, int, where),
            key=device.zeros(2 * n, int, where),
            index=device.zeros(2 * n, int, where),
            begin=device.zeros(self.grid.nx * self.grid.ny * self.grid.nz + 1, int, where),
        )

    def _find_nearest(self, b: _Buffers, row: int) -> None:
        n, where, position = self.count, self.where, self.block[row]
        cells = self.grid.nx * self.grid.ny * self.grid.nz
        device.launch(assign_cells, n, [position, b.state[0], self.grid], [b.key, b.index], device=where)
        device.sort_pairs(b.key, b.index, n)
        device.launch(bound_cells, n + 1, [b.key, n, cells], [b.begin], device=where)
        inputs = [position, b.mass[0], b.state[0], b.index, b.begin, self.grid, self.radius, *self._reach()]
        device.launch(find_nearest, n, inputs, [b.nearest, b.host], device=where)

    def _join(self, b: _Buffers, row: int, number: int) -> None:
        inputs = [self.block[row], b.velocity[0], b.mass[0], b.state[0], b.host, b.index, b.begin]
        inputs += [self.grid, *self._reach(), number]
        outputs = [b.position, b.velocity[1], b.mass[1], b.state[1], self.joined, self.end_step]
        device.launch(join_particles, self.count, inputs, outputs, device=self.where)
        b.mass = (b.mass[1], b.mass[0])

    def _reach(self) -> tuple[float, float]:
        return self.params.join_distance * self.height, self.params.join_growth * self.height

    def _advance(self, b: _Buffers, row: int, number: int, front: float, length: float) -> None:
        forces = FlowForces()
        forces.attraction = self.params.attraction
        forces.attraction_radius = self.params.attraction_radius * self.height
        forces.response = self.params.response * self.height
        forces.inertia = self.params.inertia
        forces.pace = self.params.pace / self.height
        inputs = [b.position, b.velocity[1], b.mass[0], b.state[1], b.nearest, self.start_time]
        inputs += [self.fields, forces, self.times, front, length, self._arrival(), number]
        outputs = [self.block[row + 1], b.velocity[0], b.state[0], self.begin_step, self.end_step]
        device.launch(advance_particles, self.count, inputs, outputs, device=self.where)

    def _arrival(self) -> float:
        """Closer to the foot than this has arrived [m]; a step must not leap over it."""
        return max(_ARRIVAL, 2 * self.params.step) * self.height

    def _upload_fields(self, volume: DensityVolume, fields: Sequence[DirectionField]) -> FlowFields:
        where = self.where
        rights = np.array([view_axes(field.yaw)[0] for field in fields])
        up = np.array([0.0, 1.0, 0.0])
        seen = sum(np.outer(right, right) + np.outer(up, up) for right in rights)
        route, corner, spacing = route_to_foot(volume)
        flow = FlowFields()
        flow.vectors = device.upload(np.stack([f.vectors for f in fields]).astype(np.float32), wp.vec2, where)
        flow.corner = device.upload(np.stack([f.origin for f in fields]).astype(np.float32), wp.vec2, where)
        flow.cell = device.upload(np.stack([f.cell for f in fields]).astype(np.float32), wp.vec2, where)
        flow.right = device.upload(rights.astype(np.float32), wp.vec3, where)
        flow.combine = wp.mat33(*np.linalg.pinv(seen).ravel().tolist())
        flow.route = device.upload(route, wp.vec3, where)
        flow.route_corner = wp.vec3(*map(float, corner))
        flow.route_spacing = spacing
        flow.pull = self.params.basis_pull
        flow.basin = _BASIN * self.height
        return flow

    def _flow_times(self, points: NDArray[np.float32]) -> NDArray[np.float32]:
        """Way of a lone particle from each point to the foot [m]."""
        step = 2 * self.params.step * self.height
        limit = int(4 * self.height / step)
        result = device.empty(len(points), float, self.where)
        inputs = [device.upload(points, wp.vec3, self.where), self.fields, step, self._arrival(), limit]
        device.launch(time_flow, len(points), inputs, [result], device=self.where, split_from=_SPLIT_FROM)
        times: NDArray[np.float32] = result.numpy()
        return times

    def _free_flow_times(self, low: NDArray[np.float64], size: NDArray[np.float64]) -> TimeGrid:
        spacing = max(self.height, float(size.max()) / 3) / _TIME_POINTS
        corner = (
            np.floor(low / spacing) * spacing
        )  # the foot is a point of the grid: near it the time is exact
        shape = np.maximum(np.ceil((low + size - corner) / spacing).astype(int) + 1, 2)
        points = corner + np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1) * spacing
        times = TimeGrid()
        values = self._flow_times(points.reshape(-1, 3).astype(np.float32)).reshape(shape)
        times.time = device.upload(values, float, self.where)
        times.corner = wp.vec3(*map(float, corner))
        times.spacing = spacing
        return times


def _cell_grid(low: NDArray[np.float64], size: NDArray[np.float64], radius: float) -> CellGrid:
    """Cells as wide as the radius, but at most 64 along a side."""
    grid = CellGrid()
    grid.corner = wp.vec3(*map(float, low))
    grid.edge = max(radius, float(size.max()) / 64)
    grid.nx, grid.ny, grid.nz = (max(1, int(np.ceil(s / grid.edge))) for s in size)
    return grid
