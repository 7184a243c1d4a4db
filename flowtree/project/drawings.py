"""What a person draws on a photograph, in pixels of the upright photo, (0, 0) its upper left corner."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Point = tuple[float, float]
Points = tuple[Point, ...]
Label = Literal["tree", "background", "unknown", "occluder"]
PaintKind = Literal["add", "erase", "direct"]


@dataclass(frozen=True)
class Scribble:
    """A stroke that says what is under it.

    Attributes:
        label: "tree", "background", "unknown" (the pixels decide) or "occluder" (something before the tree).
        width: [pixels].
        points: (x, y) [pixels], one or more.
    """

    label: Label
    width: float
    points: Points


@dataclass(frozen=True)
class BranchStroke:
    """A drawn branch.

    Attributes:
        points: (x, y) [pixels], two or more.
        width: of a brush [pixels]; None of a pen, whose branch gets its width from the picture.
        snapped: whether it was led along the picture by livewire; what counts are its points.
    """

    points: Points
    width: float | None = None
    snapped: bool = False


@dataclass(frozen=True)
class PaintStroke:
    """Density painted in or out, or a direction for the particles.

    Attributes:
        kind: "add", "erase" or "direct".
        width: [pixels]; of a direction, how far it reaches.
        points: (x, y) [pixels].
        softness: share of the brush's radius over which it fades, 0..1.
        strength: 0..1.
    """

    kind: PaintKind
    width: float
    points: Points
    softness: float = 0.5
    strength: float = 1.0


@dataclass(frozen=True)
class Marks:
    """Places and numbers of a photo that are given instead of found (see `flowtree.ViewMarks`).

    Attributes:
        foot: (x, y) [pixels] where the trunk leaves the ground.
        top: row [pixels] where the crown ends.
        fork: (x, y) [pixels] of the trunk's first fork.
        seeds: (x, y) [pixels], tips of branches.
        roll: [degrees].
        distance: [m].
        focal_length: as on 36 x 24 mm film [mm].
    """

    foot: Point | None = None
    top: float | None = None
    fork: Point | None = None
    seeds: Points = ()
    roll: float | None = None
    distance: float | None = None
    focal_length: float | None = None


#: Everything is found.
NO_MARKS = Marks()
