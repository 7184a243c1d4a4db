"""The paper's rule of joining: mutual nearest neighbours under a threshold (Particle Flows, section 6)."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.kernel
def pair_nearest(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m]
    mass: wp.array[float],  # particles combined
    nearest: wp.array[int],  # -1 for nobody
    reach: float,  # [m], nearer than this two become one
    # out:
    host_out: wp.array[int],  # whom it goes over to, -1 for nobody
    nearest_out: wp.array[int],  # the nearest, but -1 for who takes that one in: nobody draws it then
):
    """Of two that are each other's nearest, the lighter (of equal mass: the later) goes to the other."""
    i = first + wp.tid()
    host = int(-1)
    j = nearest[i]
    nearest_out[i] = j
    if j >= 0:
        heavier = mass[j] > mass[i] or (mass[j] == mass[i] and j < i)
        if nearest[j] == i and wp.length_sq(position[j] - position[i]) < reach * reach:
            if heavier:
                host = j
            else:
                nearest_out[i] = -1
    host_out[i] = host
