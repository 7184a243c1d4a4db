"""A sorted cell list: which particles lie in which cell of a box."""

import warp as wp

wp.set_module_options({"enable_backward": False})


@wp.struct
class CellGrid:
    """A box of cubic cells.

    corner: [m], of cell (0, 0, 0).
    edge: of a cell [m].
    nx, ny, nz: cells along each axis; x runs fastest, so a row of cells is one range of the sorted list.
    """

    corner: wp.vec3
    edge: float
    nx: int
    ny: int
    nz: int


@wp.func
def cell_of(grid: CellGrid, at: wp.vec3):
    """Cell coordinates; a point outside the box belongs to the nearest cell at its border."""
    place = (at - grid.corner) / grid.edge
    # Clamped before the conversion: what an integer cannot hold would come out anywhere.
    return wp.vec3i(
        int(wp.clamp(wp.floor(place[0]), 0.0, float(grid.nx - 1))),
        int(wp.clamp(wp.floor(place[1]), 0.0, float(grid.ny - 1))),
        int(wp.clamp(wp.floor(place[2]), 0.0, float(grid.nz - 1))),
    )


@wp.kernel
def assign_cells(
    # in:
    first: int,
    position: wp.array[wp.vec3],  # [m]
    state: wp.array[int],  # 1 is moving, everything else takes no part
    grid: CellGrid,
    # out:
    key_out: wp.array[int],
    index_out: wp.array[int],
):
    """Gives every particle its cell as a sort key; those that take no part sort behind the last cell."""
    i = first + wp.tid()
    index_out[i] = i
    cell = cell_of(grid, position[i])
    key = cell[0] + grid.nx * (cell[1] + grid.ny * cell[2])
    key_out[i] = wp.where(state[i] == 1, key, grid.nx * grid.ny * grid.nz)


@wp.kernel
def bound_cells(
    # in:
    first: int,
    key: wp.array[int],  # sorted
    count: int,
    cells: int,
    # out:
    begin_out: wp.array[int],  # (cells + 1,), where each cell begins in the sorted list
):
    """Index i of ``count + 1`` writes the beginnings of the cells after the last key up to its own."""
    i = first + wp.tid()
    low = int(0)
    if i > 0:
        low = key[i - 1] + 1
    high = cells
    if i < count:
        high = wp.min(key[i], cells)
    for cell in range(low, high + 1):
        begin_out[cell] = i
