"""Batches of small things are taken away, weighed and put back where they better what views show."""

import warp as wp

wp.set_module_options({"enable_backward": False})

#: Pixels in a cell.
PIXELS = wp.constant(16.0)


@wp.struct
class CoverViews:
    """What things cover of the pixels of all views.

    The views' pixels stand one view after the other, and so do the cells; each view's last pixel and last
    cell lie beside its picture. The things stand in the order of their batches, and a thing's poses, if it
    has several, follow each other.
    """

    views: int
    poses: int
    start: wp.array[int]  # (views * rows + 1), of the entries of each row of each view
    pixel: wp.array[int]  # of an entry
    cell: wp.array[int]  # of that pixel
    share: wp.array[float]  # of the pixel that is covered
    depth: wp.array[float]  # the same as an optical depth
    focus: wp.array[float]  # (views * rows,) sum of squares of a row's shares of the cells
    known: wp.array[float]  # 0..1, how surely each cell's alpha is known


@wp.struct
class CoverState:
    """What the views show."""

    depth: wp.array[float]  # of all that is rendered, a pixel; endless beside the pictures
    clear: wp.array[float]  # its transparency
    wrong: wp.array[float]  # wanted alpha less the rendered one, a cell
    together: wp.array[float]  # alpha that all wished ones of a batch would show, a cell
    shown: wp.array[float]  # pixels that a thing of the batch would show, a row


@wp.func
def row_of(table: CoverViews, rows: int, view: int, thing: int, pose: int) -> int:
    """Number of a thing's row in a view."""
    return view * rows + thing * table.poses + pose


@wp.func
def change_cover(table: CoverViews, state: CoverState, row: int, sign: float):
    """Puts a thing onto a view, or takes it away with sign -1."""
    for entry in range(table.start[row], table.start[row + 1]):
        pixel = table.pixel[entry]
        cell = table.cell[entry]
        deep = state.depth[pixel] + sign * table.depth[entry]
        clear = wp.exp(-deep)
        change = (clear - state.clear[pixel]) * table.known[cell] / PIXELS
        state.wrong[cell] = state.wrong[cell] + change
        state.depth[pixel] = deep
        state.clear[pixel] = clear


@wp.func
def gain_of(table: CoverViews, state: CoverState, row: int) -> float:
    """16 times what a thing would take from the squared error of a view's cells; notes what it shows."""
    shown = float(0.0)
    useful = float(0.0)
    for entry in range(table.start[row], table.start[row + 1]):
        part = table.share[entry] * state.clear[table.pixel[entry]]
        shown += part
        useful += part * state.wrong[table.cell[entry]]
    state.shown[row] = shown
    return 2.0 * useful - table.focus[row] * shown * shown / PIXELS


@wp.func
def wish_for(table: CoverViews, state: CoverState, row: int):
    """Adds what a thing would show to what all wished ones would."""
    for entry in range(table.start[row], table.start[row + 1]):
        cell = table.cell[entry]
        part = table.share[entry] * state.clear[table.pixel[entry]]
        state.together[cell] = state.together[cell] + part / PIXELS


@wp.func
def room_for(table: CoverViews, state: CoverState, row: int) -> float:
    """Share of the wishes that a view's cells have room for where a thing stands."""
    fits = float(0.0)
    for entry in range(table.start[row], table.start[row + 1]):
        cell = table.cell[entry]
        room = wp.clamp(state.wrong[cell] / wp.max(state.together[cell], 1.0e-9), 0.0, 1.0)
        fits += table.share[entry] * state.clear[table.pixel[entry]] * room
    return fits / wp.max(state.shown[row], 1.0e-30)


@wp.kernel
def sweep_cover(
    # in:
    first: int,
    table: CoverViews,
    batch: wp.array[int],  # (batches + 1), where each begins
    luck: wp.array[float],  # (things,) 0..1
    likely: wp.array[float],  # (things,) factor to the probabilities
    least: float,  # gain that a thing must exceed
    # out:
    state_out: CoverState,  # as the last sweep left it
    there_out: wp.array[int],  # (things,) 1 for what is there, likewise
    gain_out: wp.array[float],  # (things,)
):
    """Takes one batch after the other away and puts back what lowers the error; there is one index."""
    rows = there_out.shape[0]
    for number in range(first + wp.tid(), batch.shape[0] - 1):
        low = batch[number]
        high = batch[number + 1]
        for thing in range(low, high):
            if there_out[thing] != 0:
                for view in range(table.views):
                    change_cover(table, state_out, row_of(table, rows, view, thing, 0), -1.0)
        for thing in range(low, high):
            gain = float(0.0)
            for view in range(table.views):
                gain += gain_of(table, state_out, row_of(table, rows, view, thing, 0))
            gain_out[thing] = gain
        for cell in range(table.known.shape[0]):
            state_out.together[cell] = 0.0
        for thing in range(low, high):
            if gain_out[thing] > least:
                for view in range(table.views):
                    wish_for(table, state_out, row_of(table, rows, view, thing, 0))
        for thing in range(low, high):
            there_out[thing] = 0
            if gain_out[thing] > least:
                room = float(0.0)
                for view in range(table.views):
                    room += room_for(table, state_out, row_of(table, rows, view, thing, 0))
                if luck[thing] < room / float(table.views) * likely[thing]:
                    there_out[thing] = 1
        for thing in range(low, high):
            if there_out[thing] != 0:
                for view in range(table.views):
                    change_cover(table, state_out, row_of(table, rows, view, thing, 0), 1.0)


@wp.kernel
def sweep_poses(
    # in:
    first: int,
    table: CoverViews,
    batch: wp.array[int],  # (batches + 1), where each begins
    contented: float,  # share of the best pose's gain with which a thing stays as it is
    # out:
    state_out: CoverState,  # as the last sweep left it
    pose_out: wp.array[int],  # (things,) -1 for what is not there, likewise
):
    """Takes one batch after the other away and puts each thing back in a good pose; there is one index."""
    rows = pose_out.shape[0] * table.poses
    for number in range(first + wp.tid(), batch.shape[0] - 1):
        low = batch[number]
        high = batch[number + 1]
        for thing in range(low, high):
            if pose_out[thing] >= 0:
                for view in range(table.views):
                    row = row_of(table, rows, view, thing, pose_out[thing])
                    change_cover(table, state_out, row, -1.0)
        for thing in range(low, high):
            best = int(-1)
            most = float(0.0)
            now = float(0.0)
            for pose in range(table.poses):
                gain = float(0.0)
                for view in range(table.views):
                    gain += gain_of(table, state_out, row_of(table, rows, view, thing, pose))
                if best < 0 or gain > most:
                    best = pose
                    most = gain
                if pose == pose_out[thing]:
                    now = gain
            if now < contented * most or (now < 0.0 and most <= 0.0):
                pose_out[thing] = wp.where(most > 0.0, best, -1)
        for thing in range(low, high):
            if pose_out[thing] >= 0:
                for view in range(table.views):
                    change_cover(table, state_out, row_of(table, rows, view, thing, pose_out[thing]), 1.0)
