"""Joining of particles with the limb they run into (Particle Flows, section 6)."""

import warp as wp

from flowtree.kernels.cell_list import CellGrid, cell_of

wp.set_module_options({"enable_backward": False})


@wp.kernel
def join_particles(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m]
    velocity: wp.array[wp.vec3],  # [m] per unit of time
    mass: wp.array[float],  # particles combined
    state: wp.array[int],  # 1 is moving
    host: wp.array[int],  # whom it may join, -1 for nobody
    index: wp.array[int],  # particles, sorted by cell
    begin: wp.array[int],  # where each cell begins in it
    grid: CellGrid,
    reach: float,  # [m], threshold of two single particles
    growth: float,  # [m], what the square root of the joint mass adds to it
    now: int,  # number of the step
    # out:
    position_out: wp.array[wp.vec3],
    velocity_out: wp.array[wp.vec3],
    mass_out: wp.array[float],
    state_out: wp.array[int],
    joined_out: wp.array[int],  # whom it went over to; written where that happens
    end_step_out: wp.array[int],  # likewise, the step in which it happened
):
    """Takes every particle over into its host, unless that one itself goes over to another in this step.

    Each thread writes its own particle only, from what all were before, and a host sums its guests up in the
    order of the sorted list: there is no race, and the order of threads does not matter. Mass and momentum
    are kept.
    """
    i = first + wp.tid()
    position_out[i] = position[i]
    velocity_out[i] = velocity[i]
    mass_out[i] = mass[i]
    state_out[i] = state[i]
    if state[i] == 1:
        if host[i] >= 0:
            if host[host[i]] < 0:
                state_out[i] = 2
                joined_out[i] = host[i]
                end_step_out[i] = now
        else:
            # No guest is heavier than its host, so none is farther away than this.
            far = reach + growth * (wp.sqrt(2.0 * mass[i]) - 1.0)
            low = cell_of(grid, position[i] - wp.vec3(far, far, far))
            high = cell_of(grid, position[i] + wp.vec3(far, far, far))
            total = mass[i]
            moment = mass[i] * position[i]
            momentum = mass[i] * velocity[i]
            for z in range(low[2], high[2] + 1):
                for y in range(low[1], high[1] + 1):
                    row = grid.nx * (y + grid.ny * z)
                    for k in range(begin[row + low[0]], begin[row + high[0] + 1]):
                        j = index[k]
                        if host[j] == i:
                            total += mass[j]
                            moment += mass[j] * position[j]
                            momentum += mass[j] * velocity[j]
            if total > mass[i]:
                position_out[i] = moment / total
                velocity_out[i] = momentum / total
                mass_out[i] = total
