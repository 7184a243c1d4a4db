"""Fits the stages' functions to the table, from the values on the board to their arguments: to painting."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.matting.cut_out_tree import CutOut, cut_out_tree
from flowtree.matting.extract_matte import color_matte
from flowtree.matting.paint_matte import paint_matte
from flowtree.matting.prepare_photo import PreparedPhoto, prepare_photo
from flowtree.model.edit import PaintedEdit
from flowtree.model.marks import ViewMarks
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.photos.check_marks import check_marks
from flowtree.photos.load_photo import load_photo
from flowtree.photos.mirror_marks import mirror_marks
from flowtree.photos.mirror_photo import mirror_photo
from flowtree.photos.read_marks import read_marks
from flowtree.photos.read_painted_edit import read_painted_edit
from flowtree.photos.read_picks import Picks, read_picks, with_picks
from flowtree.photos.read_scribbles import read_scribbles
from flowtree.photos.read_trimap import read_trimap
from flowtree.pipeline.stage import Job

if TYPE_CHECKING:
    from flowtree.branches.shape_twigs import TwigShapes

Polylines = tuple[NDArray[np.float32], ...]


def run_photos(job: Job, source: Path | Photo, matte: Path | NDArray[np.float32] | None) -> Photo:
    """One photo, with a matte made elsewhere as its alpha channel."""
    photo = source if isinstance(source, Photo) else load_photo(source, params=job.params.photos)
    if matte is None:
        return photo
    return replace(photo, alpha=_given_alpha(job, photo, matte))


def _given_alpha(job: Job, photo: Photo, matte: Path | NDArray[np.float32]) -> NDArray[np.float32]:
    """A matte made elsewhere: an array, or a picture whose alpha channel, else its grey, is the alpha."""
    if isinstance(matte, Path):
        picture = load_photo(matte, params=job.params.photos)
        grey = picture.rgb.astype(np.float32).mean(axis=2) / 255.0
        thing, alpha = matte.name, grey if picture.alpha is None else picture.alpha
    else:
        thing, alpha = f"matte of {photo.name}", matte
    return check.array(alpha, thing, shape=photo.rgb.shape[:2], low=0.0, high=1.0)


def run_strokes(job: Job, photo: Photo, strokes: Path | Polylines | None, mirrored: bool) -> Polylines:
    """The drawn branches of one view."""
    del job
    if isinstance(strokes, Path):
        from flowtree.attraction.read_strokes import read_strokes

        lines = read_strokes(strokes, photo)
    else:
        lines = tuple(strokes or ())
    return tuple(_flip_line(line, photo.rgb.shape[1]) for line in lines) if mirrored else lines


def run_marks(job: Job, photo: Photo, given: Path | ViewMarks | None, mirrored: bool) -> ViewMarks:
    """What a person pointed at in one view."""
    del job
    if isinstance(given, Path):
        marks = read_marks(given, photo)
    else:
        marks = ViewMarks() if given is None else check_marks(given, photo, name=f"marks of {photo.name}")
    return mirror_marks(marks, photo.rgb.shape[1]) if mirrored else marks


def run_picks(job: Job, scribbles: Any) -> Picks:
    """The colours that were picked on one photo."""
    del job
    return read_picks(scribbles) if isinstance(scribbles, Path) else Picks()


def run_preparing(job: Job, photo: Photo, trimap: Any, picks: Picks) -> PreparedPhoto | None:
    """What matting finds out about a photo before anybody scribbles on it; nothing where it will not ask."""
    if photo.alpha is not None or trimap is not None:
        return None
    return prepare_photo(photo, params=with_picks(job.params.matting, picks))


def run_matting(
    job: Job, photo: Photo, prepared: PreparedPhoto | None, trimap: Any, scribbles: Any, picks: Picks
) -> CutOut:
    """One photo's alpha, steered by what is given."""
    if prepared is not None:  # of an equal photo, but not always of the same object
        prepared = replace(prepared, photo=photo)
    if isinstance(trimap, Path):
        trimap = read_trimap(trimap, photo, params=job.params.photos)
    if isinstance(scribbles, Path):
        scribbles = read_scribbles(scribbles, photo, params=job.params.photos) if picks.strokes else None
    params = with_picks(job.params.matting, picks)
    return cut_out_tree(photo, trimap=trimap, scribbles=scribbles, prepared=prepared, params=params)


def run_coloring(job: Job, photo: Photo, cut: CutOut) -> Matte:
    """The matte with the tree's own colours."""
    del job
    return color_matte(photo, cut)


def run_painting(
    job: Job, photo: Photo, matte: Matte, paint: Path | PaintedEdit | None, mirrored: bool
) -> tuple[Photo, Matte, PaintedEdit]:
    """Reads what a person painted; a mirrored view is mirrored here, with all that is painted on it.

    It is not yet applied: where the tree stands in the photographs does not hang on it, so that all the rest
    stays where it was. Only where there is no tree without it, it makes the matte.
    """
    edit = (
        read_painted_edit(paint, photo, params=job.params.photos)
        if isinstance(paint, Path)
        else paint or PaintedEdit()
    )
    painted = paint_matte(matte, edit)  # refuses layers that do not fit before anything is done with them
    if not matte.alpha.any():
        matte, edit = painted, replace(edit, add=None, erase=None)
    if not mirrored:
        return photo, matte, edit
    width = photo.rgb.shape[1]
    flipped = PaintedEdit(
        add=_flip(edit.add),
        erase=_flip(edit.erase),
        directions=tuple(_flip_line(line, width) for line in edit.directions),
        reach=edit.reach,
    )
    matte = replace(
        matte, alpha=_flip(matte.alpha), foreground=_flip(matte.foreground), unknown=_flip(matte.unknown)
    )
    return mirror_photo(photo), matte, flipped


def run_leaving_bare(
    job: Job, photo: Photo, matte: Matte, paint: Path | PaintedEdit | None, mirrored: bool
) -> tuple[Photo, Matte, PaintedEdit]:
    """The same where nothing is painted; but paint that makes the matte is no edit."""
    return run_painting(job, photo, matte, None if matte.alpha.any() else paint, mirrored)


def _flip(picture: Any) -> Any:
    return None if picture is None else np.ascontiguousarray(picture[:, ::-1])


def _flip_line(line: NDArray[np.float32], width: int) -> NDArray[np.float32]:
    return np.column_stack([np.float32(width) - line[:, :1], line[:, 1:]])


def run_sketch(job: Job, source: Path | None) -> TwigShapes | None:
    """The drawn twig that is the example for all, or nothing."""
    if source is None:
        return None
    from flowtree.pipeline.sketch_twig import sketch_twig  # few trees have one, and it would delay the photos

    return sketch_twig(source, params=job.params.twigs, seed=job.seed)
