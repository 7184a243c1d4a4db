"""One step of the flow for a block of particles at once (section 6)."""

import warp as wp

from flowtree.kernels.advance_particles import FlowForces, TimeGrid, free_flow_time
from flowtree.kernels.flow_fields import FlowFields, follow_route, turn_to_foot
from flowtree.kernels.living_cells import LivingCells
from flowtree.kernels.meet_others import Meeting, meet_limb, meet_pair
from flowtree.kernels.nearest_in_block import BLOCK, Floats, Wholes
from flowtree.kernels.swarm import Swarm, count_in_cell

# Loops over the lanes of a block must stay loops: the compiler makes vector instructions of sixteen rounds.
wp.set_module_options({"enable_backward": False, "max_unroll": 8})


@wp.func
def response_rate(forces: FlowForces, mass: float, step: float):
    """Nobody answers faster than a step can follow: the method is stable up to a rate of 2.78 a step."""
    return wp.min(1.0 / (forces.response * wp.pow(mass, forces.inertia)), 1.0 / step)


@wp.func
def advance_block(
    swarm: Swarm,
    cells: LivingCells,
    next_cells: LivingCells,
    fields: FlowFields,
    forces: FlowForces,
    times: TimeGrid,
    x: wp.array[float],
    y: wp.array[float],
    z: wp.array[float],
    base: int,
    rank: int,
    first: int,
    last: int,
    number: int,
    front: float,
    step: float,
    arrival: float,
):
    """Joins and then moves at most `BLOCK` particles by one step of the classical Runge-Kutta method.

    The arithmetic is that of `advance_particles`, but each line is done for the whole block before the next,
    so that the compiler makes vector instructions of it; only reading the fields' cells goes one by one.
    Lanes beyond the last particle compute what nobody reads.
    """
    n = last - first
    px = Floats()  # places and velocities at the step's beginning
    py = Floats()
    pz = Floats()
    vx = Floats()
    vy = Floats()
    vz = Floats()
    qx = Floats()  # the nearest neighbour
    qy = Floats()
    qz = Floats()
    pull = Floats()
    rate = Floats()
    speed = Floats()
    alive = Wholes()
    tx = Floats()  # place and velocity of a stage
    ty = Floats()
    tz = Floats()
    wx = Floats()
    wy = Floats()
    wz = Floats()
    sx = Floats()  # weighted sums over the stages
    sy = Floats()
    sz = Floats()
    ux = Floats()
    uy = Floats()
    uz = Floats()
    ox = Floats()  # where the fields lead
    oy = Floats()
    oz = Floats()
    across = Floats()
    along = Floats()
    at_cell = Wholes()
    c0 = Floats()  # the vectors at the cell's corners
    c1 = Floats()
    c2 = Floats()
    c3 = Floats()
    c4 = Floats()
    c5 = Floats()
    c6 = Floats()
    c7 = Floats()
    lane = int(0)
    while lane < n:
        i = first + lane
        met = Meeting()
        if forces.limbs == 1:
            met = meet_limb(swarm, cells, forces, x, y, z, base, number, i)
        else:
            met = meet_pair(swarm, forces, x, y, z, base, number, i)
        at = met.place
        v = met.velocity
        px[lane] = at[0]
        py[lane] = at[1]
        pz[lane] = at[2]
        vx[lane] = v[0]
        vy[lane] = v[1]
        vz[lane] = v[2]
        j = swarm.nearest[i]
        # By the paper's rule the one that it took in was its nearest.
        alone = j < 0 or (met.grown == 1 and forces.limbs == 0)
        pull[lane] = wp.where(alone, 0.0, forces.attraction)
        j = wp.max(j, 0)
        qx[lane] = x[j]
        qy[lane] = y[j]
        qz[lane] = z[j]
        rate[lane] = swarm.rates[i]
        if met.grown == 1:
            rate[lane] = response_rate(forces, met.mass, step)
        speed[lane] = 1.0
        if forces.pace > 0.0:
            speed[lane] = wp.clamp(1.0 + forces.pace * (free_flow_time(times, at) - front), 0.4, 2.0)
        alive[lane] = met.alive
        swarm.mass[i] = met.mass
        swarm.rate[i] = rate[lane]
        lane += 1
    for q in range(BLOCK):
        tx[q] = px[q]
        ty[q] = py[q]
        tz[q] = pz[q]
        wx[q] = vx[q]
        wy[q] = vy[q]
        wz[q] = vz[q]
        sx[q] = float(0.0)
        sy[q] = float(0.0)
        sz[q] = float(0.0)
        ux[q] = float(0.0)
        uy[q] = float(0.0)
        uz[q] = float(0.0)
    rows = fields.vectors.shape[1]
    columns = fields.vectors.shape[2]
    last_u = float(columns - 1)
    last_v = float(rows - 1)
    basin = fields.basin * fields.basin
    inner = 1.0 / wp.max(forces.attraction_radius, 1.0e-30)
    stage = int(0)
    while stage < 4:
        for q in range(BLOCK):
            ox[q] = float(0.0)
            oy[q] = float(0.0)
            oz[q] = float(0.0)
        for view in range(fields.vectors.shape[0]):
            right = fields.right[view]
            scale_u = 1.0 / fields.cell[view][0]
            scale_v = 1.0 / fields.cell[view][1]
            shift_u = fields.corner[view][0] * scale_u + 0.5
            shift_v = fields.corner[view][1] * scale_v + 0.5
            for q in range(BLOCK):
                u = (right[0] * tx[q] + right[1] * ty[q] + right[2] * tz[q]) * scale_u - shift_u
                v_ = ty[q] * scale_v - shift_v
                u = wp.min(wp.max(u, 0.0), last_u)
                v_ = wp.min(wp.max(v_, 0.0), last_v)
                column = wp.min(int(u), columns - 2)
                row = wp.min(int(v_), rows - 2)
                across[q] = u - float(column)
                along[q] = v_ - float(row)
                at_cell[q] = row * columns + column
            flat = fields.vectors[view, 0]
            lane = int(0)
            while lane < n:
                k = at_cell[lane]
                g0 = flat[k]
                g1 = flat[k + 1]
                g2 = flat[k + columns]
                g3 = flat[k + columns + 1]
                c0[lane] = g0[0]
                c1[lane] = g0[1]
                c2[lane] = g1[0]
                c3[lane] = g1[1]
                c4[lane] = g2[0]
                c5[lane] = g2[1]
                c6[lane] = g3[0]
                c7[lane] = g3[1]
                lane += 1
            for q in range(BLOCK):
                low_u = c0[q] + (c2[q] - c0[q]) * across[q]
                low_v = c1[q] + (c3[q] - c1[q]) * across[q]
                high_u = c4[q] + (c6[q] - c4[q]) * across[q]
                high_v = c5[q] + (c7[q] - c5[q]) * across[q]
                vector_u = low_u + (high_u - low_u) * along[q]
                vector_v = low_v + (high_v - low_v) * along[q]
                ox[q] += right[0] * vector_u
                oy[q] += right[1] * vector_u + vector_v
                oz[q] += right[2] * vector_u
        combine = fields.combine
        near_foot = int(0)
        for q in range(BLOCK):
            ax = combine[0, 0] * ox[q] + combine[0, 1] * oy[q] + combine[0, 2] * oz[q]
            ay = combine[1, 0] * ox[q] + combine[1, 1] * oy[q] + combine[1, 2] * oz[q]
            az = combine[2, 0] * ox[q] + combine[2, 1] * oy[q] + combine[2, 2] * oz[q]
            unit = 1.0 / wp.sqrt(wp.max(ax * ax + ay * ay + az * az, 1.0e-30))
            ox[q] = ax * unit
            oy[q] = ay * unit
            oz[q] = az * unit
            square = tx[q] * tx[q] + ty[q] * ty[q] + tz[q] * tz[q]
            near_foot += wp.where(square < basin, 1, 0) + wp.where(ty[q] < 0.0, 1, 0)
        if near_foot > 0 or fields.pull > 0.0:
            lane = int(0)
            while lane < n:
                there = wp.vec3(tx[lane], ty[lane], tz[lane])
                way = wp.vec3(ox[lane], oy[lane], oz[lane])
                if fields.pull > 0.0:
                    way = follow_route(fields, there, way)
                way = turn_to_foot(fields, there, way)
                ox[lane] = way[0]
                oy[lane] = way[1]
                oz[lane] = way[2]
                lane += 1
        weight = wp.where(stage == 1 or stage == 2, 2.0, 1.0)
        ahead = wp.where(stage == 2, step, 0.5 * step)
        for q in range(BLOCK):
            gx = qx[q] - tx[q]
            gy = qy[q] - ty[q]
            gz = qz[q] - tz[q]
            gap = 1.0 / wp.sqrt(wp.max(gx * gx + gy * gy + gz * gz, 1.0e-30))
            draw = pull[q] * wp.max(gap - inner, 0.0)
            ax = (ox[q] * speed[q] + gx * draw * speed[q] - wx[q]) * rate[q]
            ay = (oy[q] * speed[q] + gy * draw * speed[q] - wy[q]) * rate[q]
            az = (oz[q] * speed[q] + gz * draw * speed[q] - wz[q]) * rate[q]
            sx[q] += weight * wx[q]
            sy[q] += weight * wy[q]
            sz[q] += weight * wz[q]
            ux[q] += weight * ax
            uy[q] += weight * ay
            uz[q] += weight * az
            tx[q] = px[q] + ahead * wx[q]
            ty[q] = py[q] + ahead * wy[q]
            tz[q] = pz[q] + ahead * wz[q]
            wx[q] = vx[q] + ahead * ax
            wy[q] = vy[q] + ahead * ay
            wz[q] = vz[q] + ahead * az
        stage += 1
    sixth = step / 6.0
    for q in range(BLOCK):
        px[q] = px[q] + sixth * sx[q]
        py[q] = py[q] + sixth * sy[q]
        pz[q] = pz[q] + sixth * sz[q]
        vx[q] = vx[q] + sixth * ux[q]
        vy[q] = vy[q] + sixth * uy[q]
        vz[q] = vz[q] + sixth * uz[q]
    lane = int(0)
    while lane < n:
        i = first + lane
        to = wp.vec3(px[lane], py[lane], pz[lane])
        me = swarm.particle[base + i]
        if alive[lane] == 1 and wp.length_sq(to) < arrival * arrival:
            alive[lane] = 0
            swarm.moved[i] = -1
            swarm.end_step[me] = number
        swarm.place[i] = to
        swarm.velocity[i] = wp.vec3(vx[lane], vy[lane], vz[lane])
        swarm.number[i] = me
        swarm.cell[i] = -1
        if alive[lane] == 1:
            count_in_cell(swarm, next_cells, rank, i)
        lane += 1
