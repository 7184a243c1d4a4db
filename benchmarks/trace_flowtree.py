"""The workload with flowtree's own kernels."""

from __future__ import annotations

import numpy as np

from benchmarks.workload import (
    ARRIVAL,
    BASIN,
    CELL,
    INERTIA,
    LEFT,
    MOST_STEPS,
    RESPONSE,
    STEP,
    Traced,
    Workload,
)
from flowtree.flow.flow_particles import flow_particles
from flowtree.flow.upload_fields import upload_fields
from flowtree.kernels.advance_particles import FlowForces
from flowtree.model.field import DirectionField

_YAWS = (0.0, 90.0)


def trace_flowtree(workload: Workload, *, threads: int | None = None, device: str = "cpu") -> Traced:
    """Traces all particles; the record is flowtree's own."""
    corner, cell = np.array([LEFT, 0.0], np.float32), np.array([CELL, CELL], np.float32)
    fields = [
        DirectionField(vectors=vectors, origin=corner, cell=cell, yaw=yaw)
        for vectors, yaw in zip(workload.vectors, _YAWS, strict=True)
    ]
    forces = FlowForces()
    forces.attraction, forces.attraction_radius = 1.0, workload.radius
    forces.response, forces.inertia = RESPONSE, INERTIA
    forces.reach, forces.growth, forces.limbs, forces.pace = workload.threshold, 0.0, 0, 0.0
    record = flow_particles(
        workload.start,
        upload_fields(fields, basin=BASIN, device=device),
        forces,
        step=STEP,
        arrival=ARRIVAL,
        steps=MOST_STEPS,
        threads=threads,
    )
    arrived = int(((record.joined < 0) & (record.end_step >= 0)).sum())
    return Traced(record.joined, record.end_step, arrived, record.particle_steps, record)
