"""One step of the flow for a block of particles at once (section 6)."""

import warp as wp

from flowtree.kernels.advance_particles import FlowForces, TimeGrid, free_flow_time, response_rate
from flowtree.kernels.flow_fields import FlowFields, follow_route, turn_to_foot
from flowtree.kernels.living_cells import LivingCells
from flowtree.kernels.meet_others import Meeting, meet_limb, meet_pair
from flowtree.kernels.nearest_in_block import BLOCK, NOT_NEGATIVE, Floats, FourFloats, Wholes
from flowtree.kernels.swarm import (
    CELL,
    END_STEP,
    HOST,
    MASS,
    MOVED,
    NEAREST,
    RATE,
    TAKEN,
    Swarm,
    U,
    V,
    W,
    Y,
    Z,
    count_in_cell,
)

# Loops over the lanes of a block must stay loops: the compiler makes vector instructions of sixteen rounds.
wp.set_module_options({"enable_backward": False, "max_unroll": 8})


@wp.func
def advance_block(
    swarm: Swarm,
    notes: wp.array[int],
    particle: wp.array[int],
    cells: LivingCells,
    next_cells: LivingCells,
    fields: FlowFields,
    forces: FlowForces,
    times: TimeGrid,
    left: wp.array[float],
    listed: wp.array[float],
    size: int,
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
    mass = Floats()
    speed = Floats()
    alive = Wholes()
    meets = Wholes()
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
    lower = FourFloats()  # the vectors at the lower two corners of a field's cell: copied at once
    upper = FourFloats()  # and at the upper two
    at_x = first & NOT_NEGATIVE
    wide = size & NOT_NEGATIVE
    for q in range(BLOCK):
        px[q] = listed[at_x + q]
        py[q] = listed[Y * wide + at_x + q]
        pz[q] = listed[Z * wide + at_x + q]
        vx[q] = listed[U * wide + at_x + q]
        vy[q] = listed[V * wide + at_x + q]
        vz[q] = listed[W * wide + at_x + q]
        mass[q] = listed[MASS * wide + at_x + q]
        rate[q] = listed[RATE * wide + at_x + q]
        speed[q] = float(1.0)
        alive[q] = int(1)
    # Most meet nobody: whether one does is asked without a branch.
    lane = int(0)
    while lane < n:
        i = first + lane
        nearest = notes[NEAREST * size + i]
        j = wp.max(nearest, 0) & NOT_NEGATIVE
        qx[lane] = listed[j]
        qy[lane] = listed[Y * wide + j]
        qz[lane] = listed[Z * wide + j]
        pull[lane] = wp.where(nearest >= 0, forces.attraction, 0.0)
        meets[lane] = wp.where(nearest >= 0 and notes[NEAREST * size + j] == i, 1, 0)
        if forces.limbs == 1:
            meets[lane] = wp.where(notes[HOST * size + i] >= 0 or notes[TAKEN * size + i] == 1, 1, 0)
        lane += 1
    if forces.limbs == 0:
        threshold = forces.reach * forces.reach
        for q in range(BLOCK):
            gx = qx[q] - px[q]
            gy = qy[q] - py[q]
            gz = qz[q] - pz[q]
            meets[q] = wp.where(gx * gx + gy * gy + gz * gz < threshold, meets[q], 0)
    lane = int(0)
    while lane < n:
        if meets[lane] == 1:
            i = first + lane
            met = Meeting()
            if forces.limbs == 1:
                met = meet_limb(swarm, notes, particle, cells, forces, listed, size, base, number, i)
            else:
                met = meet_pair(notes, particle, listed, size, base, number, i)
            alive[lane] = met.alive
            if met.grown == 1:
                px[lane] = met.place[0]
                py[lane] = met.place[1]
                pz[lane] = met.place[2]
                vx[lane] = met.velocity[0]
                vy[lane] = met.velocity[1]
                vz[lane] = met.velocity[2]
                mass[lane] = met.mass
                rate[lane] = response_rate(forces, met.mass, step)
                if forces.limbs == 0:
                    pull[lane] = 0.0  # the one that it took in was its nearest
        lane += 1
    if forces.pace > 0.0:
        lane = int(0)
        while lane < n:
            time = free_flow_time(times, wp.vec3(px[lane], py[lane], pz[lane]))
            speed[lane] = wp.clamp(1.0 + forces.pace * (time - front), 0.4, 2.0)
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
    columns = fields.vectors.shape[2] & NOT_NEGATIVE
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
            toward = fields.toward[view]
            eye = fields.eye[view]
            for q in range(BLOCK):
                across[q] = right[0] * tx[q] + right[1] * ty[q] + right[2] * tz[q]
                along[q] = ty[q]
            if wp.length_sq(toward) > 0.0:  # a parallel view needs none of it
                for q in range(BLOCK):
                    nearer = toward[0] * tx[q] + toward[1] * ty[q] + toward[2] * tz[q]
                    larger = 1.0 / wp.max(1.0 - nearer, 0.1)
                    across[q] = across[q] * larger
                    along[q] = eye + (ty[q] - eye) * larger
            for q in range(BLOCK):
                u = across[q] * scale_u - shift_u
                v_ = along[q] * scale_v - shift_v
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
                k = at_cell[lane] & NOT_NEGATIVE
                g0 = flat[k]
                g1 = flat[k + 1]
                g2 = flat[k + columns]
                g3 = flat[k + columns + 1]
                at = (4 * lane) & NOT_NEGATIVE
                lower[at] = g0[0]
                lower[at + 1] = g0[1]
                lower[at + 2] = g1[0]
                lower[at + 3] = g1[1]
                upper[at] = g2[0]
                upper[at + 1] = g2[1]
                upper[at + 2] = g3[0]
                upper[at + 3] = g3[1]
                lane += 1
            for q in range(BLOCK):
                low_u = lower[4 * q] + (lower[4 * q + 2] - lower[4 * q]) * across[q]
                low_v = lower[4 * q + 1] + (lower[4 * q + 3] - lower[4 * q + 1]) * across[q]
                high_u = upper[4 * q] + (upper[4 * q + 2] - upper[4 * q]) * across[q]
                high_v = upper[4 * q + 1] + (upper[4 * q + 3] - upper[4 * q + 1]) * across[q]
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
    # Lanes beyond the last particle hold what is left of others: only whole blocks are written as such.
    if n == BLOCK:
        for q in range(BLOCK):
            left[at_x + q] = px[q]
            left[Y * wide + at_x + q] = py[q]
            left[Z * wide + at_x + q] = pz[q]
            left[U * wide + at_x + q] = vx[q]
            left[V * wide + at_x + q] = vy[q]
            left[W * wide + at_x + q] = vz[q]
            left[MASS * wide + at_x + q] = mass[q]
            left[RATE * wide + at_x + q] = rate[q]
    else:
        lane = int(0)
        while lane < n:
            left[at_x + lane] = px[lane]
            left[Y * wide + at_x + lane] = py[lane]
            left[Z * wide + at_x + lane] = pz[lane]
            left[U * wide + at_x + lane] = vx[lane]
            left[V * wide + at_x + lane] = vy[lane]
            left[W * wide + at_x + lane] = vz[lane]
            left[MASS * wide + at_x + lane] = mass[lane]
            left[RATE * wide + at_x + lane] = rate[lane]
            lane += 1
    for q in range(BLOCK):
        there_yet = px[q] * px[q] + py[q] * py[q] + pz[q] * pz[q] < arrival * arrival
        meets[q] = wp.where(there_yet, alive[q], 0)
    lane = int(0)
    while lane < n:
        i = first + lane
        me = particle[base + i]
        if meets[lane] == 1:
            alive[lane] = 0
            notes[MOVED * size + i] = -1
            notes[END_STEP * size + me] = number
        notes[i] = me
        notes[CELL * size + i] = -1
        if alive[lane] == 1:
            count_in_cell(swarm, notes, left, size, next_cells, rank, i)
        lane += 1
