"""Finds the segment of a plane that is nearest to each point (Particle Flows, section 7)."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.kernel
def nearest_segment(
    # in:
    first: int,
    place: wp.array[wp.vec2],  # [m]
    start: wp.array[wp.vec2],  # [m], of the segments
    along: wp.array[wp.vec2],  # [m], from there to their ends
    over: wp.array[float],  # [1/m^2], 1 / their squared length; 0 where they have none
    low: wp.array[wp.vec2],  # [m], the corners of a box around each run of segments
    high: wp.array[wp.vec2],
    run: int,  # segments in a run
    # out:
    segment_out: wp.array[int],
):
    """Skips runs whose box is farther away than what was found; of equally near segments the first counts."""
    i = first + wp.tid()
    at = place[i]
    best = float(3.0e38)
    nearest = int(0)
    for r in range(low.shape[0]):
        outside = wp.max(wp.max(low[r] - at, at - high[r]), wp.vec2())
        if wp.dot(outside, outside) < best:
            for s in range(r * run, wp.min((r + 1) * run, start.shape[0])):
                gap = at - start[s]
                rest = gap - wp.clamp(wp.dot(gap, along[s]) * over[s], 0.0, 1.0) * along[s]
                square = wp.dot(rest, rest)
                if square < best:
                    best = square
                    nearest = s
    segment_out[i] = nearest
