"""The nearest neighbour of every moving particle, and the limb it has run into (section 6)."""

import warp as wp

from flowtree.kernels.cell_list import CellGrid, cell_of

wp.set_module_options({"enable_backward": False})


@wp.kernel
def find_nearest(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m]
    mass: wp.array[float],  # particles combined
    state: wp.array[int],  # 1 is moving
    index: wp.array[int],  # particles, sorted by cell
    begin: wp.array[int],  # where each cell begins in it
    grid: CellGrid,  # cells at least as wide as the radius
    radius: float,  # [m]
    reach: float,  # [m], threshold of two single particles
    growth: float,  # [m], what the square root of the joint mass adds to it
    # out:
    nearest_out: wp.array[int],  # -1 where nobody is within the radius
    host_out: wp.array[int],  # -1 where no heavier one is within the threshold
):
    """Scans the three rows by three of cells around; of equally near neighbours the lowest index counts.

    The host is one that is heavier (of equal mass: of lower index) and so near that the two may join; of
    several the one whose threshold the particle has gone past farthest. It need not have the particle for its
    own nearest, as pairs would: a trunk takes in at once all that have come so near.
    """
    i = first + wp.tid()
    nearest = int(-1)
    host = int(-1)
    if state[i] == 1:
        at = position[i]
        best = radius * radius
        deepest = float(1.0)
        cell = cell_of(grid, at)
        left = wp.max(cell[0] - 1, 0)
        right = wp.min(cell[0] + 1, grid.nx - 1)
        for z in range(wp.max(cell[2] - 1, 0), wp.min(cell[2] + 2, grid.nz)):
            for y in range(wp.max(cell[1] - 1, 0), wp.min(cell[1] + 2, grid.ny)):
                row = grid.nx * (y + grid.ny * z)
                for k in range(begin[row + left], begin[row + right + 1]):
                    j = index[k]
                    if j != i:
                        square = wp.length_sq(position[j] - at)
                        if square < best or (square == best and (nearest < 0 or j < nearest)):
                            best = square
                            nearest = j
                        heavier = mass[j] > mass[i] or (mass[j] == mass[i] and j < i)
                        threshold = wp.min(reach + growth * (wp.sqrt(mass[i] + mass[j]) - 1.0), radius)
                        share = square / (threshold * threshold)
                        if heavier and (share < deepest or (share == deepest and (host < 0 or j < host))):
                            deepest = share
                            host = j
    nearest_out[i] = nearest
    host_out[i] = host
