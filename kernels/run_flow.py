"""The whole flow in one launch of a thread a core: sort, find, join, advance, record (section 6)."""

import warp as wp

from flowtree.kernels.advance_block import advance_block
from flowtree.kernels.advance_particles import FlowForces, TimeGrid, response_rate
from flowtree.kernels.flow_fields import FlowFields
from flowtree.kernels.living_cells import fit_cells, share_of
from flowtree.kernels.meet_others import find_host
from flowtree.kernels.nearest_in_block import BLOCK, LANES, find_nearest_in_block
from flowtree.kernels.swarm import (
    CELL,
    COUNT,
    COUNTED,
    DONE,
    FITTED,
    GONE,
    HEAVIEST,
    HOST,
    KINDS,
    NOBODY,
    NUMBER_OF_STEPS,
    SPAN,
    TAKEN,
    Swarm,
    Y,
    Z,
    count_in_cell,
    count_range,
    highest_of,
    lowest_of,
    number_range,
    place_of,
    set_off,
    sort_range,
    tell_box,
)
from flowtree.kernels.wait_for_all import wait_for_all

# Loops over the lanes of a block must stay loops: the compiler makes vector instructions of sixteen rounds.
wp.set_module_options({"enable_backward": False, "max_unroll": 8})

ALONE = wp.constant(65)  # living particles below which threads cost more than they save


@wp.kernel
def run_flow(
    # in:
    first: int,
    ranks: int,
    steps: int,  # at which to stop at the latest
    capacity: int,  # of the record: stops where another step might not fit
    start: wp.array[wp.vec3],  # [m]
    order: wp.array[int],  # particles in the order in which they set off
    off: wp.array[int],  # (steps + 1,), how many have set off at each step's beginning
    fields: FlowFields,
    forces: FlowForces,
    times: TimeGrid,
    latest: float,  # [m], free-flow time at which particles should be in step 0
    step: float,  # of time [m at unit speed]
    arrival: float,  # [m], closer to the foot than this is there
    # out:
    left_out: wp.array[float],  # (KINDS, size), the particles as the last step left them
    listed_out: wp.array[float],  # (KINDS, size), sorted by cell; size is BLOCK more than there are particles
    notes_out: wp.array[int],  # (NOTES, size), see `swarm`
    points_out: wp.array[wp.vec3],  # (capacity,) [m], the record: step after step, sorted by cell
    particle_out: wp.array[int],  # (capacity,), whose place it is
    swarm_out: Swarm,
):
    """Steps on from where ``swarm_out`` stands until nobody is under way, and keeps every step.

    Index ``first`` is one of ``ranks`` threads that run at once, each with its share of the particles; they
    wait for each other five times a step (six where limbs take in). What a thread computes depends on no
    other's share: any number of threads gives the same bytes. Cells follow the count and the box of the
    living, step by step. When few are left, the first thread does all.
    """
    rank = first + wp.tid()
    threads = int(ranks)
    size = listed_out.shape[0] // KINDS
    most_cells = swarm_out.held.shape[1]
    turn = int(0)
    count = swarm_out.tally[COUNT]
    number = swarm_out.tally[NUMBER_OF_STEPS]
    gone = swarm_out.tally[GONE]
    base = int(0)
    single = response_rate(forces, 1.0, step)
    lowest = wp.vec3(NOBODY, NOBODY, NOBODY)
    highest = -lowest
    low = share_of(count, rank, threads)
    high = share_of(count, rank + 1, threads)
    i = int(low)
    while i < high:
        if notes_out[CELL * size + i] >= 0:
            lowest = wp.min(lowest, place_of(left_out, size, i))
            highest = wp.max(highest, place_of(left_out, size, i))
        i += 1
    if rank == threads - 1:
        set_off(notes_out, left_out, size, start, order, gone, off[number], single, count)
        i = int(count)
        while i < count + off[number] - gone:
            lowest = wp.min(lowest, place_of(left_out, size, i))
            highest = wp.max(highest, place_of(left_out, size, i))
            i += 1
        high = count + off[number] - gone
    count += off[number] - gone
    gone = off[number]
    tell_box(swarm_out, rank, lowest, highest)
    turn += threads
    wait_for_all(swarm_out.arrived, turn)
    for r in range(threads):
        lowest = wp.min(lowest, lowest_of(swarm_out, r))
        highest = wp.max(highest, highest_of(swarm_out, r))
    cells = fit_cells(lowest, highest, count, most_cells)
    if number > 0:
        cells = fit_cells(
            lowest_of(swarm_out, ranks), highest_of(swarm_out, ranks), swarm_out.tally[FITTED], most_cells
        )
    i = int(low)
    while i < high:
        if notes_out[CELL * size + i] >= 0:
            count_in_cell(swarm_out, notes_out, left_out, size, cells, rank, i)
        i += 1
    turn += threads
    wait_for_all(swarm_out.arrived, turn)
    going = bool(True)
    done = int(0)
    fitted = int(0)
    room = wp.vec3(2.0 * step, 2.0 * step, 2.0 * step)
    while going:
        # Sort: how many before each cell, then every particle to its place.
        total = cells.nx * cells.ny * cells.nz
        low_cell = share_of(total, rank, threads)
        high_cell = share_of(total, rank + 1, threads)
        swarm_out.tally[COUNTED + rank] = count_range(swarm_out, low_cell, high_cell, threads)
        turn += threads
        wait_for_all(swarm_out.arrived, turn)
        before = int(0)
        living = int(0)
        for r in range(threads):
            before += wp.where(r < rank, swarm_out.tally[COUNTED + r], 0)
            living += swarm_out.tally[COUNTED + r]
        number_range(swarm_out, low_cell, high_cell, before, threads)
        if rank == 0:
            swarm_out.first[total] = living
        turn += threads
        wait_for_all(swarm_out.arrived, turn)
        sort_range(
            swarm_out,
            left_out,
            listed_out,
            notes_out,
            points_out,
            particle_out,
            size,
            rank,
            low,
            high,
            base,
        )
        if rank == 0:
            lane = int(0)
            while lane < LANES:
                listed_out[living + lane] = NOBODY
                listed_out[Y * size + living + lane] = NOBODY
                listed_out[Z * size + living + lane] = NOBODY
                lane += 1
        turn += threads
        wait_for_all(swarm_out.arrived, turn)
        # Find: the nearest of each, and where limbs take in, its host.
        count = living
        low = share_of(count, rank, threads)
        high = share_of(count, rank + 1, threads)
        lowest = wp.vec3(NOBODY, NOBODY, NOBODY)
        highest = -lowest
        heaviest = float(1.0)
        for r in range(threads):
            lowest = wp.min(lowest, lowest_of(swarm_out, r))
            highest = wp.max(highest, highest_of(swarm_out, r))
            heaviest = wp.max(heaviest, swarm_out.span[SPAN * r + HEAVIEST])
        c = int(0)
        while c < total:
            swarm_out.held[rank, c] = 0
            c += 1
        block = int(low)
        while block < high:
            find_nearest_in_block(
                cells,
                swarm_out.first,
                listed_out,
                size,
                count,
                wp.max(forces.attraction_radius, forces.reach),
                block,
                wp.min(block + BLOCK, high),
                notes_out,
            )
            block += BLOCK
        if forces.limbs == 1:
            i = int(low)
            while i < high:
                notes_out[HOST * size + i] = find_host(
                    swarm_out, particle_out, cells, forces, listed_out, size, base, heaviest, i
                )
                i += 1
            turn += threads
            wait_for_all(swarm_out.arrived, turn)
            i = int(low)
            while i < high:
                host = notes_out[HOST * size + i]
                if host >= 0:
                    if notes_out[HOST * size + host] < 0:
                        notes_out[TAKEN * size + host] = 1  # whoever writes it writes the same
                i += 1
        turn += threads
        wait_for_all(swarm_out.arrived, turn)
        # Join and advance, and count in the cells of the next step: a little wider, since all have moved.
        fitted = count
        next_cells = fit_cells(lowest - room, highest + room, count, most_cells)
        front = latest - float(number) * step
        block = int(low)
        while block < high:
            advance_block(
                swarm_out,
                notes_out,
                particle_out,
                cells,
                next_cells,
                fields,
                forces,
                times,
                left_out,
                listed_out,
                size,
                base,
                rank,
                block,
                wp.min(block + BLOCK, high),
                number,
                front,
                step,
                arrival,
            )
            block += BLOCK
        cells = next_cells
        base += count
        number += 1
        new = off[number] - gone
        if rank == threads - 1:
            set_off(notes_out, left_out, size, start, order, gone, gone + new, single, count)
            i = int(count)
            while i < count + new:
                count_in_cell(swarm_out, notes_out, left_out, size, cells, rank, i)
                i += 1
            high = count + new
        gone += new
        if rank == 0:
            swarm_out.begin[number] = base
        turn += threads
        wait_for_all(swarm_out.arrived, turn)
        count += new
        more = gone < off[steps]
        if threads > 1 and count < ALONE and not more:
            c = int(0)
            while c < cells.nx * cells.ny * cells.nz:
                swarm_out.held[rank, c] = 0
                c += 1
            threads = 1
            low = 0
            high = wp.where(rank == 0, count, 0)
            i = int(0)
            while i < high:
                if notes_out[CELL * size + i] >= 0:
                    count_in_cell(swarm_out, notes_out, left_out, size, cells, 0, i)
                i += 1
        done = wp.where(living > 0 or new > 0 or more, 0, 1)
        going = done == 0 and number < steps and base + count <= capacity and rank < threads
    # Leaves no count behind for the next launch.
    c = int(0)
    while c < cells.nx * cells.ny * cells.nz:
        swarm_out.held[rank, c] = 0
        c += 1
    if rank == 0:
        swarm_out.tally[COUNT] = count
        swarm_out.tally[NUMBER_OF_STEPS] = number
        swarm_out.tally[GONE] = gone
        swarm_out.tally[DONE] = done
        swarm_out.tally[FITTED] = fitted
        tell_box(swarm_out, ranks, lowest - room, highest + room)
