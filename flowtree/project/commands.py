"""Everything that can be done to a document; `apply_command` does it.

A photo is counted from 0, places are pixels of the upright photo, angles are degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from flowtree.project.document_state import DocumentState
from flowtree.project.drawings import Label, PaintKind, Point, Points


@dataclass(frozen=True)
class AddPhoto:
    """A photo more, which lies in the project's folder already; without a yaw it gets the widest gap."""

    place: str
    width: int
    height: int
    yaw: float | None = None


@dataclass(frozen=True)
class RemovePhoto:
    """A photo less, with all that is drawn on it."""

    photo: int


@dataclass(frozen=True)
class SetYaw:
    """From where a photo was taken."""

    photo: int
    yaw: float


@dataclass(frozen=True)
class PlacePhoto:
    """Foot and top of the tree in a photo at once: what dragging and scaling it against the others means."""

    photo: int
    foot: Point
    top: float


@dataclass(frozen=True)
class SetMark:
    """One of a photo's `Marks` but its seeds; None has it found."""

    photo: int
    name: str
    value: Point | float | None


@dataclass(frozen=True)
class SetSeeds:
    """All tips of branches of a photo."""

    photo: int
    points: Points


@dataclass(frozen=True)
class AddScribble:
    """One `Scribble` more."""

    photo: int
    label: Label
    width: float
    points: Points


@dataclass(frozen=True)
class RemoveScribbles:
    """Some scribbles less."""

    photo: int
    indices: tuple[int, ...]


@dataclass(frozen=True)
class SetColors:
    """All colours that are picked on a photo: of the tree, and beside it."""

    photo: int
    tree: tuple[str, ...]
    background: tuple[str, ...]


@dataclass(frozen=True)
class AddStroke:
    """One `BranchStroke` more."""

    photo: int
    points: Points
    width: float | None = None
    snapped: bool = False


@dataclass(frozen=True)
class ReplaceStroke:
    """A drawn branch with other points."""

    photo: int
    index: int
    points: Points


@dataclass(frozen=True)
class RemoveStrokes:
    """Some drawn branches less."""

    photo: int
    indices: tuple[int, ...]


@dataclass(frozen=True)
class AddPaint:
    """One `PaintStroke` more."""

    photo: int
    kind: PaintKind
    width: float
    points: Points
    softness: float = 0.5
    strength: float = 1.0


@dataclass(frozen=True)
class RemovePaint:
    """Some painted strokes less."""

    photo: int
    indices: tuple[int, ...]


@dataclass(frozen=True)
class RemoveAttached:
    """Without a file that came with a photo: a matte, a trimap, a picture of scribbles or of paint."""

    photo: int
    kind: str


@dataclass(frozen=True)
class SetHeight:
    """Of the tree [m]; None for the default."""

    height: float | None


@dataclass(frozen=True)
class SetSeed:
    """Another tree of the same kind."""

    seed: int


@dataclass(frozen=True)
class SetParam:
    """One parameter, ``flow.step``."""

    name: str
    value: Any


@dataclass(frozen=True)
class SetPicture:
    """A picture for a parameter that names one; it lies in the project's folder already."""

    name: str
    place: str


@dataclass(frozen=True)
class OpenState:
    """Another project in the place of this one; its files lie in the project's folder already."""

    state: DocumentState


@dataclass(frozen=True)
class ResetParams:
    """The defaults of a section, or of all."""

    section: str | None = None


Command = (
    AddPhoto
    | RemovePhoto
    | SetYaw
    | PlacePhoto
    | SetMark
    | SetSeeds
    | AddScribble
    | RemoveScribbles
    | SetColors
    | AddStroke
    | ReplaceStroke
    | RemoveStrokes
    | AddPaint
    | RemovePaint
    | RemoveAttached
    | SetHeight
    | SetSeed
    | SetParam
    | SetPicture
    | ResetParams
    | OpenState
)

#: Those that say what is, and not what comes on top: in one gesture the last one counts.
SETTING = (SetYaw, PlacePhoto, SetMark, SetSeeds, SetColors, ReplaceStroke, SetHeight, SetSeed, SetParam)


def target_of(command: Command) -> tuple[Any, ...]:
    """What a command is about: two that set the same thing have equal targets."""
    about = ("photo", "name", "index")
    return type(command).__name__, *(getattr(command, field, None) for field in about)
