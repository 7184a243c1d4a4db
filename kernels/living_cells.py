"""Cells around the particles under way, whose size follows their density."""

import warp as wp

wp.set_module_options({"enable_backward": False})

# Cells in units of the mean spacing of the living: thin along x, where a row of cells is one range of the
# sorted list that is scanned sixteen at a time, and wide across, so that few rows have to be looked at.
THIN = wp.constant(0.6)
WIDE = wp.constant(2.2)


@wp.struct
class LivingCells:
    """A box of cells.

    corner: [m], of cell (0, 0, 0).
    per_metre: (3,) cells a metre along each axis.
    nx, ny, nz: cells along each axis; x runs fastest, so a row of cells is one range of the sorted list.
    """

    corner: wp.vec3
    per_metre: wp.vec3
    nx: int
    ny: int
    nz: int


@wp.func
def fit_cells(low: wp.vec3, high: wp.vec3, count: int, most: int):
    """The grid of at most ``most`` cells over a box of ``count`` particles: cells follow their density."""
    extent = high - low
    least = 1.0e-3 * wp.max(wp.max(extent), 1.0e-6)
    extent = wp.vec3(wp.max(extent[0], least), wp.max(extent[1], least), wp.max(extent[2], least))
    spacing = wp.pow(extent[0] * extent[1] * extent[2] / float(wp.max(count, 1)), 0.3333333)
    grid = LivingCells()
    grid.corner = low
    trying = bool(True)
    while trying:
        grid.nx = int(wp.min(extent[0] / (THIN * spacing), 1.0e3)) + 1
        grid.ny = int(wp.min(extent[1] / (WIDE * spacing), 1.0e3)) + 1
        grid.nz = int(wp.min(extent[2] / (WIDE * spacing), 1.0e3)) + 1
        spacing *= 1.25
        trying = float(grid.nx) * float(grid.ny) * float(grid.nz) > float(most)
    grid.per_metre = wp.vec3(
        float(grid.nx) / extent[0], float(grid.ny) / extent[1], float(grid.nz) / extent[2]
    )
    return grid


@wp.func
def cell_along(grid: LivingCells, axis: int, cells: int, at: float):
    """Cell coordinate along one axis; a point outside the box belongs to the nearest cell at its border."""
    place = (at - grid.corner[axis]) * grid.per_metre[axis]
    # Clamped before the conversion: what an integer cannot hold would come out anywhere.
    return int(wp.min(wp.max(place, 0.0), float(cells - 1)))


@wp.func
def cell_of(grid: LivingCells, at: wp.vec3):
    """Number of the cell that a point lies in."""
    x = cell_along(grid, 0, grid.nx, at[0])
    y = cell_along(grid, 1, grid.ny, at[1])
    z = cell_along(grid, 2, grid.nz, at[2])
    return x + grid.nx * (y + grid.ny * z)


@wp.struct
class CellBox:
    """The cells from left to right, from low to high and from back to front, all of them inside."""

    left: int
    right: int
    low: int
    high: int
    back: int
    front: int


@wp.func
def cells_around(grid: LivingCells, at: wp.vec3, reach: float):
    """The cells that a cube of twice the reach touches."""
    box = CellBox()
    box.left = cell_along(grid, 0, grid.nx, at[0] - reach)
    box.right = cell_along(grid, 0, grid.nx, at[0] + reach)
    box.low = cell_along(grid, 1, grid.ny, at[1] - reach)
    box.high = cell_along(grid, 1, grid.ny, at[1] + reach)
    box.back = cell_along(grid, 2, grid.nz, at[2] - reach)
    box.front = cell_along(grid, 2, grid.nz, at[2] + reach)
    return box


@wp.func
def share_of(count: int, rank: int, ranks: int):
    """Where a thread's share of ``count`` begins; the next one's beginning is its end."""
    return int(wp.int64(count) * wp.int64(rank) / wp.int64(ranks))
