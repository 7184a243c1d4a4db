"""How thick the limbs of a bare tree are for its trunk, read from the mattes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.branches.da_vinci_radii import da_vinci_radii
from flowtree.geometry.plane_grid import seen_depth
from flowtree.geometry.segment_depth import rods_depth
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.skeleton import Skeleton
from flowtree.params import ThicknessParams

_CELLS = 64  # along the height
_SHARE = 0.65  # of a bare tree's depth, what the traced branches give; the twigs give the rest
_LEAST, _MOST = 2.0, 2.7  # Da Vinci's, and a little more than the largest measured
_ROUNDS = 6  # of bisection: to a hundredth


def fit_exponent(
    skeleton: Skeleton,
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    *,
    trunk_radius: float | None = None,
    bounds: NDArray[np.float64] | None = None,
    params: ThicknessParams = ThicknessParams(),
) -> float:
    """The exponent of Da Vinci's rule with which the branches of a bare tree fill their share of the mattes.

    With the trunk's width given, a larger exponent makes limbs and twigs thicker. The paper has 2 throughout;
    measured on trees with known stems it lies between 2.0 and 2.6, and a bare tree shows nothing but wood.

    Args:
        skeleton: the branches, without twigs.
        mattes: one a view.
        cameras: theirs.
        trunk_radius: as for `da_vinci_radii` [m].
        bounds: as for `da_vinci_radii` [m].
        params: as for `da_vinci_radii`, but for the exponent.

    Returns: between 2 and 2.7.

    Raises:
        InputError: the skeleton has no height.
    """
    height = float(np.ptp(skeleton.points[:, 1]))
    check.require(height > 0, "skeleton", "must rise from its foot", "a height of 0", "trace more particles")
    seen = [seen_depth(m.alpha, c, cell=height / _CELLS) for m, c in zip(mattes, cameras, strict=True)]
    wanted = _SHARE * sum(float(depth.sum()) for _, depth in seen)
    low, high = _LEAST, _MOST
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        trial = params.model_copy(update={"exponent": middle})
        wood = da_vinci_radii(skeleton, trunk_radius=trunk_radius, bounds=bounds, params=trial)
        # A cell behind a limb is opaque once: more wood there does not count.
        given = sum(
            float(np.minimum(rods_depth(grid, wood.parent, wood.points, wood.radius), depth).sum())
            for grid, depth in seen
        )
        low, high = (middle, high) if given < wanted else (low, middle)
    return (low + high) / 2
