"""One step of the flow: forces and the classical Runge-Kutta method (Particle Flows, section 6)."""

import warp as wp

from flowtree.kernels.flow_fields import FlowFields, flow_direction, sample_box

wp.set_module_options({"enable_backward": False})


@wp.struct
class TimeGrid:
    """Free-flow times at the points of a box, for pacing.

    time: (nx, ny, nz) [m] of way.
    corner: [m], of point (0, 0, 0).
    spacing: of the points [m].
    """

    time: wp.array3d[float]
    corner: wp.vec3
    spacing: float


@wp.struct
class FlowForces:
    """What acts on a particle besides the fields.

    attraction: weight of the pull to the nearest neighbour, at distance 0.
    attraction_radius: where it ends [m].
    response: time in which a single particle takes on the wanted velocity [m of way at unit speed].
    inertia: exponent of the mass in that time.
    reach: two single particles nearer than this join [m].
    growth: what the square root of the joint mass adds to it [m].
    limbs: 1, a limb takes in at once all that come within its threshold; 0, mutual nearest neighbours join.
    pace: change of speed for each metre of way that a particle is late [1/m].
    """

    attraction: float
    attraction_radius: float
    response: float
    inertia: float
    reach: float
    growth: float
    limbs: int
    pace: float


@wp.func
def free_flow_time(times: TimeGrid, at: wp.vec3):
    """Trilinear value; points outside take the value at the border."""
    return sample_box(times.time, times.corner, times.spacing, at)


@wp.func
def response_rate(forces: FlowForces, mass: float, step: float):
    """Nobody answers faster than a step can follow: the method is stable up to a rate of 2.78 a step."""
    return wp.min(1.0 / (forces.response * wp.pow(mass, forces.inertia)), 1.0 / step)


@wp.func
def acceleration(
    fields: FlowFields,
    forces: FlowForces,
    at: wp.vec3,
    velocity: wp.vec3,
    neighbour: wp.vec3,
    attraction: float,
    speed: float,
    rate: float,
):
    """Force over mass: what turns the velocity into the wanted one."""
    wanted = flow_direction(fields, at)
    gap = neighbour - at
    distance = wp.length(gap)
    if distance > 0.0 and distance < forces.attraction_radius:
        wanted += gap * (attraction * (1.0 - distance / forces.attraction_radius) / distance)
    return (wanted * speed - velocity) * rate


@wp.kernel
def advance_particles(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m], after joining
    place: wp.array[wp.vec3],  # [m], as it was before, where neighbours draw to
    velocity: wp.array[wp.vec3],  # [m] per unit of time
    mass: wp.array[float],
    state: wp.array[int],  # 0 waits, 1 moves, 2 has joined another, 3 has arrived
    nearest: wp.array[int],
    begin: wp.array[int],  # the step in which it sets off
    fields: FlowFields,
    forces: FlowForces,
    times: TimeGrid,
    front: float,  # [m], free-flow time at which particles should be now
    step: float,  # of time [m at unit speed]
    arrival: float,  # [m], closer to the foot than this is there
    number: int,  # of the step
    # out:
    position_out: wp.array[wp.vec3],
    velocity_out: wp.array[wp.vec3],
    state_out: wp.array[int],
    end_step_out: wp.array[int],  # the step that saw it arrive; written where that happens
):
    """Moves every particle by one step of the classical fourth-order Runge-Kutta method; then some set off.

    The nearest neighbour's place is taken as it was at the beginning of the step.
    """
    i = first + wp.tid()
    x = position[i]
    v = velocity[i]
    now = state[i]
    if now == 1:
        neighbour = x
        attraction = float(0.0)
        if nearest[i] >= 0:
            neighbour = place[nearest[i]]
            attraction = forces.attraction
        speed = wp.clamp(1.0 + forces.pace * (free_flow_time(times, x) - front), 0.4, 2.0)
        rate = response_rate(forces, mass[i], step)
        v1 = v
        a1 = acceleration(fields, forces, x, v1, neighbour, attraction, speed, rate)
        v2 = v + 0.5 * step * a1
        a2 = acceleration(fields, forces, x + 0.5 * step * v1, v2, neighbour, attraction, speed, rate)
        v3 = v + 0.5 * step * a2
        a3 = acceleration(fields, forces, x + 0.5 * step * v2, v3, neighbour, attraction, speed, rate)
        v4 = v + step * a3
        a4 = acceleration(fields, forces, x + step * v3, v4, neighbour, attraction, speed, rate)
        x += step / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4)
        v += step / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)
        if wp.length(x) < arrival:
            now = 3
            end_step_out[i] = number
    elif now == 0 and begin[i] == number + 1:
        now = 1
    position_out[i] = x
    velocity_out[i] = v
    state_out[i] = now
