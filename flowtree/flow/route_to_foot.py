"""The pull to the basis: the shortest way to the foot through the tree (Particle Flows, section 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter, map_coordinates
from skimage.graph import MCP_Geometric

from flowtree.model.field import LimbField
from flowtree.model.volume import DensityVolume

_POINTS = 32  # along the height: finer than this the way does not change, and the search costs its cube
_AIR = 0.1  # of the usual density: less is air
_EMPTY = 5.0  # a metre of air costs as much as this many metres of crown


def route_to_foot(
    volume: DensityVolume, limbs: LimbField | None = None
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """Directions along the shortest way to the foot, where way through air is dear.

    The paper pulls particles straight to the basis. That leads those under a hanging crown through the air to
    the ground; the way through the density leads them up the branch and down the trunk, as sap would go. In
    the air below a crown, where the photos show no branch, this way alone is followed.

    Around limbs the way is the limbs' own, and it alone is followed.

    Args:
        volume: the density.
        limbs: the field around the limbs in space; None for none.

    Returns:
        directions: (nx, ny, nz, 3) float32, at the points of a box one spacing wider than the volume; of
            length 1 in the crown, up to 2 in the air and around limbs, 0 where there is no way to go.
        corner: (3,) float32 [m], point (0, 0, 0).
        spacing: of the points [m].
    """
    shape = np.array(volume.density.shape)
    stride = max(1.0, shape[1] / _POINTS, shape.max() / (3 * _POINTS))
    spacing = stride * float(volume.voxel)
    corner = volume.origin - 0.5 * spacing
    # The border of one point more lets gradients be taken everywhere.
    axes = [(np.arange(int(np.ceil(n / stride)) + 2) - 0.5) * stride - 0.5 for n in shape]
    density = volume.density.astype(np.float64)
    coarse = map_coordinates(density, np.meshgrid(*axes, indexing="ij"), order=1, mode="nearest")
    coarse = gaussian_filter(coarse, 0.7)
    solid = coarse[coarse > 0]
    usual = float(np.quantile(solid, 0.5)) if len(solid) else 1.0
    cost = 1.0 + (_EMPTY - 1.0) * (1.0 - np.minimum(coarse / usual, 1.0))
    foot = tuple(int(k) for k in np.clip(np.round(-corner / spacing), 0, np.array(coarse.shape) - 1))
    way, _ = MCP_Geometric(cost).find_costs([foot])
    slope = np.stack(np.gradient(gaussian_filter(way, 0.7)), axis=-1)
    length = np.linalg.norm(slope, axis=-1, keepdims=True)
    directions = np.divide(-slope, length, out=np.zeros_like(slope), where=length > 1e-9)
    directions *= 1.0 + np.clip(1.0 - coarse / (_AIR * usual), 0.0, 1.0)[..., None]
    if limbs is not None:
        return _lay_over(limbs, directions, corner, spacing)
    return directions.astype(np.float32), corner.astype(np.float32), spacing


def _lay_over(
    limbs: LimbField, directions: NDArray[np.float64], corner: NDArray[np.float64], spacing: float
) -> tuple[NDArray[np.float32], NDArray[np.float32], float]:
    """The route at the points of the limbs' field, which goes before it as far as it is sure."""
    axes = [
        (limbs.corner[k] + np.arange(limbs.vectors.shape[k]) * limbs.spacing - corner[k]) / spacing
        for k in range(3)
    ]
    places = np.meshgrid(*axes, indexing="ij")
    route = np.stack(
        [map_coordinates(directions[..., k], places, order=1, mode="nearest") for k in range(3)], axis=-1
    )
    sure = np.linalg.norm(limbs.vectors, axis=-1, keepdims=True)
    length = np.linalg.norm(route, axis=-1, keepdims=True)
    way = limbs.vectors + (1.0 - sure) * route / np.maximum(length, 1e-9)
    size = np.linalg.norm(way, axis=-1, keepdims=True)
    way = np.divide(way, size, out=np.zeros_like(way), where=size > 1e-9)
    way *= np.maximum(np.minimum(length, 2.0), 1.0 + sure)
    return way.astype(np.float32), limbs.corner.astype(np.float32), limbs.spacing
