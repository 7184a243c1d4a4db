"""Densities whose sums along rays are given depths, many heights at once (Particle Flows, section 5)."""

import warp as wp

wp.set_module_options({"enable_backward": False})

#: Heights that one thread computes side by side: neighbours in memory, so that they fill vector registers and
#: an entry of the matrix is read once for all of them. 16 of them take twice as long.
LANES = 64

Lanes = wp.types.vector(length=LANES, dtype=wp.float32)

#: Largest logarithm by which densities are scaled at once: ratios beyond mean nothing and would overflow.
FARTHEST = wp.constant(20.0)


@wp.func
def sum_shares(
    low: int, high: int, column: wp.array[int], share: wp.array[float], block: int, values: wp.array2d[Lanes]
) -> Lanes:
    """A row of a sparse matrix, its entries from ``low`` on and before ``high``, times the block's values."""
    total = Lanes()
    for entry in range(low, high):
        total += share[entry] * values[block, column[entry]]
    return total


@wp.kernel
def sum_depths(
    # in:
    first: int,
    ray_start: wp.array[int],  # (rays + 1), of each ray's entries
    ray_voxel: wp.array[int],
    ray_share: wp.array[float],  # of the voxel's matter that the ray meets
    density: wp.array2d[Lanes],  # (blocks, voxels), depth of a voxel
    # out:
    depth_out: wp.array2d[Lanes],  # (blocks, rays)
):
    """Sums the densities along the rays; an index for each ray of each block of heights."""
    i = first + wp.tid()
    block = i // depth_out.shape[1]
    ray = i - block * depth_out.shape[1]
    depth_out[block, ray] = sum_shares(
        ray_start[ray], ray_start[ray + 1], ray_voxel, ray_share, block, density
    )


@wp.kernel
def start_density(
    # in:
    first: int,
    voxel_start: wp.array[int],  # (voxels * views + 1), of a voxel's entries in each view
    voxel_ray: wp.array[int],
    voxel_share: wp.array[float],
    depth: wp.array2d[Lanes],  # (blocks, rays)
    factor: wp.array2d[Lanes],  # (blocks, views), of a view's depths in the product
    least: float,  # depth that every view must show of a voxel that may be filled
    # out:
    filled_out: wp.array2d[Lanes],  # (blocks, voxels), 1 where a voxel may be filled, else 0
    density_out: wp.array2d[Lanes],  # (blocks, voxels)
):
    """The product of the depths that the views show of each voxel, 0 where one of them shows too little."""
    i = first + wp.tid()
    block = i // density_out.shape[1]
    voxel = i - block * density_out.shape[1]
    views = factor.shape[1]
    product = Lanes(1.0)
    fewest = Lanes(3.0e38)
    for view in range(views):
        row = voxel * views + view
        shown = sum_shares(voxel_start[row], voxel_start[row + 1], voxel_ray, voxel_share, block, depth)
        fewest = wp.min(fewest, shown)
        product = wp.cw_mul(product, wp.cw_mul(shown, factor[block, view]))
    filled = Lanes()
    for lane in range(LANES):
        if fewest[lane] >= least:
            filled[lane] = 1.0
    filled_out[block, voxel] = filled
    density_out[block, voxel] = wp.cw_mul(product, filled)


@wp.kernel
def shape_density(
    # in:
    first: int,
    place: wp.array[wp.vec2],  # (voxels), centre in the slice [voxels]
    axis_x: wp.array[Lanes],  # (blocks), where the slice's axis stands [voxels]
    axis_z: wp.array[Lanes],
    profile: wp.array2d[Lanes],  # (blocks, radii), depth of a voxel at 0.5, 1.5, … voxels from the axis
    filled: wp.array2d[Lanes],  # (blocks, voxels), 1 where a voxel may be filled, else 0
    # out:
    density_out: wp.array2d[Lanes],  # (blocks, voxels)
):
    """Round slices: what the profile says of each voxel's distance from the axis, linear in between."""
    i = first + wp.tid()
    block = i // density_out.shape[1]
    voxel = i - block * density_out.shape[1]
    last = profile.shape[1] - 2
    at_x, at_z = axis_x[block], axis_z[block]
    density = Lanes()
    for lane in range(LANES):
        x, z = place[voxel][0] - at_x[lane], place[voxel][1] - at_z[lane]
        radius = wp.clamp(wp.sqrt(x * x + z * z) - 0.5, 0.0, float(last + 1))
        ring = wp.min(int(radius), last)
        share = radius - float(ring)
        density[lane] = (1.0 - share) * profile[block, ring][lane] + share * profile[block, ring + 1][lane]
    density_out[block, voxel] = wp.cw_mul(density, filled[block, voxel])


@wp.kernel
def compare_depths(
    # in:
    first: int,
    depth: wp.array2d[Lanes],  # (blocks, rays), wanted
    known: wp.array2d[Lanes],  # (blocks, rays), 1 where a ray's depth is known, else 0
    sum_now: wp.array2d[Lanes],  # (blocks, rays)
    # out:
    log_ratio_out: wp.array2d[Lanes],  # (blocks, rays), of the wanted depth to the sum; 0 where not known
):
    """How many times too little the sums along the rays are, as a logarithm of at most `FARTHEST`."""
    i = first + wp.tid()
    block = i // depth.shape[1]
    ray = i - block * depth.shape[1]
    ratio = Lanes()
    for lane in range(LANES):
        if known[block, ray][lane] > 0.0 and sum_now[block, ray][lane] > 0.0:
            wanted = wp.max(depth[block, ray][lane], 1.0e-30)
            log_ratio = wp.log(wanted) - wp.log(sum_now[block, ray][lane])
            ratio[lane] = wp.clamp(log_ratio, -FARTHEST, FARTHEST)
    log_ratio_out[block, ray] = ratio


@wp.kernel
def scale_density(
    # in:
    first: int,
    voxel_start: wp.array[int],  # (voxels * views + 1), of a voxel's entries in each view
    voxel_ray: wp.array[int],
    voxel_share: wp.array[float],
    views: int,
    log_ratio: wp.array2d[Lanes],  # (blocks, rays)
    power: float,  # of the views' ratios
    # out:
    density_out: wp.array2d[Lanes],  # (blocks, voxels); preset to the densities of the round before
):
    """Multiplies the densities with a power of the product of the ratios that the views want."""
    i = first + wp.tid()
    block = i // density_out.shape[1]
    voxel = i - block * density_out.shape[1]
    more = sum_shares(
        voxel_start[voxel * views],
        voxel_start[(voxel + 1) * views],
        voxel_ray,
        voxel_share,
        block,
        log_ratio,
    )
    density = density_out[block, voxel]
    for lane in range(LANES):
        if density[lane] > 0.0:
            density[lane] = density[lane] * wp.exp(wp.clamp(power * more[lane], -FARTHEST, FARTHEST))
    density_out[block, voxel] = density


@wp.kernel
def pace_rows(
    # in:
    first: int,
    depth: wp.array2d[Lanes],  # (blocks, rays), wanted
    known: wp.array2d[Lanes],  # (blocks, rays), 1 where a ray's depth is known, else 0
    weight: wp.array2d[Lanes],  # (blocks, rays), of a ray's squared residual
    sum_now: wp.array2d[Lanes],  # (blocks, rays), of the last densities
    sum_before: wp.array2d[Lanes],  # (blocks, rays), of those before them
    # out:
    age_out: wp.array[Lanes],  # rounds since momentum began; 0 right after a step was taken back; preset to 1
    best_out: wp.array[Lanes],  # weighted squared residual of the best densities; preset to the largest float
    plain_out: wp.array[Lanes],  # squared residual of the last densities, not weighted
    momentum_out: wp.array[Lanes],  # share of the last change that is repeated; -1 takes it back
    residual_out: wp.array2d[Lanes],  # (blocks, rays), weighted, with the momentum in it
):
    """Nesterov's momentum for every height, begun anew where a step made the residual larger.

    Such a step is taken back: a momentum of -1 leads from the last densities to those before them.
    """
    block = first + wp.tid()
    rays = depth.shape[1]
    square = Lanes()
    plain = Lanes()
    for ray in range(rays):
        rest = wp.cw_mul(known[block, ray], depth[block, ray] - sum_now[block, ray])
        both = wp.cw_mul(rest, rest)
        plain += both
        square += wp.cw_mul(both, weight[block, ray])
    age = age_out[block]
    best = best_out[block]
    momentum = Lanes()
    for lane in range(LANES):
        if age[lane] == 0.0:  # the step after the one taken back has no momentum and is always right
            age[lane] = 1.0
            best[lane] = wp.min(best[lane], square[lane])
        elif square[lane] > best[lane]:
            age[lane] = 0.0
            momentum[lane] = -1.0
        else:
            older = 0.5 + wp.sqrt(0.25 + age[lane] * age[lane])
            momentum[lane] = (age[lane] - 1.0) / older
            age[lane] = older
            best[lane] = square[lane]
    for ray in range(rays):
        ahead = sum_now[block, ray] + wp.cw_mul(momentum, sum_now[block, ray] - sum_before[block, ray])
        rest = wp.cw_mul(known[block, ray], depth[block, ray] - ahead)
        residual_out[block, ray] = wp.cw_mul(rest, weight[block, ray])
    age_out[block] = age
    best_out[block] = best
    plain_out[block] = plain
    momentum_out[block] = momentum


@wp.kernel
def step_density(
    # in:
    first: int,
    voxel_start: wp.array[int],  # (voxels * views + 1), of a voxel's entries in each view
    voxel_ray: wp.array[int],
    voxel_share: wp.array[float],
    views: int,
    residual: wp.array2d[Lanes],  # (blocks, rays), weighted
    momentum: wp.array[Lanes],  # (blocks)
    filled: wp.array2d[Lanes],  # (blocks, voxels), 1 where a voxel may be filled, else 0
    density: wp.array2d[Lanes],  # (blocks, voxels)
    # out:
    density_out: wp.array2d[Lanes],  # (blocks, voxels); preset to the densities of the round before
):
    """Goes on as the last step did and spreads the rays' residuals; what is negative becomes 0."""
    i = first + wp.tid()
    block = i // density.shape[1]
    voxel = i - block * density.shape[1]
    more = sum_shares(
        voxel_start[voxel * views],
        voxel_start[(voxel + 1) * views],
        voxel_ray,
        voxel_share,
        block,
        residual,
    )
    now = density[block, voxel]
    now += wp.cw_mul(momentum[block], now - density_out[block, voxel]) + more / float(views)
    density_out[block, voxel] = wp.cw_mul(wp.max(now, Lanes()), filled[block, voxel])
