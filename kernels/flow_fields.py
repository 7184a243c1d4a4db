"""The direction fields of all views and what they say at a point of the world (section 7)."""

from typing import Any

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.struct
class FlowFields:
    """Fields of equal resolution, one a view, and how to put them together.

    vectors: (views, rows, columns), in the view's plane (image-right, up); row 0 is the lowest.
    corner: (views,) [m], lower left corner of cell (0, 0).
    cell: (views,) [m], width and height of a cell.
    right: (views,) image-right in the world.
    toward: (views,) toward the eye over its distance [1/m]; 0 for a parallel projection.
    eye: (views,) height of the eye [m].
    combine: brings the sum of the views' world vectors to their average.
    route: (nx, ny, nz) along the shortest way to the foot, at the points of a box; of length 1 in the crown,
        up to 2 in the air, where the route alone is followed.
    route_corner: [m], of point (0, 0, 0).
    route_spacing: of the points [m].
    pull: cosine between field and route above which the field is followed; below its negative the route is;
        0 for the fields alone, without any route.
    basin: [m], nearer to the foot than this, and under the ground, the straight way to the foot takes over,
        so that nobody flows past it.
    """

    vectors: wp.array3d[wp.vec2]
    corner: wp.array[wp.vec2]
    cell: wp.array[wp.vec2]
    right: wp.array[wp.vec3]
    toward: wp.array[wp.vec3]
    eye: wp.array[float]
    combine: wp.mat33
    route: wp.array3d[wp.vec3]
    route_corner: wp.vec3
    route_spacing: float
    pull: float
    basin: float


@wp.func
def seen_larger(toward: wp.vec3, at: wp.vec3):
    """How many times as large as at the tree's axis an eye sees what is there; 1 in a parallel projection.

    ``toward`` is the direction to the eye over its distance. What is nearer to the eye than a tenth of that
    counts as being as far.
    """
    return 1.0 / wp.max(1.0 - wp.dot(toward, at), 0.1)


@wp.func
def view_vector(fields: FlowFields, view: int, at: wp.vec3):
    """Bilinear value of one view's field; points outside take the value at its border."""
    rows = fields.vectors.shape[1]
    columns = fields.vectors.shape[2]
    larger = seen_larger(fields.toward[view], at)
    across = wp.dot(fields.right[view], at) * larger
    height = fields.eye[view] + (at[1] - fields.eye[view]) * larger
    u = (across - fields.corner[view][0]) / fields.cell[view][0] - 0.5
    v = (height - fields.corner[view][1]) / fields.cell[view][1] - 0.5
    u = wp.clamp(u, 0.0, float(columns - 1))
    v = wp.clamp(v, 0.0, float(rows - 1))
    j = wp.min(int(u), columns - 2)
    i = wp.min(int(v), rows - 2)
    a = u - float(j)
    b = v - float(i)
    low = fields.vectors[view, i, j] * (1.0 - a) + fields.vectors[view, i, j + 1] * a
    high = fields.vectors[view, i + 1, j] * (1.0 - a) + fields.vectors[view, i + 1, j + 1] * a
    return low * (1.0 - b) + high * b


@wp.func
def sample_box(values: wp.array3d[Any], corner: wp.vec3, spacing: float, at: wp.vec3):
    """Trilinear value of a box of points; points outside take the value at its border."""
    place = (at - corner) / spacing
    x = wp.clamp(place[0], 0.0, float(values.shape[0]) - 1.001)
    y = wp.clamp(place[1], 0.0, float(values.shape[1]) - 1.001)
    z = wp.clamp(place[2], 0.0, float(values.shape[2]) - 1.001)
    i = int(x)
    j = int(y)
    k = int(z)
    a = x - float(i)
    b = y - float(j)
    c = z - float(k)
    near = (values[i, j, k] * (1.0 - a) + values[i + 1, j, k] * a) * (1.0 - b) + (
        values[i, j + 1, k] * (1.0 - a) + values[i + 1, j + 1, k] * a
    ) * b
    far = (values[i, j, k + 1] * (1.0 - a) + values[i + 1, j, k + 1] * a) * (1.0 - b) + (
        values[i, j + 1, k + 1] * (1.0 - a) + values[i + 1, j + 1, k + 1] * a
    ) * b
    return near * (1.0 - c) + far * c


@wp.func
def route_vector(fields: FlowFields, at: wp.vec3):
    """Trilinear value of the route; points outside take the value at its border."""
    return sample_box(fields.route, fields.route_corner, fields.route_spacing, at)


@wp.func
def follow_route(fields: FlowFields, at: wp.vec3, along: wp.vec3):
    """The fields' direction, and where it leads away from the route, the route: a unit vector."""
    route = route_vector(fields, at)
    solid = wp.clamp(2.0 - wp.length(route), 0.0, 1.0)
    route = wp.normalize(route)
    trust = wp.clamp(0.5 + 0.5 * wp.dot(along, route) / fields.pull, 0.0, 1.0) * solid
    return wp.normalize(along * trust + route * (1.0 - trust))


@wp.func
def turn_to_foot(fields: FlowFields, at: wp.vec3, along: wp.vec3):
    """A direction that gives way to the straight way to the foot near it and under the ground."""
    free = wp.min(wp.length(at) / fields.basin, 1.0) * wp.clamp(1.0 + at[1] / fields.basin, 0.0, 1.0)
    return along * free - wp.normalize(at) * (1.0 - free)


@wp.func
def flow_direction(fields: FlowFields, at: wp.vec3):
    """Where a particle wants to go: the average of the views' vectors, mixed with the route if there is one.

    Of length 1, less where field and foot disagree, 0 where all fields are zero and no route leads on.
    """
    total = wp.vec3(0.0, 0.0, 0.0)
    for view in range(fields.vectors.shape[0]):
        vector = view_vector(fields, view, at)
        total += fields.right[view] * vector[0] + wp.vec3(0.0, vector[1], 0.0)
    along = wp.normalize(fields.combine * total)
    if fields.pull > 0.0:
        along = follow_route(fields, at, along)
    return turn_to_foot(fields, at, along)
