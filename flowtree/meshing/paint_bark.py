"""Paints a bark texture in a given colour."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter

from flowtree import check
from flowtree.geometry.srgb import decode_srgb, encode_srgb_bytes
from flowtree.meshing.bark_habits import BarkPattern, furrowed, papery, plated, ringed, smooth
from flowtree.meshing.relief_map import relief_map
from flowtree.meshing.tile_noise import Floats
from flowtree.model.attractor import Habit
from flowtree.model.mesh import Material

BarkStyle = Literal["auto", "furrowed", "smooth", "papery", "plated", "ringed"]

_HABITS: dict[str, tuple[BarkPattern, float]] = {  # with the roughness of the surface
    "furrowed": (furrowed, 0.95),
    "smooth": (smooth, 0.8),
    "papery": (papery, 0.75),
    "plated": (plated, 0.9),
    "ringed": (ringed, 0.9),
}
_FINEST = 1.0 / 512  # of the tile: finer relief only flickers, and makes files large
_PLAIN = np.array([112.0, 98.0, 82.0])  # sRGB, grey brown
_USUAL = {
    "furrowed": _PLAIN,
    "smooth": np.array([146.0, 144.0, 136.0]),
    "papery": np.array([224.0, 220.0, 211.0]),
    "plated": np.array([133.0, 100.0, 76.0]),
    "ringed": np.array([140.0, 122.0, 102.0]),
}
_RELIEF = 0.6  # the normal map shows this share of the heights: full relief glitters from afar


def paint_bark(
    color: ArrayLike | None,
    *,
    style: BarkStyle = "auto",
    growth: Habit | None = None,
    seed: int = 0,
    size: int = 512,
) -> Material:
    """Paints bark that tiles exactly in both directions: base colour and normal map.

    The paper textures its discs and does not say with what; here the pattern is computed, in one of five
    habits: furrowed as oak, smooth as beech, papery as birch, plated as pine, ringed as a palm.

    Args:
        color: (3,) sRGB 0..255. From afar, where only the mean is seen, the bark has this colour: the mean of
            the texture's linear values is that of the colour, where needed at the cost of contrast. None
            takes what is usual for the style.
        style: the habit; "auto" takes papery for near white, smooth for pale plain grey, plated for reddish
            brown, furrowed for the rest, as far as ``growth`` does not tell.
        growth: which way the tree's branches grow, if that is known: palms are ringed, conifers plated.
        seed: another seed, another piece of bark.
        size: [pixels]; the picture's upper side lies toward the tip.

    Returns: the material; opaque, one-sided.

    Raises:
        InputError: a colour out of range, an unknown style, a size below 16 or above 4096.
    """
    if color is None:
        color = _USUAL.get(style, _PLAIN) if growth is None else _USUAL[pick_habit(_PLAIN, growth)]
    srgb = check.array(color, "bark color", shape=(3,), dtype=np.float64, low=0.0, high=255.0)
    habit = pick_habit(srgb, growth) if style == "auto" else style
    check.require(
        habit in _HABITS,
        "bark style",
        f"must be auto, {', '.join(_HABITS)}",
        repr(style),
        check.nearest_name(style, _HABITS),
    )
    check.require(16 <= size <= 4096, "bark size", "must be 16 to 4096 pixels", size, "choose another size")
    paint, roughness = _HABITS[habit]
    height, relative = paint(np.random.default_rng(seed), size)
    return Material(
        name=f"bark_{habit}",
        base_color=_colored(relative, srgb),
        normal=relief_map(_RELIEF * gaussian_filter(height, _FINEST * size, mode="wrap")),
        roughness=roughness,
    )


def pick_habit(color: NDArray[np.float64], growth: Habit | None = None) -> str:
    """The habit that bark of this sRGB colour (3,) 0..255 most often has, on a tree that grows so."""
    red, green, blue = (float(part) for part in color / 255.0)
    bright, spread = max(red, green, blue), max(red, green, blue) - min(red, green, blue)
    saturation = spread / max(bright, 1e-6)
    if growth in ("palm", "conifer"):
        return "ringed" if growth == "palm" else "plated"
    if bright > 0.72 and saturation < 0.22:
        return "papery"
    if bright > 0.5 and saturation < 0.12:
        return "smooth"
    if saturation > 0.42 and red >= green >= blue and bright > 0.25:
        return "plated"
    return "furrowed"


def _colored(relative: Floats, srgb: Floats) -> NDArray[np.uint8]:
    """(s, s, 3) sRGB whose linear mean is the colour's."""
    target = decode_srgb(srgb / 255.0)
    relative = relative / relative.mean(axis=(0, 1))
    # White bark has no room above its mean: its pattern is flattened until nothing would be clipped.
    highest = np.quantile(relative, 0.999, axis=(0, 1))
    room = (1.0 / np.maximum(target, 1e-6) - 1.0) / np.maximum(highest - 1.0, 1e-6)
    linear = target * (1.0 + (relative - 1.0) * np.minimum(room.min(), 1.0))
    return encode_srgb_bytes(linear)
