"""How the bark's texture lies on the rings: one scale, no stretch, no seam."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowtree.meshing.branch_axes import Floats, Ints
from flowtree.meshing.place_rings import Rings

_GOLDEN = 0.6180339887498949
_SHRINK = 1.8  # how far a branch may taper before the texture repeats less often around it


@dataclass(frozen=True)
class BarkMap:
    """Rows of vertices, ring after ring; a ring where the texture changes its repeats has two rows.

    Attributes:
        ring: (r,), the ring a row stands on, never falling.
        repeats: (r,), how often the texture repeats around, at least once.
        start: (r, 2), texture coordinates where the row begins.
    """

    ring: Ints
    repeats: Ints
    start: Floats


def map_bark(rings: Rings, wanted_scale: float) -> BarkMap:
    """The rows of vertices that the texture of `wrap_bark` needs.

    Args:
        rings: of all branches.
        wanted_scale: [m] a repeat.
    """
    repeats, start = wrap_bark(rings.chain, rings.arc, rings.bark_radius, wanted_scale)
    changes = np.flatnonzero((repeats[1:] != repeats[:-1]) & (rings.chain[1:] == rings.chain[:-1]))
    ring = np.insert(np.arange(len(repeats)), changes + 1, changes)
    segment = np.insert(np.arange(len(repeats)), changes + 1, changes + 1)
    return BarkMap(ring=ring, repeats=repeats[segment], start=start[ring])


def wrap_bark(chain: Ints, arc: Floats, radius: Floats, wanted_scale: float) -> tuple[Ints, Floats]:
    """Chooses how often the texture repeats around every branch, and how fast it runs along it.

    Around a thick branch it repeats a whole number of times. That number must be constant for the pattern to
    go on, so along a taper the bark gets finer; when the branch has tapered to 1 / 1.8, a new number begins
    there. A branch around which not even one repeat fits shows the whole texture once, smaller: young bark is
    finer, and u grows all the way around, as a normal map needs it. Along the branch the texture is as long
    as it is wide.

    Args:
        chain: (k,), which branch a ring belongs to, counted from 0 without gaps, never falling.
        arc: (k,) [m], distance from the branch's base along its axis.
        radius: (k,) [m], of the bark.
        wanted_scale: [m] a repeat; the tree's scale is the nearest that fits around the trunk without a rest.

    Returns: repeats (k,) around the segment below each ring, of a branch's first ring around the one above;
        and the texture coordinates (k, 2) where the ring begins.
    """
    circumference = 2.0 * np.pi * _settled(chain, radius)
    first = np.flatnonzero(np.diff(chain, prepend=-1))
    count = float(np.rint(circumference[0] / wanted_scale))
    scale = float(circumference[0]) / count if count >= 1.0 else wanted_scale
    width = circumference / scale

    # Each ring stands for the segment below it; a branch's first ring has none.
    before = np.roll(width, 1)
    before[first] = width[first]
    middle = 0.5 * (width + before)
    # The narrowest so far: a swelling does not bring repeats back. Branches are kept apart by the offset.
    apart = (middle.max() + 1.0) * chain
    narrowest = np.minimum.accumulate(middle - apart) + apart
    base = narrowest[first][chain]
    stage = np.floor(np.log(base / narrowest) / np.log(_SHRINK))
    fits = base / _SHRINK**stage
    repeats = np.where(stage > 0, np.rint(0.85 * fits), np.rint(fits)).astype(np.int64)
    repeats = np.maximum(repeats, 1)
    repeats[first] = repeats[np.minimum(first + 1, len(repeats) - 1)]

    gap = np.diff(arc, prepend=0.0)
    gap[first] = 0.0
    rise = np.cumsum(gap * repeats / (middle * scale))
    rise -= rise[first][chain]

    # Every branch starts elsewhere in the picture, or neighbours would look alike. v falls toward the tip,
    # because pictures count rows from above.
    branch = chain + 1
    start = np.stack([(branch * _GOLDEN) % 1.0, (branch * _GOLDEN**2) % 1.0 - rise], axis=1)
    return repeats, start


def _settled(chain: Ints, radius: Floats) -> Floats:
    """(k,) [m] the bark's radius, its steps at forks spread over the rings beside them.

    Where the radius falls at once, bark that follows it would slant; three binomial passes halve that.
    """
    radius = radius.copy()
    same_before = np.concatenate(([False], chain[1:] == chain[:-1]))
    same_after = np.append(same_before[1:], False)
    for _ in range(3):
        before = np.where(same_before, np.roll(radius, 1), radius)
        after = np.where(same_after, np.roll(radius, -1), radius)
        radius = 0.25 * before + 0.5 * radius + 0.25 * after
    return radius
