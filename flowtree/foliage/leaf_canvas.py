"""A canvas in leaf coordinates: blades, stalks and needles are stamped onto it one over the other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt, gaussian_filter

from flowtree.geometry.srgb import encode_srgb

Floats = NDArray[np.float64]

_FINER = 3  # samples along each side of a pixel while painting


class LeafCanvas:
    """Coverage and relative colour of a leaf, its stalk's end at the bottom's centre, 1 high.

    Attributes:
        cover: (h, w) float64 in 0..1.
        color: (h, w, 3) float64, linear, relative to the leaf's mean.
    """

    def __init__(self, rng: np.random.Generator, width: float, pixels: int) -> None:
        """An empty canvas.

        Args:
            rng: of the mottling.
            width: of the canvas, in heights.
            pixels: height of the finished picture.
        """
        rows = pixels * _FINER
        columns = 8 * max(1, round(pixels * width / 8)) * _FINER
        self._pitch = width / columns
        self._x = (np.arange(columns) + 0.5) * self._pitch - width / 2
        self._y = 1.0 - (np.arange(rows) + 0.5) / rows
        self.cover = np.zeros((rows, columns))
        self.color = np.ones((rows, columns, 3))
        noise = rng.standard_normal((2, rows // 8, columns // 8))
        smooth = [gaussian_filter(part, 6.0 * pixels / 256, mode="wrap") for part in noise]
        self._mottling = [np.kron(part / max(part.std(), 1e-12), np.ones((8, 8))) for part in smooth]

    def blade(
        self,
        root: tuple[float, float],
        angle: float,
        length: float,
        *,
        slender: float,
        base: float = 0.75,
        tip: float = 1.1,
        veins: int = 9,
        teeth: float = 0.0,
        fan: int = 0,
        tint: tuple[float, float, float] = (1.0, 1.0, 1.0),
    ) -> None:
        """Stamps a leaf blade or a petal.

        Args:
            root: (x, y) where it begins.
            angle: from straight up, clockwise [radians].
            length: from root to tip.
            slender: half its largest width, in lengths.
            base: how it widens from its root: below 1 round, above 1 drawn out; with ``tip`` it says where
                the blade is widest.
            tip: the same at its end.
            veins: on each side of the midrib; 0 for none.
            teeth: depth of its serration, as a share of its width; the teeth lie between the veins' ends.
            fan: veins that run from the root like a fan's, as in petals; 0 for none, and then a midrib.
            tint: relative linear colour.
        """
        window, along, aside = self._local(root, angle, length, slender * length * (1.0 + teeth))
        t = np.clip(along / length, 0.0, 1.0)
        peak = base / (base + tip)
        outline = slender * length * (t / peak) ** base * ((1.0 - t) / (1.0 - peak)) ** tip
        # Veins leave the midrib forward and bend to the tip; teeth point where they end.
        across = np.clip(np.abs(aside) / np.maximum(outline, 1e-6), 0.0, 1.3)
        ahead = t - 1.1 * slender * across**1.2 * (1.0 - 0.5 * t)
        saw = np.mod(2.0 * max(veins, 6) * ahead, 1.0) - 0.5
        outline *= 1.0 + teeth * np.clip(5.0 * t - 0.3, 0.0, 1.0) * saw
        inside = np.clip((outline - np.abs(aside)) / self._pitch + 0.5, 0.0, 1.0) * (
            (along > 0) & (along < length)
        )
        there = inside > 0.0
        t, aside, outline, ahead = t[there], aside[there], outline[there], ahead[there]
        across = np.clip(np.abs(aside) / np.maximum(outline, 1e-6), 0.0, 1.0)
        light = 1.0 + 0.06 * self._mottling[0][window][there] - 0.16 * across**4
        # Halves are lit differently by the fold, which a few triangles show too weakly.
        light += np.where(aside > 0, 0.05, -0.05) * (fan == 0)
        warmth = 0.07 * self._mottling[1][window][there] + 0.06 * across**3
        if veins:
            wave = np.mod(veins * ahead, 1.0) - 0.5
            thin = np.exp(-((wave / 0.055) ** 2)) * (1.0 - across) ** 0.4
            # Between two veins the blade is vaulted: one side of the vault is lit.
            light += 0.30 * thin - 0.11 * np.cos(2.0 * np.pi * wave) + 0.05 * np.sin(2.0 * np.pi * wave)
            light += 0.025 * np.cos(2.0 * np.pi * 5.0 * veins * across * slender) * (1.0 - thin)
            warmth += 0.07 * thin
        if fan:
            spread = np.cos(2.0 * np.pi * fan * np.arctan2(aside, (t + 0.15) * length))
            light += 0.045 * spread * (0.3 + t) - 0.10 * np.exp(-((t / 0.22) ** 2))
            warmth += 0.10 * np.exp(-((t / 0.35) ** 2)) + 0.05 * across**2
        else:
            rib = np.exp(-((aside / (0.013 * length * (1.2 - t))) ** 2))
            light += 0.34 * rib
            warmth += 0.10 * rib
        self._over(window, there, inside[there], light, warmth, tint)

    def stroke(
        self,
        start: tuple[float, float],
        angle: float,
        length: float,
        thick: tuple[float, float],
        *,
        tint: tuple[float, float, float] = (1.0, 1.0, 1.0),
    ) -> None:
        """Stamps a stalk or needle, ``thick`` wide at its start and its end, round across."""
        window, along, aside = self._local(start, angle, length, max(thick))
        t = np.clip(along / length, 0.0, 1.0)
        half = 0.5 * (thick[0] + (thick[1] - thick[0]) * t)
        away = np.hypot(aside, np.maximum(np.maximum(-along, along - length), 0.0))
        inside = np.clip((half - away) / self._pitch + 0.5, 0.0, 1.0)
        there = inside > 0.0
        t, off = t[there], aside[there] / np.maximum(half[there], 1e-6)
        light = 0.8 + 0.35 * np.sqrt(np.clip(1.0 - off**2, 0.0, 1.0)) + 0.15 * t
        self._over(window, there, inside[there], light, np.zeros_like(light), tint)

    def finish(self, mean: Floats, cutoff: float) -> NDArray[np.uint8]:
        """The picture (h, w, 4) uint8 sRGB, smaller by the finer samples, its colours settled by `settle`."""
        rows, columns = (n // _FINER for n in self.cover.shape)
        blocks = (rows, _FINER, columns, _FINER)
        cover = self.cover.reshape(blocks).mean(axis=(1, 3))
        premultiplied = (self.color * self.cover[:, :, None]).reshape(*blocks, 3).mean(axis=(1, 3))
        color = premultiplied / np.maximum(cover, 1e-6)[:, :, None]
        return settle(color, cover, mean, cutoff)

    def _local(
        self, root: tuple[float, float], angle: float, length: float, half: float
    ) -> tuple[tuple[slice, slice], Floats, Floats]:
        """The window that a stamp can reach, and its pixels' coordinates along and aside of the stamp."""
        sine, cosine = np.sin(angle), np.cos(angle)
        reach_x = sorted((root[0], root[0] + sine * length))
        reach_y = sorted((root[1], root[1] + cosine * length))
        margin = half + 3.0 * self._pitch
        left, right = np.searchsorted(self._x, (reach_x[0] - margin, reach_x[1] + margin))
        low, high = np.searchsorted(-self._y, (-reach_y[1] - margin, -reach_y[0] + margin))
        window = (slice(int(low), int(high)), slice(int(left), int(right)))
        x = self._x[window[1]][None, :] - root[0]
        y = self._y[window[0]][:, None] - root[1]
        return window, x * sine + y * cosine, x * cosine - y * sine

    def _over(
        self,
        window: tuple[slice, slice],
        there: NDArray[np.bool_],
        inside: Floats,
        light: Floats,
        warmth: Floats,
        tint: tuple[float, float, float],
    ) -> None:
        """Lays a stamp over what is there.

        Args:
            window: that holds the stamp.
            there: (h, w) of the window, its m pixels that the stamp covers; the rest stays as it is.
            inside: (m,) > 0, how much of each pixel it covers.
            light: (m,) relative brightness.
            warmth: (m,) from blue to red.
            tint: relative linear colour.
        """
        covered, colored = self.cover[window], self.color[window]
        before = covered[there]
        left = before * (1.0 - inside)  # where nothing was before, the colour counts in full
        total = np.maximum(inside + left, 1e-9)
        shade = np.clip(light, 0.3, 1.7)
        for channel, warm in enumerate((1.2, 0.3, -0.8)):
            color = shade * tint[channel] * (1.0 + warmth * warm)
            beneath = colored[..., channel]
            beneath[there] = (color * inside + beneath[there] * left) / total
        covered[there] = inside + left


def settle(color: Floats, cover: Floats, mean: Floats, cutoff: float) -> NDArray[np.uint8]:
    """Gives the opaque texels a mean colour, and lets colours run out under the transparent ones.

    Args:
        color: (h, w, 3) linear, any scale.
        cover: (h, w) in 0..1.
        mean: (3,) linear, of the texels whose cover reaches the cutoff.
        cutoff: of the alpha test.

    Returns: (h, w, 4) uint8 sRGB. Without the bleeding a filtered texture shows fringes.
    """
    opaque = cover >= cutoff
    relative = color / np.maximum(color[opaque].mean(axis=0), 1e-6)
    for _ in range(8):  # what is clipped at white is given back to the rest
        relative = np.clip(relative, 0.0, 1.0 / np.maximum(mean, 1e-6))
        relative /= np.maximum(relative[opaque].mean(axis=0), 1e-6)
    linear = relative * mean
    nearest = distance_transform_edt(cover < 0.5 * cutoff, return_distances=False, return_indices=True)
    linear = linear[nearest[0], nearest[1]]
    encoded: NDArray[np.uint8] = np.rint(255.0 * np.dstack([encode_srgb(linear), cover])).astype(np.uint8)
    return encoded
