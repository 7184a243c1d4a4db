"""Densities of a box whose sums along lines of sight are given depths (Particle Flows, section 5)."""

import warp as wp

from flowtree.kernels.flow_fields import seen_larger

wp.set_module_options({"enable_backward": False})

#: Largest logarithm by which densities are scaled at once: ratios beyond mean nothing and would overflow.
FARTHEST = wp.constant(20.0)


@wp.struct
class SightViews:
    """Pictures of the planes through the tree's axis that face their views, all of the same size.

    right: (views,) image-right in the world.
    toward: (views,) toward the eye in the world.
    closeness: (views,) one over the distance of the eye [1/m]; 0 for a parallel projection.
    eye: (views,) its height [m].
    left: [m], image-right coordinate of the first column's left line; the lowest row stands on the ground.
    cell: edge of a picture's cell and of a voxel [m].
    corner: [m], the box's lowest corner.
    """

    right: wp.array[wp.vec3]
    toward: wp.array[wp.vec3]
    closeness: wp.array[float]
    eye: wp.array[float]
    left: float
    cell: float
    corner: wp.vec3


@wp.func
def look_up(values: wp.array3d[float], view: int, u: float, v: float) -> float:
    """Bilinear value of a picture (columns, rows) between its cells' centres; 0 beyond it."""
    i = int(wp.floor(u))
    j = int(wp.floor(v))
    total = float(0.0)
    if i >= 0 and j >= 0 and i < values.shape[1] - 1 and j < values.shape[2] - 1:
        a = u - float(i)
        b = v - float(j)
        low = values[view, i, j] * (1.0 - a) + values[view, i + 1, j] * a
        high = values[view, i, j + 1] * (1.0 - a) + values[view, i + 1, j + 1] * a
        total = low * (1.0 - b) + high * b
    return total


@wp.func
def density_at(density: wp.array3d[float], place: wp.vec3) -> float:
    """Trilinear value between the voxels' centres, ``place`` counted in voxels; 0 beyond them."""
    i = int(wp.floor(place[0]))
    j = int(wp.floor(place[1]))
    k = int(wp.floor(place[2]))
    total = float(0.0)
    inside = i >= 0 and j >= 0 and k >= 0
    if inside and i < density.shape[0] - 1 and j < density.shape[1] - 1 and k < density.shape[2] - 1:
        a = place[0] - float(i)
        b = place[1] - float(j)
        c = place[2] - float(k)
        low = (density[i, j, k] * (1.0 - a) + density[i + 1, j, k] * a) * (1.0 - b) + (
            density[i, j + 1, k] * (1.0 - a) + density[i + 1, j + 1, k] * a
        ) * b
        high = (density[i, j, k + 1] * (1.0 - a) + density[i + 1, j, k + 1] * a) * (1.0 - b) + (
            density[i, j + 1, k + 1] * (1.0 - a) + density[i + 1, j + 1, k + 1] * a
        ) * b
        total = low * (1.0 - c) + high * c
    return total


@wp.func
def picture_place(views: SightViews, view: int, at: wp.vec3) -> wp.vec2:
    """Where a picture shows a place of the world, counted in cells' centres."""
    larger = seen_larger(views.toward[view] * views.closeness[view], at)
    across = wp.dot(views.right[view], at) * larger
    height = views.eye[view] + (at[1] - views.eye[view]) * larger
    # What an eye sees below the foot stands on the ground before it: the picture ends there.
    up = wp.max(height / views.cell - 0.5, 0.0)
    return wp.vec2((across - views.left) / views.cell - 0.5, up)


@wp.kernel
def sum_sights(
    # in:
    first: int,
    views: SightViews,
    wanted: wp.array3d[float],  # (views, columns, rows); what is 0 is not summed
    density: wp.array3d[float],  # (nx, ny, nz), depth of a voxel
    steps: int,  # half of the places at which a line of sight is looked at, a cell apart in depth
    # out:
    depth_out: wp.array3d[float],  # (views, columns, rows)
):
    """Sums the densities along the lines of sight through the pictures' cells; an index for each of them."""
    i = first + wp.tid()
    columns = wanted.shape[1]
    rows = wanted.shape[2]
    view = i // (columns * rows)
    column = (i // rows) % columns
    row = i % rows
    total = float(0.0)
    if wanted[view, column, row] > 0.0:
        eye = wp.vec3(0.0, views.eye[view], 0.0)
        across = views.left + (float(column) + 0.5) * views.cell
        from_eye = views.right[view] * across
        from_eye += wp.vec3(0.0, (float(row) + 0.5) * views.cell, 0.0) - eye
        # A place moves so far while it comes nearer by 1.
        along = views.toward[view] - from_eye * views.closeness[view]
        half = wp.vec3(0.5, 0.5, 0.5)
        begin = (eye + from_eye - views.corner) / views.cell - half
        for step in range(2 * steps):
            total += density_at(density, begin + along * (float(step - steps) + 0.5))
        total *= wp.length(along)
    depth_out[view, column, row] = total


@wp.kernel
def scale_sights(
    # in:
    first: int,
    views: SightViews,
    log_ratio: wp.array3d[float],  # (views, columns, rows), logarithm of what a density is to be scaled by
    power: float,  # of each view's factor
    # out:
    density_out: wp.array3d[float],  # (nx, ny, nz), depth of a voxel, changed in place
):
    """Scales densities by what the views ask for where they see them; an index for each row along z."""
    i = first + wp.tid()
    x = i // density_out.shape[1]
    y = i % density_out.shape[1]
    for z in range(density_out.shape[2]):
        if density_out[x, y, z] > 0.0:
            middle = wp.vec3(float(x) + 0.5, float(y) + 0.5, float(z) + 0.5)
            at = views.corner + middle * views.cell
            total = float(0.0)
            for view in range(log_ratio.shape[0]):
                place = picture_place(views, view, at)
                total += look_up(log_ratio, view, place[0], place[1])
            density_out[x, y, z] *= wp.exp(wp.clamp(power * total, -FARTHEST, FARTHEST))


@wp.kernel
def carve_sights(
    # in:
    first: int,
    views: SightViews,
    depth: wp.array3d[float],  # (views, columns, rows)
    least: float,  # depth that every view must show of a voxel that is kept
    # out:
    density_out: wp.array3d[float],  # (nx, ny, nz), depth of a voxel, changed in place
):
    """Empties the voxels of which a view shows too little; an index for each row along z."""
    i = first + wp.tid()
    x = i // density_out.shape[1]
    y = i % density_out.shape[1]
    for z in range(density_out.shape[2]):
        middle = wp.vec3(float(x) + 0.5, float(y) + 0.5, float(z) + 0.5)
        at = views.corner + middle * views.cell
        for view in range(depth.shape[0]):
            place = picture_place(views, view, at)
            if look_up(depth, view, place[0], place[1]) < least:
                density_out[x, y, z] = 0.0
