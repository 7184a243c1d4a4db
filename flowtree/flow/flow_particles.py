"""Particles flow until all have arrived or joined, and every step is recorded (Particle Flows, section 6)."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import check, device
from flowtree.flow.flow_in_launches import flow_in_launches
from flowtree.flow.flow_record import FlowRecord
from flowtree.kernels.advance_particles import FlowForces, TimeGrid
from flowtree.kernels.flow_fields import FlowFields
from flowtree.kernels.nearest_in_block import BLOCK
from flowtree.kernels.run_flow import run_flow
from flowtree.kernels.swarm import (
    COUNTED,
    DONE,
    END_STEP,
    JOINED,
    KINDS,
    NOTES,
    NUMBER_OF_STEPS,
    SPAN,
    Swarm,
)

_BLOCK = 4_000_000  # places recorded in one piece of memory


def flow_particles(
    start: NDArray[np.float32],
    fields: FlowFields,
    forces: FlowForces,
    *,
    step: float,
    arrival: float,
    steps: int,
    times: TimeGrid | None = None,
    start_time: NDArray[np.float32] | None = None,
    threads: int | None = None,
) -> FlowRecord:
    """Solves equation 2 for all particles at once with the classical fourth-order Runge-Kutta method.

    In each step every particle finds its nearest neighbour; those that meet join, mass and momentum are kept;
    who is left moves on, drawn by the fields and by its neighbour. With ``forces.limbs`` 0 this is the
    paper's method: mutual nearest neighbours under a threshold join, and all set off at once. On the CPU all
    of it is one launch of a thread a core, `flowtree.kernels.run_flow`; on CUDA a launch a phase.

    Args:
        start: (n, 3) [m], where the particles begin.
        fields: what they follow; its arrays say on which device.
        forces: what acts on them besides.
        step: of time [m at unit speed].
        arrival: closer to the foot than this has arrived [m].
        steps: after which it ends at the latest.
        times: free-flow times for ``forces.pace``; left out where that is 0.
        start_time: (n,) [m], the free-flow time of each start: the near ones wait until the far ones have
            come as near. Left out, all set off at once.
        threads: cores on the CPU at most; left out, `device.thread_count` of them. It changes no byte.

    Raises:
        InputError: starts that are not finite.
    """
    check.array(start, "start", shape=(None, 3))
    check.require(steps > 0, "steps", "must be at least 1", steps, "give more")
    where = str(fields.vectors.device)
    if times is None:
        times = _no_times(where)
    latest = float(start_time.max()) if start_time is not None and len(start) else 0.0
    begin = _begin_steps(start_time, latest, step, len(start))
    if not len(start):
        return FlowRecord.of_nobody()
    if where != "cpu":
        return flow_in_launches(
            start, fields, forces, times, begin, latest=latest, step=step, arrival=arrival, steps=steps
        )
    return _run(start, fields, forces, times, begin, latest, step, arrival, steps, threads)


@lru_cache(maxsize=4)
def _no_times(where: str) -> TimeGrid:
    """Times that nobody reads."""
    times = TimeGrid()
    times.time, times.spacing = device.zeros((2, 2, 2), float, where), 1.0
    return times


def _begin_steps(
    start_time: NDArray[np.float32] | None, latest: float, step: float, count: int
) -> NDArray[np.int32]:
    """(n,) the step in which each particle sets off."""
    if start_time is None:
        return np.zeros(count, np.int32)
    return np.ceil((latest - start_time.astype(np.float64)) / step - 1e-6).clip(min=0).astype(np.int32)


def _run(
    start: NDArray[np.float32],
    fields: FlowFields,
    forces: FlowForces,
    times: TimeGrid,
    begin: NDArray[np.int32],
    latest: float,
    step: float,
    arrival: float,
    steps: int,
    threads: int | None,
) -> FlowRecord:
    count, ranks = len(start), device.thread_count(threads)
    size = count + BLOCK
    order = np.argsort(begin, kind="stable").astype(np.int32)
    off = np.searchsorted(begin[order], np.arange(steps + 1), side="right").astype(np.int32)
    notes = np.empty((NOTES, size), np.int32)
    notes[[JOINED, END_STEP]] = -1
    swarm: Any = make_swarm(count, steps, ranks)
    inputs = [
        steps,
        0,
        device.hand_over(start, wp.vec3, "cpu"),
        device.hand_over(order, int, "cpu"),
        device.hand_over(off, int, "cpu"),
        fields,
        forces,
        times,
        latest,
        step,
        arrival,
    ]
    lists = [device.zeros(KINDS * size, float, "cpu") for _ in range(2)]
    lists.append(device.hand_over(notes.ravel(), int, "cpu"))
    blocks, bounds, number = [], [np.zeros(1, np.int64)], 0
    while True:
        capacity = inputs[1] = max(count, min(_BLOCK, count * (steps - number)))
        points, particle = np.empty((capacity, 3), np.float32), np.empty(capacity, np.int32)
        record = [device.hand_over(points, wp.vec3, "cpu"), device.hand_over(particle, int, "cpu")]
        swarm.arrived.zero_()
        device.launch_together(run_flow, inputs, [*lists, *record, swarm], threads=ranks)
        tally = swarm.tally.numpy()
        ends = swarm.begin.numpy()[number + 1 : tally[NUMBER_OF_STEPS] + 1].astype(np.int64)
        blocks.append((points[: ends[-1]], particle[: ends[-1]]))
        bounds.append(bounds[-1][-1] + ends)
        number = int(tally[NUMBER_OF_STEPS])
        if tally[DONE] or number == steps:
            break
    return FlowRecord(
        blocks=tuple(blocks),
        begin=np.concatenate(bounds),
        begin_step=np.where(begin < number, begin, -1).astype(np.int32),
        end_step=notes[END_STEP, :count].copy(),
        joined=notes[JOINED, :count].copy(),
    )


def make_swarm(count: int, steps: int, ranks: int) -> Any:
    """What the threads of a flow share before its first step."""
    cells = count + BLOCK
    swarm: Any = Swarm()  # Warp leaves it untyped
    swarm.first = device.empty(cells + 1, int, "cpu")
    swarm.held = device.zeros((ranks, cells), int, "cpu")
    swarm.begin = device.zeros(steps + 1, int, "cpu")
    swarm.tally = device.zeros(COUNTED + ranks, int, "cpu")
    swarm.span = device.zeros((ranks + 1) * SPAN, float, "cpu")
    swarm.arrived = device.zeros(1, int, "cpu")
    return swarm
