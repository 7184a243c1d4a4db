"""Frames that follow many curves without twisting around them."""

from __future__ import annotations

import numpy as np
import warp as wp
from numpy.typing import NDArray

from flowtree import device as devices
from flowtree.kernels import sweep_rings as kernels

Vectors = NDArray[np.float64]

# The side of a branch where its texture's seam lies: below, and for upright ones behind (away from the
# cameras at yaw 0 and 90).
_SEAM_SIDE = (-0.1, -1.0, -0.1)
_SPLIT_FROM = 512  # branches; most have few rings


def transport_frames(
    points: Vectors, tangents: Vectors, chain: NDArray[np.int64], *, device: str | None = None
) -> tuple[Vectors, Vectors]:
    """Rotation-minimising frames along many polylines at once.

    The double reflection of Wang, Jüttler, Zheng and Liu (2008, "Computation of Rotation Minimizing Frames")
    takes the frame of one point to the next, where rounding is kept from leaning it. Where two points are one
    or a curve turns right back there is no such rotation: the frame is set upright on the new tangent.

    Args:
        points: (k, 3) [m], the polylines one behind the other.
        tangents: (k, 3), unit.
        chain: (k,), which polyline a point belongs to, never falling.
        device: to run on; None takes the best there is.

    Returns: two (k, 3) arrays of unit vectors, right-handed with the tangent: first x second = tangent.
    """
    chosen = devices.pick_device(device)
    starts = np.append(np.flatnonzero(np.diff(chain, prepend=chain[:1] - 1)), len(chain)).astype(np.int32)
    inputs = [devices.upload(a.astype(np.float64), wp.vec3d, chosen) for a in (points, tangents)]
    inputs += [devices.upload(starts, wp.int32, chosen), wp.vec3d(*_SEAM_SIDE)]
    one, two = (devices.empty(len(chain), wp.vec3d, chosen) for _ in range(2))
    devices.launch(
        kernels.transport_frames,
        len(starts) - 1,
        inputs,
        [one, two],
        device=chosen,
        split_from=_SPLIT_FROM,
    )
    return one.numpy(), two.numpy()
