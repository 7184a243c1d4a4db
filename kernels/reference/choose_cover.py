"""The float64 twin of `flowtree.kernels.choose_cover`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Array = NDArray[Any]

PIXELS = 16.0


def row_of(table: Any, rows: int, view: int, thing: int, pose: int) -> int:
    """Number of a thing's row in a view."""
    return int(view * rows + thing * table.poses + pose)


def change_cover(table: Any, state: Any, row: int, sign: float) -> None:
    """Puts a thing onto a view, or takes it away with sign -1."""
    for entry in range(table.start[row], table.start[row + 1]):
        pixel, cell = table.pixel[entry], table.cell[entry]
        state.depth[pixel] += sign * np.float64(table.depth[entry])
        clear = np.exp(-state.depth[pixel])
        state.wrong[cell] += (clear - state.clear[pixel]) * table.known[cell] / PIXELS
        state.clear[pixel] = clear


def gain_of(table: Any, state: Any, row: int) -> float:
    """16 times what a thing would take from the squared error of a view's cells; notes what it shows."""
    part = slice(table.start[row], table.start[row + 1])
    seen = table.share[part] * state.clear[table.pixel[part]]
    state.shown[row] = seen.sum()
    useful = (seen * state.wrong[table.cell[part]]).sum()
    return float(2.0 * useful - table.focus[row] * state.shown[row] ** 2 / PIXELS)


def wish_for(table: Any, state: Any, row: int) -> None:
    """Adds what a thing would show to what all wished ones would."""
    for entry in range(table.start[row], table.start[row + 1]):
        seen = table.share[entry] * state.clear[table.pixel[entry]]
        state.together[table.cell[entry]] += seen / PIXELS


def room_for(table: Any, state: Any, row: int) -> float:
    """Share of the wishes that a view's cells have room for where a thing stands."""
    part = slice(table.start[row], table.start[row + 1])
    cell = table.cell[part]
    room = np.clip(state.wrong[cell] / np.maximum(state.together[cell], 1e-9), 0.0, 1.0)
    fits = (table.share[part] * state.clear[table.pixel[part]] * room).sum()
    return float(fits / max(state.shown[row], 1e-30))


def sweep_cover(
    first: int,
    table: Any,
    batch: _Array,
    luck: _Array,
    likely: _Array,
    least: float,
    state_out: Any,
    there_out: _Array,
    gain_out: _Array,
) -> None:
    """Takes one batch after the other away and puts back what lowers the error; there is one index."""
    rows, views = len(there_out), range(table.views)
    for number in range(first, len(batch) - 1):
        things = range(batch[number], batch[number + 1])

        def rows_of(thing: int) -> list[int]:
            return [row_of(table, rows, view, thing, 0) for view in views]

        for thing in things:
            if there_out[thing]:
                for row in rows_of(thing):
                    change_cover(table, state_out, row, -1.0)
        for thing in things:
            gain_out[thing] = sum(gain_of(table, state_out, row) for row in rows_of(thing))
        state_out.together[:] = 0.0
        better = [thing for thing in things if gain_out[thing] > least]
        for thing in better:
            for row in rows_of(thing):
                wish_for(table, state_out, row)
        there_out[list(things)] = 0
        for thing in better:
            room = sum(room_for(table, state_out, row) for row in rows_of(thing)) / table.views
            there_out[thing] = luck[thing] < room * likely[thing]
        for thing in better:
            if there_out[thing]:
                for row in rows_of(thing):
                    change_cover(table, state_out, row, 1.0)


def sweep_poses(
    first: int, table: Any, batch: _Array, contented: float, state_out: Any, pose_out: _Array
) -> None:
    """Takes one batch after the other away and puts each thing back in a good pose; there is one index."""
    rows, views = len(pose_out) * table.poses, range(table.views)
    for number in range(first, len(batch) - 1):
        things = range(batch[number], batch[number + 1])

        def rows_of(thing: int, pose: int) -> list[int]:
            return [row_of(table, rows, view, thing, pose) for view in views]

        for thing in things:
            if pose_out[thing] >= 0:
                for row in rows_of(thing, pose_out[thing]):
                    change_cover(table, state_out, row, -1.0)
        for thing in things:
            gains = [
                sum(gain_of(table, state_out, row) for row in rows_of(thing, pose))
                for pose in range(table.poses)
            ]
            best, now = int(np.argmax(gains)), gains[pose_out[thing]] if pose_out[thing] >= 0 else 0.0
            most = gains[best]
            if now < contented * most or (now < 0.0 and most <= 0.0):
                pose_out[thing] = best if most > 0.0 else -1
        for thing in things:
            if pose_out[thing] >= 0:
                for row in rows_of(thing, pose_out[thing]):
                    change_cover(table, state_out, row, 1.0)
