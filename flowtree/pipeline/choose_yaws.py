"""Which way each photograph looks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowtree import check

# Closer than this two views show the same [degrees].
_LEAST_TURN = 1.0


def choose_yaws(count: int, yaws: Sequence[float] | None = None) -> tuple[float, ...]:
    """A yaw for each view [degrees]: the given ones, else spread evenly over half a turn (0 and 90 for two).

    A lone photo's second view is its mirror image from 90 degrees further round.

    Args:
        count: photos.
        yaws: one a photo, or None.

    Returns: one yaw a view; at least two.

    Raises:
        InputError: no photo, another number of yaws than of photos, a yaw that is no finite number, two equal
            ones, or only views from one side and its opposite, which show the same outline.
    """
    check.require(count > 0, "photos", "must be at least one", "none", "name a photo of the tree")
    views = max(count, 2)
    if yaws is None:
        return tuple(180.0 * k / views for k in range(views))
    remedy = f"give {count}, such as {','.join(f'{180 * k / views:g}' for k in range(count))}"
    check.require(len(yaws) == count, "yaw", f"must be given once a photo ({count})", len(yaws), remedy)
    wanted = check.array(yaws, "yaw", shape=(count,), dtype=np.float64, low=-3600.0, high=3600.0)
    turns = [float(yaw) for yaw in wanted]
    if count == 1:
        return (turns[0], turns[0] + 90.0)
    for k, turn in enumerate(turns):
        for other in turns[:k]:
            check.require(
                _between(turn, other, 360.0) >= _LEAST_TURN,
                "yaw",
                "must differ from photo to photo",
                f"{other:g} and {turn:g}",
                "say from where each photo was taken, or leave --yaw out",
            )
    sideways = any(_between(turn, turns[0], 180.0) >= _LEAST_TURN for turn in turns)
    got = " and ".join(f"{turn:g}" for turn in turns)
    remedy = "add a photo from the side, or use one of the two alone"
    check.require(sideways, "yaw", "must not all be from one side and its opposite", got, remedy)
    return tuple(turns)


def _between(a: float, b: float, period: float) -> float:
    """The angle between two yaws that repeat after ``period`` [degrees]."""
    gap = abs(a - b) % period
    return min(gap, period - gap)
