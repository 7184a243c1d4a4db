"""Particles flow from the crown to the foot and join on their way (Particle Flows, section 6)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.flow.check_inputs import check_fields, check_volume
from flowtree.flow.count_particles import count_particles
from flowtree.flow.flow_particles import flow_particles
from flowtree.flow.join_traces import join_traces
from flowtree.flow.route_to_foot import route_to_foot
from flowtree.flow.seed_particles import seed_particles
from flowtree.flow.upload_fields import upload_fields
from flowtree.kernels.advance_particles import FlowForces, TimeGrid
from flowtree.kernels.flow_fields import FlowFields
from flowtree.kernels.time_flow import time_flow
from flowtree.model.field import DirectionField, LimbField
from flowtree.model.traces import FlowTraces
from flowtree.model.volume import DensityVolume
from flowtree.params import FlowParams

_ARRIVAL = 0.012  # of the height: closer to the foot than this has arrived
_BASIN = 0.05  # of the height: nearer than this the foot alone attracts
_TIME_POINTS = 14  # points along the height of the grid of free-flow times
_LONGEST = 8.0  # tree heights of way after which the rest is taken as lost
_SHIFT = 12  # steps; as many as any usual stride divides
_SPLIT_FROM = 512  # starts from which a second core pays: following a field to the foot is much work for each
_MEANT = 2500  # particles for which the distances at which they join are meant


def trace_particles(
    volume: DensityVolume,
    fields: Sequence[DirectionField],
    *,
    limbs: LimbField | None = None,
    params: FlowParams = FlowParams(),
    seed: int = 0,
    device: str | None = None,
    threads: int | None = None,
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
        limbs: the field around the limbs in space, which goes before the views'; None for none.
        params: number of particles and forces; lengths in tree heights.
        seed: of the random starts.
        device: where the kernels run; None picks.
        threads: cores at most; None takes `flowtree.device.thread_count` of them. It changes no byte.

    Raises:
        InputError: fields that cannot be sampled together, a volume that is empty or not finite.
    """
    check_volume(volume)
    check_fields(fields)
    where = devices.pick_device(device)
    low = np.asarray(volume.origin, np.float64)
    size = np.array(volume.density.shape) * float(volume.voxel)
    # The unit of all lengths; not the height where a box lies so far aside that there is no tree's shape.
    height = max(float(low[1] + size[1]), 0.5 * float(np.abs([low, low + size]).max()))
    arrival = max(_ARRIVAL, 2 * params.step) * height  # a step must not leap over it
    count = params.particle_count or count_particles(volume)
    start = seed_particles(volume, count, seed=seed)
    flow = upload_fields(
        fields, route_to_foot(volume, limbs), pull=params.basis_pull, basin=_BASIN * height, device=where
    )
    clock = _Clock(flow, 2 * params.step * height, arrival, int(2 / params.step), where, threads)
    start_time = _in_whole_steps(clock.time(start), _SHIFT * params.step * height)
    record = flow_particles(
        start,
        flow,
        _forces(params, height, count),
        step=params.step * height,
        arrival=arrival,
        steps=int(min(2 * float(start_time.max()) / height, _LONGEST) / params.step) + 64,
        times=clock.grid(low, size, max(height, float(size.max()) / 3) / _TIME_POINTS),
        start_time=start_time,
        threads=threads,
    )
    return join_traces(
        start,
        record.points,
        record.step,
        record.particle,
        begin_step=record.begin_step,
        end_step=record.end_step,
        joined=record.joined,
        last=len(record.begin) - 2,
    )


def _forces(params: FlowParams, height: float, count: int) -> FlowForces:
    """In metres. More particles stand closer, and each is less of the tree: reaches shrink."""
    forces = FlowForces()
    forces.attraction = params.attraction
    forces.attraction_radius = params.attraction_radius * height
    forces.response = params.response * height
    forces.inertia = params.inertia
    share = min(1.0, _MEANT / count)
    forces.reach = params.join_distance * height * share ** (1 / 3)
    forces.growth = params.join_growth * height * share**0.5
    forces.limbs = 1
    forces.pace = params.pace / height
    return forces


def _in_whole_steps(times: NDArray[np.float32], shift: float) -> NDArray[np.float32]:
    """The times with the longest rounded up to whole shifts.

    It says when all others set off. If another particle has it, all others shift by so many steps, flow as
    they did, and those steps of theirs are kept that were kept before.
    """
    longest = int(np.argmax(times))
    times[longest] = np.ceil(float(times[longest]) / shift - 1e-3) * shift
    return times


class _Clock:
    """Measures free-flow times: the way of a lone particle to the foot [m]."""

    def __init__(
        self, fields: FlowFields, step: float, arrival: float, limit: int, where: str, threads: int | None
    ) -> None:
        self.inputs = [fields, step, arrival, limit]
        self.where, self.threads = where, threads

    def time(self, points: NDArray[np.float32]) -> NDArray[np.float32]:
        """(n,) from each of the points (n, 3)."""
        result = devices.empty(len(points), float, self.where)
        inputs = [devices.upload(points, wp.vec3, self.where), *self.inputs]
        devices.launch(
            time_flow,
            len(points),
            inputs,
            [result],
            device=self.where,
            split_from=_SPLIT_FROM,
            threads=self.threads,
        )
        times: NDArray[np.float32] = result.numpy()
        return times

    def grid(self, low: NDArray[np.float64], size: NDArray[np.float64], spacing: float) -> TimeGrid:
        """At the points of a box of which the foot is one: near it the time is exact."""
        corner = np.floor(low / spacing) * spacing
        shape = np.maximum(np.ceil((low + size - corner) / spacing).astype(int) + 1, 2)
        points = corner + np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1) * spacing
        times = TimeGrid()
        values = self.time(points.reshape(-1, 3).astype(np.float32)).reshape(shape)
        times.time = devices.upload(values, float, self.where)
        times.corner = wp.vec3(*map(float, corner))
        times.spacing = spacing
        return times
