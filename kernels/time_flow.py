"""How long a particle alone needs to the foot."""

import warp as wp

from flowtree.kernels.flow_fields import FlowFields, flow_direction

wp.set_module_options({"enable_backward": False})


@wp.kernel
def time_flow(
    # in:
    first: int,
    start: wp.array[wp.vec3],  # [m]
    fields: FlowFields,
    step: float,  # [m]
    arrival: float,  # [m], closer to the foot than this is there
    limit: int,  # steps at most; the rest is counted as a straight way
    # out:
    time_out: wp.array[float],  # [m] of way at unit speed
):
    """Follows the fields at unit speed with the midpoint rule and measures the way."""
    i = first + wp.tid()
    at = start[i]
    count = int(0)
    while count < limit and wp.length(at) > arrival:
        middle = at + 0.5 * step * wp.normalize(flow_direction(fields, at))
        at += step * wp.normalize(flow_direction(fields, middle))
        count += 1
    time_out[i] = float(count) * step + wp.length(at)
