"""The flow with a launch a phase, as a GPU wants it (Particle Flows, section 6)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device
from flowtree.flow.flow_record import FlowRecord
from flowtree.kernels.advance_particles import FlowForces, TimeGrid, advance_particles
from flowtree.kernels.cell_list import CellGrid, assign_cells, bound_cells
from flowtree.kernels.find_nearest import find_nearest
from flowtree.kernels.flow_fields import FlowFields
from flowtree.kernels.join_particles import join_particles
from flowtree.kernels.pair_nearest import pair_nearest

_BLOCK = 8  # steps between two looks at who is still on the way


def flow_in_launches(
    start: NDArray[np.float32],
    fields: FlowFields,
    forces: FlowForces,
    times: TimeGrid,
    begin: NDArray[np.int32],
    *,
    latest: float,
    step: float,
    arrival: float,
    steps: int,
) -> FlowRecord:
    """What `flow_particles` does, with one index a particle and a launch for each phase of a step.

    On the CPU it gives the same flow as `flowtree.kernels.run_flow` up to rounding: each is tested against
    the other.

    Args:
        start: (n, 3) [m].
        fields: what the particles follow; its arrays say on which device.
        forces: what acts on them besides.
        times: free-flow times, for ``forces.pace``.
        begin: (n,) step in which each sets off.
        latest: free-flow time at which particles should be in step 0 [m].
        step: of time [m at unit speed].
        arrival: closer to the foot than this has arrived [m].
        steps: after which it ends at the latest.
    """
    flow = _Flow(start, fields, forces, times, begin, latest, step, arrival)
    return flow.run(steps)


@dataclass
class _Buffers:
    """What a step reads and writes, on the device; the second of each pair is the step's between-state."""

    velocity: tuple[Any, Any]
    mass: tuple[Any, Any]
    state: tuple[Any, Any]
    position: Any
    nearest: Any
    draws: Any
    host: Any
    key: Any
    index: Any
    begin: Any


class _Flow:
    """The simulation: arrays on the device, and one method a phase."""

    def __init__(
        self,
        start: NDArray[np.float32],
        fields: FlowFields,
        forces: FlowForces,
        times: TimeGrid,
        begin: NDArray[np.int32],
        latest: float,
        step: float,
        arrival: float,
    ) -> None:
        where = self.where = str(fields.vectors.device)
        self.fields, self.forces, self.times = fields, forces, times
        self.latest, self.step, self.arrival = latest, step, arrival
        self.count = len(start)
        self.radius = max(forces.attraction_radius, forces.reach)
        self.grid = _cell_grid(start, self.radius)
        self.begin = begin
        self.begin_step = device.upload(begin, int, where)
        # The places at the beginning of a block of steps and after each of them.
        self.block = device.zeros((_BLOCK + 1, self.count), wp.vec3, where)
        self.block[0].assign(start)
        self.blocks: list[tuple[NDArray[np.float32], NDArray[np.int32]]] = []
        self.lengths: list[NDArray[np.int64]] = [np.zeros(1, np.int64)]
        nobody = np.full(self.count, -1, np.int32)
        self.joined, self.end_step = (device.upload(nobody, int, where) for _ in range(2))

    def run(self, steps: int) -> FlowRecord:
        """Steps until nobody moves or waits."""
        buffers = self._buffers()
        number = 0
        while number < steps:
            rows = min(_BLOCK, steps - number)
            for row in range(rows):
                self._find_nearest(buffers, row)
                self._join(buffers, row, number + row)
                self._advance(buffers, row, number + row)
            self._record(number, rows)
            number += rows
            self.block[0].assign(self.block[rows])
            if (self.end_step.numpy() >= 0).all():
                break
        return FlowRecord(
            blocks=tuple(self.blocks),
            begin=np.cumsum(np.concatenate(self.lengths)),
            begin_step=np.where(self.begin < number, self.begin, -1).astype(np.int32),
            end_step=self.end_step.numpy(),
            joined=self.joined.numpy(),
        )

    def _record(self, number: int, rows: int) -> None:
        """Keeps, of the block's first rows, the places of those on the way: a thirtieth of all."""
        begin, end = self.begin, self.end_step.numpy()
        steps = number + np.arange(rows)[:, None]
        there = (steps >= begin) & ((end < 0) | (steps <= end))
        row, particle = np.nonzero(there)
        self.blocks.append((self.block.numpy()[row, particle], particle.astype(np.int32)))
        self.lengths.append(np.bincount(row, minlength=rows))

    def _buffers(self) -> _Buffers:
        n, where = self.count, self.where
        return _Buffers(
            velocity=(device.zeros(n, wp.vec3, where), device.zeros(n, wp.vec3, where)),
            mass=(device.upload(np.ones(n, np.float32), float, where), device.zeros(n, float, where)),
            state=(
                device.upload((self.begin == 0).astype(np.int32), int, where),
                device.zeros(n, int, where),
            ),
            position=device.zeros(n, wp.vec3, where),
            nearest=device.zeros(n, int, where),
            draws=device.zeros(n, int, where),
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
        inputs = [position, b.mass[0], b.state[0], b.index, b.begin, self.grid, self.radius]
        inputs += [self.forces.reach, self.forces.growth]
        device.launch(find_nearest, n, inputs, [b.nearest, b.host], device=where)
        if self.forces.limbs == 0:
            inputs = [position, b.mass[0], b.nearest, self.forces.reach]
            device.launch(pair_nearest, n, inputs, [b.host, b.draws], device=where)

    def _join(self, b: _Buffers, row: int, number: int) -> None:
        inputs = [self.block[row], b.velocity[0], b.mass[0], b.state[0], b.host, b.index, b.begin]
        inputs += [self.grid, self.forces.reach, self.forces.growth, number]
        outputs = [b.position, b.velocity[1], b.mass[1], b.state[1], self.joined, self.end_step]
        device.launch(join_particles, self.count, inputs, outputs, device=self.where)
        b.mass = (b.mass[1], b.mass[0])

    def _advance(self, b: _Buffers, row: int, number: int) -> None:
        nearest = b.draws if self.forces.limbs == 0 else b.nearest
        inputs = [b.position, self.block[row], b.velocity[1], b.mass[0], b.state[1], nearest, self.begin_step]
        inputs += [
            self.fields,
            self.forces,
            self.times,
            self.latest - number * self.step,
            self.step,
            self.arrival,
            number,
        ]
        outputs = [self.block[row + 1], b.velocity[0], b.state[0], self.end_step]
        device.launch(advance_particles, self.count, inputs, outputs, device=self.where)


def _cell_grid(start: NDArray[np.float32], radius: float) -> CellGrid:
    """Cells as wide as the radius, but at most 64 along a side, around the starts and the foot."""
    low = np.minimum(start.min(axis=0), 0.0).astype(np.float64)
    size = np.maximum(start.max(axis=0), 0.0) - low
    grid = CellGrid()
    grid.corner = wp.vec3(*map(float, low))
    grid.edge = max(radius, float(size.max()) / 64, 1e-9)
    grid.nx, grid.ny, grid.nz = (max(1, int(np.ceil(s / grid.edge))) for s in size)
    return grid
