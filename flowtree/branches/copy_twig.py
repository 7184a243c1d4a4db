"""A sketched twig as the example for all twigs (Particle Flows, section 8; Okabe et al. 2005)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree.branches.join_strokes import join_strokes
from flowtree.branches.shape_twigs import TwigShapes
from flowtree.branches.trim_sketch import TwigSketch, trim_sketch
from flowtree.geometry.parent_array import child_count

_TURN, _ROLL = 9.0, 32.0  # [degrees] a side shoot is turned in the sketch's plane and out of it
_STRETCH = (0.8, 1.2)  # of a side shoot
_TAPER, _THINNEST = 0.45, 0.4  # how much thinner than by the rule a tip is; of the twig's radius, at least

_Array = NDArray[np.float64]


def copy_twig(
    strokes: Sequence[NDArray[np.floating]], count: int, *, curl: float, random: np.random.Generator
) -> TwigShapes:
    """Copies of a sketched twig that differ as twigs of one tree do.

    The paper only says that the user sketches examples that are applied to the whole plant. Here the drawn
    lines are joined to a tree whose lowest end is the twig's base, straightened so that base and tip lie on
    one line, and simplified to few nodes. Every second copy is mirrored; in each, every side shoot is turned
    a little in the sketch's plane and rolled out of it, with all that it bears, and stretched; the whole is
    bent by ``curl``, as the usual shoots are. Where a copy stands on the tree, how it is rolled around its
    branch, its length, plagiotropism and rigidity are the usual rule's.

    Args:
        strokes: polylines (k, 2) as (x, y), y downwards, in any unit, at least one with a length.
        count: of the copies.
        curl: how far a tip leaves the plane, as a share of the length (standard deviation).
        random: of all variation.

    Returns: the copies, of unit length from base to tip.
    """
    sketch = trim_sketch(join_strokes(strokes))
    parent, above = sketch.parent, np.maximum(sketch.parent, 0)
    flat = np.pad(sketch.points, ((0, 0), (0, 1)))
    offset = np.where(parent[:, None] >= 0, flat - flat[above], flat)
    points = np.empty((count, len(parent), 3))
    frames: list[_Array] = []
    for node, before in enumerate(parent):
        frame = np.eye(3)[None] if before < 0 else frames[before]
        if sketch.begins[node]:
            axis = offset[before] if before >= 0 else np.array([0.0, 1.0, 0.0])
            frame = frame @ _turned(axis, count, random)
        frames.append(frame)
        points[:, node] = frame @ offset[node] + (0.0 if before < 0 else points[:, before])
    points[::2, :, 0] *= -1.0
    along = np.clip(points[..., 1:2], 0.0, None)
    points[..., [0, 2]] += random.normal(0.0, curl, (count, 1, 2)) * along**2
    return TwigShapes(parent=parent, points=points, thickness=_thickness(sketch, offset), shoot=sketch.shoot)


def _turned(axis: _Array, count: int, random: np.random.Generator) -> _Array:
    """Rotations with a stretch (count, 3, 3): in the sketch's plane and then about an axis in it."""
    turn, roll = np.radians(random.normal(0.0, [[_TURN], [_ROLL]], (2, count)))
    x, y = axis[:2] / max(float(np.hypot(*axis[:2])), 1e-12)
    across = np.array([[0.0, 0.0, y], [0.0, 0.0, -x], [-y, x, 0.0]])  # Rodrigues' formula
    spin = np.eye(3) + np.sin(roll)[:, None, None] * across
    spin = spin + (1.0 - np.cos(roll))[:, None, None] * (across @ across)
    plane = np.zeros((count, 3, 3))
    plane[:, 0, 0] = plane[:, 1, 1] = np.cos(turn)
    plane[:, 0, 1], plane[:, 1, 0] = -np.sin(turn), np.sin(turn)
    plane[:, 2, 2] = 1.0
    return np.asarray(spin @ plane * random.uniform(*_STRETCH, count)[:, None, None])


def _thickness(sketch: TwigSketch, offset: _Array) -> _Array:
    """By the number of tips that a node carries (Da Vinci's rule), and thinner the farther out."""
    parent = sketch.parent
    tips = (child_count(parent) == 0).astype(np.float64)
    out = np.linalg.norm(offset, axis=1)
    for node in range(len(parent)):
        out[node] += out[parent[node]] if parent[node] >= 0 else 0.0
    for node in range(len(parent) - 1, -1, -1):
        if parent[node] >= 0:
            tips[parent[node]] += tips[node]
    share = np.sqrt(tips / tips[parent < 0].max())
    return np.asarray(np.clip(share * (1.0 - _TAPER * out / out.max()), _THINNEST, 1.0))
