"""A project as it stands at one moment of its making."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from flowtree.params import Params
from flowtree.project.drawings import NO_MARKS, BranchStroke, Marks, PaintStroke, Scribble


@dataclass(frozen=True)
class DrawnPhoto:
    """A photo and all that was drawn on it.

    Attributes:
        place: of the file in the project's folder, ``photos/1a2b3c4d5e6f/oak.jpg``.
        width: of the upright photo [pixels].
        height: of the upright photo [pixels].
        yaw: from where it was taken [degrees].
        marks: what is given instead of found.
        scribbles: in the order drawn; later ones cover earlier ones.
        tree_colors: picked on the tree, #rrggbb.
        background_colors: picked beside it.
        strokes: drawn branches.
        paint: in the order painted.
        attached: kind and place of files that are no drawings: mattes, trimaps, scribbles and paint that are
            pictures.
    """

    place: str
    width: int
    height: int
    yaw: float = 0.0
    marks: Marks = NO_MARKS
    scribbles: tuple[Scribble, ...] = ()
    tree_colors: tuple[str, ...] = ()
    background_colors: tuple[str, ...] = ()
    strokes: tuple[BranchStroke, ...] = ()
    paint: tuple[PaintStroke, ...] = ()
    attached: tuple[tuple[str, str], ...] = ()

    @property
    def name(self) -> str:
        """Of the file."""
        return PurePosixPath(self.place).name


@dataclass(frozen=True)
class DocumentState:
    """Everything a tree is made from; one is never changed, a command makes the next.

    Attributes:
        photos: in their order.
        height: of the tree [m]; None for the default.
        seed: of all random choices.
        params: of all stages; those that name a picture have their defaults here.
        pictures: parameter (``meshing.bark``) and place of the pictures they name.
    """

    photos: tuple[DrawnPhoto, ...] = ()
    height: float | None = None
    seed: int = 0
    params: Params = Params()
    pictures: tuple[tuple[str, str], ...] = ()

    def with_photo(self, number: int, change: Callable[[DrawnPhoto], DrawnPhoto]) -> DocumentState:
        """The state with one photo changed."""
        photos = (*self.photos[:number], change(self.photos[number]), *self.photos[number + 1 :])
        return replace(self, photos=photos)

    def places(self) -> set[str]:
        """Of all files in the project's folder that it names."""
        attached = {place for photo in self.photos for _, place in photo.attached}
        return {photo.place for photo in self.photos} | attached | {place for _, place in self.pictures}
