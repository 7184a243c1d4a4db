"""What a project holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from flowtree.params import Params

# What may lie beside each photo, and the folder it is kept in.
PER_PHOTO = ("mattes", "strokes", "trimaps", "scribbles", "paint")


@dataclass(frozen=True)
class Project:
    """Everything a tree is made from; saved as a folder that needs nothing outside itself.

    Attributes:
        photos: files.
        yaws: of the photos [degrees]; None for the default.
        height: of the tree [m]; None for the default.
        seed: of all random choices.
        params: of all stages.
        mattes: by the photo's number: a matte made elsewhere.
        strokes: by the photo's number: drawn branches and marks.
        trimaps: by the photo's number.
        scribbles: by the photo's number.
        paint: by the photo's number: a painted edit.
    """

    photos: tuple[Path, ...]
    yaws: tuple[float, ...] | None = None
    height: float | None = None
    seed: int = 0
    params: Params = Params()
    mattes: Mapping[int, Path] = field(default_factory=dict)
    strokes: Mapping[int, Path] = field(default_factory=dict)
    trimaps: Mapping[int, Path] = field(default_factory=dict)
    scribbles: Mapping[int, Path] = field(default_factory=dict)
    paint: Mapping[int, Path] = field(default_factory=dict)
