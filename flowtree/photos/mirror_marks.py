"""The marks of a photograph's mirror image."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flowtree.model.marks import ViewMarks


def mirror_marks(marks: ViewMarks, width: int) -> ViewMarks:
    """The marks with left and right exchanged in a picture ``width`` [working pixels] wide."""
    return replace(
        marks,
        foot=None if marks.foot is None else (width - marks.foot[0], marks.foot[1]),
        fork=None if marks.fork is None else (width - marks.fork[0], marks.fork[1]),
        seeds=np.stack([np.float32(width) - marks.seeds[:, 0], marks.seeds[:, 1]], axis=1),
        roll=None if marks.roll is None else -marks.roll,
    )
