"""What a path pays for being where a habit does not have branches."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.attraction.cut_working_grid import WorkingGrid
from flowtree.attraction.outline_crown import CrownOutline
from flowtree.model.attractor import Habit

_BESIDE = 0.04  # of the height: how far from a conifer's leader a path pays in full
_LEADER = 3.0  # what it pays there, beside the price of the place
_HANGING = 5.0  # likewise, of a weeping crown's path far below the crown's top
_FALL = 0.25  # of the height: what is far below
_STEM = 0.03  # of the height: how far around the stem a weeping crown's paths may go down freely

_Map = NDArray[np.float64]


def weigh_habit(grid: WorkingGrid, crown: CrownOutline, habit: Habit, foot: float) -> _Map:
    """A factor (h, w), >= 1, to the cost of a path.

    A conifer's leader stands straight over its foot: cells beside that line are dear, so that branches come
    to it level instead of slanting down. A weeping crown's branches climb along its top and hang from there:
    a path that begins at a hanging end goes up first, for below the crown's top cells are dear, but for the
    stem's.

    Args:
        grid: the working picture.
        crown: its filled shape.
        habit: others than those two cost nothing.
        foot: its column [cells].
    """
    rows, columns = np.indices(crown.shape.shape, dtype=np.float64)
    if habit == "conifer":
        top = np.flatnonzero(crown.shape.any(axis=1))
        tip = float(np.flatnonzero(crown.shape[top[0]]).mean()) if len(top) else foot
        reach = max(crown.foot - (top[0] if len(top) else 0), 1)
        line = foot + (tip - foot) * np.clip((crown.foot - rows) / reach, 0.0, 1.0)
        aside = np.clip(np.abs(columns - line) / (_BESIDE * grid.tall), 0.0, 1.0)
        return np.asarray(1.0 + _LEADER * aside)
    if habit == "weeping":
        first = np.where(crown.shape.any(axis=0), crown.shape.argmax(axis=0), crown.foot)
        below = np.clip((rows - first[None, :]) / (_FALL * grid.tall), 0.0, 1.0)
        aside = np.clip(np.abs(columns - foot) / (_STEM * grid.tall) - 1.0, 0.0, 1.0)
        return np.asarray(1.0 + _HANGING * below * aside)
    return np.ones(crown.shape.shape)
