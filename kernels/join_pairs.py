"""Joining of particles that are each other's nearest neighbour (Particle Flows, section 6)."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.kernel
def join_pairs(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m]
    velocity: wp.array[wp.vec3],  # [m] per unit of time
    mass: wp.array[float],  # particles combined
    state: wp.array[int],
    nearest: wp.array[int],
    reach: float,  # [m], threshold of two single particles
    growth: float,  # [m], what the square root of the pair's mass adds to it
    now: int,  # number of the step
    # out:
    position_out: wp.array[wp.vec3],
    velocity_out: wp.array[wp.vec3],
    mass_out: wp.array[float],
    state_out: wp.array[int],
    joined_out: wp.array[int],  # whom it went over to; written where that happens
    end_step_out: wp.array[int],  # likewise, the step in which it happened
):
    """Joins mutual nearest neighbours under the threshold; the lower index goes on with both masses.

    Each thread writes its own particle only, from what both were before: there is no race, and the
    order of threads does not matter. Mass and momentum are kept.
    """
    i = first + wp.tid()
    position_out[i] = position[i]
    velocity_out[i] = velocity[i]
    mass_out[i] = mass[i]
    state_out[i] = state[i]
    j = nearest[i]
    if state[i] == 1 and j >= 0:
        both = mass[i] + mass[j]
        if nearest[j] == i and wp.length(position[j] - position[i]) < reach + growth * (wp.sqrt(both) - 1.0):
            if i < j:
                position_out[i] = (mass[i] * position[i] + mass[j] * position[j]) / both
                velocity_out[i] = (mass[i] * velocity[i] + mass[j] * velocity[j]) / both
                mass_out[i] = both
            else:
                state_out[i] = 2
                joined_out[i] = j
                end_step_out[i] = now
