"""Casts a picture's worth of parallel rays at triangles sorted into square tiles of rays."""

import warp as wp

wp.set_module_options({"enable_backward": False})

# Rays by which what is certainly missed is told too narrowly: far more than float32's error in a picture.
SLACK = 0.02


@wp.struct
class RayGrid:
    """The rays and how they are cut into tiles.

    Ray (i, j) passes (i + ((j % group) + 0.5) / group, j + ((i % group) + 0.5) / group): the rays of a group
    of ``group`` x ``group`` differ in both coordinates, so that a steep edge gets that many shades.
    """

    columns: int  # rays in a row
    rows: int
    group: int  # rays along each side of a pixel
    tile: int  # rays along each side of a tile
    tiles_across: int  # tiles in a row
    opaque: int  # triangles before this one are solid, the others have the texture's alpha
    cutoff: float  # where alpha is smaller the surface is not there
    any_hit: int  # 1: whether something is hit is enough; the nearest hit is not looked for


@wp.func
def sample_alpha(alpha: wp.array2d[float], at: wp.vec2) -> float:
    """The texture's alpha between its texel centres; the texture repeats."""
    rows = alpha.shape[0]
    columns = alpha.shape[1]
    x = (at[0] - wp.floor(at[0])) * float(columns) - 0.5
    y = (at[1] - wp.floor(at[1])) * float(rows) - 0.5
    left = wp.floor(x)
    upper = wp.floor(y)
    fx = x - left
    fy = y - upper
    i = (int(left) + columns) % columns
    j = (int(upper) + rows) % rows
    i_next = (i + 1) % columns
    j_next = (j + 1) % rows
    top = alpha[j, i] * (1.0 - fx) + alpha[j, i_next] * fx
    bottom = alpha[j_next, i] * (1.0 - fx) + alpha[j_next, i_next] * fx
    return top * (1.0 - fy) + bottom * fy


@wp.func
def minus_over(slope: float) -> float:
    """-1 over a weight's slope along x; 0 where it does not change."""
    over = float(0.0)
    if slope != 0.0:
        over = -1.0 / slope
    return over


@wp.func
def narrow(span: wp.vec2, over: float, rest: float) -> wp.vec2:
    """The part of a span of x where ``slope * x + rest`` is not negative, with ``over`` = -1 / slope."""
    border = over * rest
    if over < 0.0:
        span = wp.vec2(wp.max(span[0], border), span[1])
    if over > 0.0:
        span = wp.vec2(span[0], wp.min(span[1], border))
    return span


@wp.kernel
def cast_rays(
    # in:
    first: int,
    corner: wp.array[wp.vec3],  # (x, y) in rays, y downwards, and the nearness to the eye [m]
    uv: wp.array[wp.vec2],
    triangle: wp.array[wp.vec3i],  # indices into corner and uv
    alpha: wp.array2d[float],  # of the texture of the triangles from grid.opaque on
    tile_index: wp.array[int],  # the tile that a thread casts; its place in the grid
    tile_start: wp.array[int],  # its first entry in tile_triangle; one more than there are tiles
    tile_triangle: wp.array[int],
    grid: RayGrid,
    # out:
    hit_out: wp.array[int],  # preset to 0, a miss; else 1 + the triangle
    near_out: wp.array[float],  # nearness of the hit [m]; not touched when any hit is enough
):
    """Casts all rays of a tile at the triangles of its list; of two equally near ones the first counts."""
    i = first + wp.tid()
    place = tile_index[i]
    left = (place % grid.tiles_across) * grid.tile
    upper = (place // grid.tiles_across) * grid.tile
    right = wp.min(left + grid.tile, grid.columns)
    lower = wp.min(upper + grid.tile, grid.rows)
    share = 1.0 / float(grid.group)
    for entry in range(tile_start[i], tile_start[i + 1]):
        t = tile_triangle[entry]
        of = triangle[t]
        a = corner[of[0]]
        b = corner[of[1]] - a
        c = corner[of[2]] - a
        area = b[0] * c[1] - b[1] * c[0]
        if area != 0.0:
            # Barycentric weights of corners 1 and 2 grow linearly over the picture.
            over = 1.0 / area
            bx = c[1] * over
            by = -c[0] * over
            cx = -b[1] * over
            cy = b[0] * over
            b_over = minus_over(bx)
            c_over = minus_over(cx)
            a_over = minus_over(-bx - cx)
            least = wp.max(a[0] + wp.min(wp.min(b[0], c[0]), 0.0), float(left)) - a[0]
            most = wp.min(a[0] + wp.max(wp.max(b[0], c[0]), 0.0), float(right)) - a[0]
            above = wp.max(a[1] + wp.min(wp.min(b[1], c[1]), 0.0), float(upper))
            below = wp.min(a[1] + wp.max(wp.max(b[1], c[1]), 0.0), float(lower))
            # Rays keep half a share away from their row's borders.
            inset = 0.5 * share - SLACK
            row_from = wp.max(int(wp.ceil(above - 1.0 + inset)), upper)
            row_to = wp.min(int(wp.floor(below - inset)) + 1, lower)
            for row in range(row_from, row_to):
                # Where in the row rays can be inside: the three weights, each where in the row it is largest.
                start = float(row) - a[1]
                high = start + inset
                low = start + 1.0 - inset
                span = narrow(wp.vec2(least, most), b_over, wp.max(high * by, low * by))
                span = narrow(span, c_over, wp.max(high * cy, low * cy))
                span = narrow(span, a_over, 1.0 + wp.max(-high * (by + cy), -low * (by + cy)))
                shift = (float(row % grid.group) + 0.5) * share - a[0]
                column_from = wp.max(int(wp.ceil(wp.min(span[0], most) - shift - SLACK)), left)
                column_to = wp.min(int(wp.floor(wp.max(span[1], least) - shift + SLACK)) + 1, right)
                # A division for each ray would cost most of all.
                phase = column_from % grid.group
                for column in range(column_from, column_to):
                    x = float(column) + shift
                    y = start + (float(phase) + 0.5) * share
                    phase += 1
                    if phase == grid.group:
                        phase = 0
                    wb = x * bx + y * by
                    wc = x * cx + y * cy
                    if wb >= 0.0 and wc >= 0.0 and wb + wc <= 1.0:
                        ray = row * grid.columns + column
                        near = a[2] + wb * b[2] + wc * c[2]
                        open = hit_out[ray] == 0
                        if not open and grid.any_hit == 0:
                            open = near > near_out[ray]
                        if open:
                            solid = t < grid.opaque
                            if not solid:
                                ua = uv[of[0]]
                                at = ua + wb * (uv[of[1]] - ua) + wc * (uv[of[2]] - ua)
                                solid = sample_alpha(alpha, at) >= grid.cutoff
                            if solid:
                                hit_out[ray] = t + 1
                                if grid.any_hit == 0:
                                    near_out[ray] = near
