"""What a volume and direction fields must be for particles to flow through them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flowtree import check
from flowtree.model.field import DirectionField
from flowtree.model.volume import DensityVolume


def check_volume(volume: DensityVolume) -> None:
    """Refuses a volume in which no particle could start.

    Raises:
        InputError: density that is not finite, negative or zero everywhere, an edge that is not positive.
    """
    density = check.array(volume.density, "volume.density", shape=(None, None, None), low=0.0)
    check.array(volume.origin, "volume.origin", shape=(3,))
    edge = float(volume.voxel)
    check.require(
        bool(np.isfinite(edge)) and edge > 0,
        "volume.voxel",
        "must be a length",
        edge,
        "give the edge in metres",
    )
    check.require(bool(density.any()), "volume", "must hold density", "an empty one", "check the mattes")


def check_fields(fields: Sequence[DirectionField]) -> None:
    """Refuses fields that cannot be sampled together.

    Raises:
        InputError: no field, fields of different resolution or of less than 2 x 2 cells, vectors that are not
            finite or longer than 1, a cell without size.
    """
    check.require(
        len(fields) > 0, "fields", "must be one a view", "none", "build a direction field for each view"
    )
    shapes = {field.vectors.shape for field in fields}
    check.require(len(shapes) == 1, "fields", "must share one resolution", sorted(shapes), "build them alike")
    for k, field in enumerate(fields):
        thing = f"field of view {k}"
        vectors = check.array(field.vectors, thing, shape=(None, None, 2), low=-1.001, high=1.001)
        size = min(vectors.shape[:2])
        check.require(size >= 2, thing, "must have at least 2 x 2 cells", size, "raise field.resolution")
        check.array(field.origin, f"origin of the {thing}", shape=(2,))
        cell = check.array(field.cell, f"cell of the {thing}", shape=(2,))
        check.require(
            bool((cell > 0).all()), f"cell of the {thing}", "must be positive", cell, "give its size"
        )
        check.array(field.yaw, f"yaw of the {thing}", shape=())
