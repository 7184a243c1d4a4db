"""Colours of a region around every pixel, as one Gaussian each."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

_REACHES = (0.05, 0.18)  # of the larger side; the wider one speaks where the nearer one found nothing
_WIDE, _WHOLE = 0.02, 0.001  # weights of the wider window and of the whole picture beside the near window
_COARSE = 4  # the moments vary slowly: they are summed on a picture this much smaller
_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))


@dataclass(frozen=True)
class LocalGaussian:
    """What a region looks like near every pixel.

    Attributes:
        mean: (h, w, 3) float32, CIELAB.
        covariance: (h, w, 3, 3) float32.
    """

    mean: NDArray[np.float32]
    covariance: NDArray[np.float32]

    def floored(self, floor: float) -> NDArray[np.float32]:
        """The covariance with a noise of standard deviation ``floor`` added to every channel."""
        return self.covariance + np.float32(floor**2) * np.eye(3, dtype=np.float32)

    def distance(self, lab: NDArray[np.float32], floor: float) -> NDArray[np.float32]:
        """Mahalanobis distances (h, w) of the pixels (h, w, 3)."""
        xx, yx, zx, yy, zy, zz = self._cholesky(floor)
        away = lab - self.mean
        first = away[..., 0] / xx
        second = (away[..., 1] - yx * first) / yy
        third = (away[..., 2] - zx * first - zy * second) / zz
        distance: NDArray[np.float32] = np.sqrt(first**2 + second**2 + third**2)
        return distance

    def log_determinant(self, floor: float) -> NDArray[np.float32]:
        """Logarithm of the covariance's determinant (h, w)."""
        xx, _, _, yy, _, zz = self._cholesky(floor)
        logarithm: NDArray[np.float32] = 2.0 * np.log(xx * yy * zz)
        return logarithm

    def _cholesky(self, floor: float) -> tuple[NDArray[np.float32], ...]:
        """The lower triangle of the floored covariance's root; written out it is faster than LAPACK."""
        noise = np.float32(floor**2)
        cov = self.covariance
        xx = np.sqrt(np.maximum(cov[..., 0, 0] + noise, noise))
        yx, zx = cov[..., 1, 0] / xx, cov[..., 2, 0] / xx
        # Rounding must not take the root of less than the noise.
        yy = np.sqrt(np.maximum(cov[..., 1, 1] + noise - yx**2, noise))
        zy = (cov[..., 2, 1] - zx * yx) / yy
        zz = np.sqrt(np.maximum(cov[..., 2, 2] + noise - zx**2 - zy**2, noise))
        return xx, yx, zx, yy, zy, zz


def fit_local_gaussian(lab: NDArray[np.float32], weight: NDArray[np.float32]) -> LocalGaussian:
    """Weighted mean and covariance of the colours in a window around every pixel.

    Two windows and the whole picture are added with falling weights, so that the nearest colours count where
    there are any, and no pixel is left without. With no weight anywhere the whole picture's colours result.

    Args:
        lab: (h, w, 3) float32 CIELAB.
        weight: (h, w) >= 0, how much a pixel belongs to the region.
    """
    height, width = weight.shape
    centre = lab.reshape(-1, 3).mean(axis=0)
    shifted = lab - centre
    weight = weight.astype(np.float32) + np.float32(1e-7)
    products = [weight, *(weight * shifted[..., k] for k in range(3))]
    products += [weight * shifted[..., i] * shifted[..., j] for i, j in _PAIRS]
    small = (max(1, width // _COARSE), max(1, height // _COARSE))
    sums = []
    for product in products:
        coarse = cv2.resize(product, small, interpolation=cv2.INTER_AREA)
        total = np.full_like(coarse, _WHOLE * float(coarse.mean()))
        for share, reach in zip((1.0, _WIDE), _REACHES, strict=True):
            total += share * cv2.GaussianBlur(
                coarse, (0, 0), reach * max(small) + 0.5, borderType=cv2.BORDER_REFLECT
            )
        sums.append(total)
    mass = np.maximum(sums[0], 1e-12)
    means = [sums[1 + k] / mass for k in range(3)]
    covariance = np.empty((height, width, 3, 3), np.float32)
    for (i, j), moment in zip(_PAIRS, sums[4:], strict=True):
        field = moment / mass - means[i] * means[j]
        covariance[..., i, j] = covariance[..., j, i] = cv2.resize(field, (width, height))
    mean = np.stack([cv2.resize(field, (width, height)) for field in means], axis=2) + centre
    return LocalGaussian(mean.astype(np.float32), covariance)
