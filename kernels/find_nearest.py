"""The nearest neighbour of every moving particle (Particle Flows, section 6)."""

import warp as wp

from flowtree.kernels.cell_list import CellGrid, cell_of

wp.set_module_options({"enable_backward": False})


@wp.kernel
def find_nearest(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m]
    state: wp.array[int],
    index: wp.array[int],  # particles, sorted by cell
    begin: wp.array[int],  # where each cell begins in it
    grid: CellGrid,  # cells at least as wide as the radius
    radius: float,  # [m]
    # out:
    nearest_out: wp.array[int],  # -1 where nobody is within the radius
):
    """Scans the three rows by three of cells around; of equally near neighbours the lowest index counts."""
    i = first + wp.tid()
    nearest = int(-1)
    if state[i] == 1:
        at = position[i]
        best = radius * radius
        cell = cell_of(grid, at)
        left = wp.max(cell[0] - 1, 0)
        right = wp.min(cell[0] + 1, grid.nx - 1)
        for z in range(wp.max(cell[2] - 1, 0), wp.min(cell[2] + 2, grid.nz)):
            for y in range(wp.max(cell[1] - 1, 0), wp.min(cell[1] + 2, grid.ny)):
                row = grid.nx * (y + grid.ny * z)
                for k in range(begin[row + left], begin[row + right + 1]):
                    j = index[k]
                    if j != i:
                        distance = wp.length_sq(position[j] - at)
                        if distance < best or (distance == best and (nearest < 0 or j < nearest)):
                            best = distance
                            nearest = j
    nearest_out[i] = nearest
