"""Carries rings along branches and places their vertices (Particle Flows, section 8).

In float64, for the mesh is compared bit by bit with itself: vertices that differ in texture coordinates alone
lie in one place, and there are too few of them for the width of a number to show in the time.
"""

import warp as wp

wp.set_module_options({"enable_backward": False})

_SHORT = wp.constant(wp.float64(1.0e-12))  # a vector without a direction
_LOST = wp.constant(wp.float64(1.0e-3))  # of a unit vector's length: what is left across the tangent is noise
_TURN = wp.constant(wp.float64(6.283185307179586))


@wp.func
def unit(v: wp.vec3d) -> wp.vec3d:
    """The vector at length 1; 0 where it has none."""
    length = wp.length(v)
    if length > _SHORT:
        return v / length
    return wp.vec3d()


@wp.func
def across(v: wp.vec3d, tangent: wp.vec3d) -> wp.vec3d:
    """The part of the vector across the tangent, unit; any direction across it where there is none."""
    part = v - wp.dot(v, tangent) * tangent
    if wp.length(part) < _LOST:
        size = wp.vec3d(wp.abs(tangent[0]), wp.abs(tangent[1]), wp.abs(tangent[2]))
        flat = wp.vec3d(wp.float64(0.0), wp.float64(0.0), wp.float64(1.0))
        if size[0] <= size[1] and size[0] <= size[2]:
            flat = wp.vec3d(wp.float64(1.0), wp.float64(0.0), wp.float64(0.0))
        elif size[1] <= size[2]:
            flat = wp.vec3d(wp.float64(0.0), wp.float64(1.0), wp.float64(0.0))
        part = flat - wp.dot(flat, tangent) * tangent
    return unit(part)


@wp.func
def mirror(v: wp.vec3d, normal: wp.vec3d) -> wp.vec3d:
    """The vector mirrored in the plane across the normal."""
    return v - wp.float64(2.0) * wp.dot(normal, v) * normal


@wp.kernel
def transport_frames(
    # in:
    first: int,
    center: wp.array[wp.vec3d],  # [m], of the rings, one branch behind the other
    tangent: wp.array[wp.vec3d],  # unit
    chain_start: wp.array[int],  # the first ring of each branch; one more than there are branches
    side: wp.vec3d,  # the side of a branch's first ring to which its frame points
    # out:
    one_out: wp.array[wp.vec3d],  # unit, across the tangent
    two_out: wp.array[wp.vec3d],  # tangent x one
):
    """Rotation-minimising frames by double reflection, one branch an index, ring after ring."""
    chain = first + wp.tid()
    begin = chain_start[chain]
    one = across(side, tangent[begin])
    for ring in range(begin, chain_start[chain + 1]):
        if ring > begin:
            chord = unit(center[ring] - center[ring - 1])
            second = unit(tangent[ring] - mirror(tangent[ring - 1], chord))
            # Where two rings are in one place or a curve turns right back there is no such rotation.
            if wp.length(chord) > _LOST and wp.length(second) > _LOST:
                one = mirror(mirror(one, chord), second)
            one = across(one, tangent[ring])
        one_out[ring] = one
        two_out[ring] = wp.cross(tangent[ring], one)


@wp.kernel
def place_vertices(
    # in:
    first: int,
    center: wp.array[wp.vec3d],  # [m], of the rings
    tangent: wp.array[wp.vec3d],
    one: wp.array[wp.vec3d],  # the rings' frames
    two: wp.array[wp.vec3d],
    radius: wp.array[wp.float64],  # [m]
    slope: wp.array[wp.float64],  # d radius / d arc; below -1e30 at an apex
    ring_of: wp.array[int],  # of each row of vertices
    sides: wp.array[int],  # of each row's ring
    vertex_start: wp.array[int],  # of each row
    repeats: wp.array[int],  # of the texture around each row
    uv_start: wp.array[wp.vec2d],
    # out:
    position_out: wp.array[wp.vec3],  # [m]
    normal_out: wp.array[wp.vec3],
    uv_out: wp.array[wp.vec2],
    tangent_out: wp.array[wp.vec4],  # unit, toward growing u; the bitangent is normal x tangent
):
    """The vertices of one row an index: a ring's and its first once more, or an apex's, one a side."""
    row = first + wp.tid()
    ring = ring_of[row]
    apex = slope[ring] < wp.float64(-1.0e30)
    count = sides[row]
    columns = count + 1
    shift = wp.float64(0.0)
    if apex:
        columns = count
        shift = wp.float64(0.5)
    for column in range(columns):
        # The twin's angle is computed from the same number, so that its position is the same float.
        angle = _TURN * wp.float64(column % count) / wp.float64(count)
        outward = wp.cos(angle) * one[ring] + wp.sin(angle) * two[ring]
        normal = tangent[ring]
        # A ring of two sides is a blade: its normals lean to the front and to the back.
        lean = wp.float64(0.0)
        if not apex:
            if count == 2:
                lean = _TURN / wp.float64(8.0) * wp.float64(1 - column)
            facing = wp.cos(angle + lean) * one[ring] + wp.sin(angle + lean) * two[ring]
            normal = unit(facing - slope[ring] * tangent[ring])
        around = (wp.float64(column) + shift) / wp.float64(count)
        u = around * wp.float64(repeats[row])
        turned = _TURN * (around - wp.floor(around)) + lean
        along = wp.cos(turned) * two[ring] - wp.sin(turned) * one[ring]
        at = center[ring] + radius[ring] * outward
        vertex = vertex_start[row] + column
        position_out[vertex] = wp.vec3(wp.float32(at[0]), wp.float32(at[1]), wp.float32(at[2]))
        normal_out[vertex] = wp.vec3(wp.float32(normal[0]), wp.float32(normal[1]), wp.float32(normal[2]))
        uv = uv_start[row] + wp.vec2d(u, wp.float64(0.0))
        uv_out[vertex] = wp.vec2(wp.float32(uv[0]), wp.float32(uv[1]))
        tangent_out[vertex] = wp.vec4(
            wp.float32(along[0]), wp.float32(along[1]), wp.float32(along[2]), wp.float32(1.0)
        )
