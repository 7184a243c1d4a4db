"""What each command does to the state of a document."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from functools import singledispatch
from typing import Any, TypeVar

from flowtree import check
from flowtree.configuration import params_from_table
from flowtree.params import Params
from flowtree.photos.read_picks import check_colors
from flowtree.project import commands as do
from flowtree.project.check_drawing import check_photo_marks, check_points, check_share, check_width
from flowtree.project.document_state import DocumentState, DrawnPhoto
from flowtree.project.drawings import BranchStroke, Marks, PaintStroke, Scribble
from flowtree.project.save_project import PICTURE_PARAMS

_PICTURES = {f"{section}.{name}": (section, name) for section, name in PICTURE_PARAMS}
_LABELS = ("tree", "background", "unknown", "occluder")
_KINDS = ("add", "erase", "direct")
_MARKS = tuple(field.name for field in fields(Marks) if field.name != "seeds")
_MOST_PHOTOS = 8
_MOST_STROKES = 2000  # of a kind on a photo

_Drawn = TypeVar("_Drawn")


@singledispatch
def apply_command(command: Any, state: DocumentState) -> DocumentState:
    """The state after a command; the given one is left as it is.

    Raises:
        InputError: the command names something that is not there, or breaks a rule.
    """
    check.fail("command", "must be one of flowtree.project.commands", type(command).__name__, "name one")


@apply_command.register
def _(command: do.AddPhoto, state: DocumentState) -> DocumentState:
    count = len(state.photos)
    check.require(count < _MOST_PHOTOS, "photos", f"must be at most {_MOST_PHOTOS}", count + 1, "remove one")
    yaw = _widest_gap([photo.yaw for photo in state.photos]) if command.yaw is None else command.yaw
    photo = DrawnPhoto(command.place, command.width, command.height, yaw)
    return replace(state, photos=(*state.photos, photo))


@apply_command.register
def _(command: do.RemovePhoto, state: DocumentState) -> DocumentState:
    gone = _number(state, command.photo)
    return replace(state, photos=(*state.photos[:gone], *state.photos[gone + 1 :]))


@apply_command.register
def _(command: do.SetYaw, state: DocumentState) -> DocumentState:
    fits = math.isfinite(command.yaw) and abs(command.yaw) <= 360.0
    check.require(fits, "yaw", "must be -360 to 360 degrees", command.yaw, "turn it back")
    return _on(state, command.photo, lambda photo: replace(photo, yaw=command.yaw))


@apply_command.register
def _(command: do.PlacePhoto, state: DocumentState) -> DocumentState:
    return _mark(state, command.photo, foot=command.foot, top=command.top)


@apply_command.register
def _(command: do.SetMark, state: DocumentState) -> DocumentState:
    check.require(
        command.name in _MARKS, "mark", f"must be one of {', '.join(_MARKS)}", command.name, "name one"
    )
    is_place = isinstance(command.value, tuple)
    fits = command.value is None or is_place == (command.name in ("foot", "fork"))
    rule = "must be a place [x, y]" if command.name in ("foot", "fork") else "must be a number"
    check.require(fits, command.name, rule, command.value, "give such")
    return _mark(state, command.photo, **{command.name: command.value})


@apply_command.register
def _(command: do.SetSeeds, state: DocumentState) -> DocumentState:
    return _mark(state, command.photo, seeds=command.points)


@apply_command.register
def _(command: do.AddScribble, state: DocumentState) -> DocumentState:
    def add(photo: DrawnPhoto) -> DrawnPhoto:
        _refuse_attached(photo, "scribbles")
        known = command.label in _LABELS
        check.require(known, "scribble", f"needs a label of {', '.join(_LABELS)}", command.label, "name one")
        check_points(command.points, photo, "scribble")
        check_width(command.width, photo, "scribble")
        scribble = Scribble(command.label, command.width, command.points)
        return replace(photo, scribbles=_more(photo.scribbles, scribble, "scribbles"))

    return _on(state, command.photo, add)


@apply_command.register
def _(command: do.RemoveScribbles, state: DocumentState) -> DocumentState:
    def remove(photo: DrawnPhoto) -> DrawnPhoto:
        return replace(photo, scribbles=_fewer(photo.scribbles, command.indices, "scribbles"))

    return _on(state, command.photo, remove)


@apply_command.register
def _(command: do.SetColors, state: DocumentState) -> DocumentState:
    def pick(photo: DrawnPhoto) -> DrawnPhoto:
        _refuse_attached(photo, "scribbles")
        tree, background = (
            check_colors(colors, "picked colours") for colors in (command.tree, command.background)
        )
        return replace(photo, tree_colors=tree, background_colors=background)

    return _on(state, command.photo, pick)


@apply_command.register
def _(command: do.AddStroke, state: DocumentState) -> DocumentState:
    def add(photo: DrawnPhoto) -> DrawnPhoto:
        check_points(command.points, photo, "stroke", least=2)
        if command.width is not None:
            check_width(command.width, photo, "stroke")
        stroke = BranchStroke(command.points, command.width, command.snapped)
        return replace(photo, strokes=_more(photo.strokes, stroke, "strokes"))

    return _on(state, command.photo, add)


@apply_command.register
def _(command: do.ReplaceStroke, state: DocumentState) -> DocumentState:
    def put(photo: DrawnPhoto) -> DrawnPhoto:
        _fewer(photo.strokes, (command.index,), "strokes")
        check_points(command.points, photo, "stroke", least=2)
        strokes = list(photo.strokes)
        strokes[command.index] = replace(strokes[command.index], points=command.points)
        return replace(photo, strokes=tuple(strokes))

    return _on(state, command.photo, put)


@apply_command.register
def _(command: do.RemoveStrokes, state: DocumentState) -> DocumentState:
    def remove(photo: DrawnPhoto) -> DrawnPhoto:
        return replace(photo, strokes=_fewer(photo.strokes, command.indices, "strokes"))

    return _on(state, command.photo, remove)


@apply_command.register
def _(command: do.AddPaint, state: DocumentState) -> DocumentState:
    def add(photo: DrawnPhoto) -> DrawnPhoto:
        _refuse_attached(photo, "paint")
        known = command.kind in _KINDS
        check.require(known, "paint", f"needs a kind of {', '.join(_KINDS)}", command.kind, "name one")
        check_points(command.points, photo, "paint", least=2 if command.kind == "direct" else 1)
        check_width(command.width, photo, "paint")
        check_share(command.softness, "softness")
        check_share(command.strength, "strength", low=0.01)
        stroke = PaintStroke(command.kind, command.width, command.points, command.softness, command.strength)
        return replace(photo, paint=_more(photo.paint, stroke, "painted strokes"))

    return _on(state, command.photo, add)


@apply_command.register
def _(command: do.RemovePaint, state: DocumentState) -> DocumentState:
    def remove(photo: DrawnPhoto) -> DrawnPhoto:
        return replace(photo, paint=_fewer(photo.paint, command.indices, "painted strokes"))

    return _on(state, command.photo, remove)


@apply_command.register
def _(command: do.RemoveAttached, state: DocumentState) -> DocumentState:
    def remove(photo: DrawnPhoto) -> DrawnPhoto:
        kinds = [kind for kind, _ in photo.attached]
        held = command.kind in kinds
        check.require(
            held, command.kind, "must lie beside the photo", ", ".join(kinds) or "nothing", "look again"
        )
        return replace(photo, attached=tuple(pair for pair in photo.attached if pair[0] != command.kind))

    return _on(state, command.photo, remove)


@apply_command.register
def _(command: do.SetHeight, state: DocumentState) -> DocumentState:
    fits = command.height is None or (math.isfinite(command.height) and 0.01 <= command.height <= 200.0)
    check.require(fits, "height", "must be 0.01 to 200 metres", command.height, "give the tree's height")
    return replace(state, height=command.height)


@apply_command.register
def _(command: do.SetSeed, state: DocumentState) -> DocumentState:
    check.require(
        0 <= command.seed < 2**63, "seed", "must be a whole number from 0", command.seed, "give another"
    )
    return replace(state, seed=command.seed)


@apply_command.register
def _(command: do.SetParam, state: DocumentState) -> DocumentState:
    section, _, key = command.name.partition(".")
    pictures = state.pictures
    if command.name in _PICTURES:
        clears = command.value in (None, "auto")
        check.require(
            clears, command.name, "must be given as a picture", repr(command.value)[:40], "upload it"
        )
        pictures = tuple(pair for pair in pictures if pair[0] != command.name)
    table = state.params.model_dump()
    table.setdefault(section, {})[key] = command.value
    return replace(state, params=params_from_table(table), pictures=pictures)


@apply_command.register
def _(command: do.SetPicture, state: DocumentState) -> DocumentState:
    known = command.name in _PICTURES
    check.require(known, command.name, f"must be one of {', '.join(_PICTURES)}", command.name, "name one")
    others = (pair for pair in state.pictures if pair[0] != command.name)
    return replace(state, pictures=tuple(sorted([*others, (command.name, command.place)])))


@apply_command.register
def _(command: do.ResetParams, state: DocumentState) -> DocumentState:
    section = command.section
    if section is None:
        return replace(state, params=Params(), pictures=())
    known = section in Params.model_fields
    check.require(known, "section", "must be one of the parameters'", section, "see `flowtree params`")
    table = {name: value for name, value in state.params.model_dump().items() if name != section}
    pictures = tuple(pair for pair in state.pictures if pair[0].split(".")[0] != section)
    return replace(state, params=params_from_table(table), pictures=pictures)


@apply_command.register
def _(command: do.OpenState, state: DocumentState) -> DocumentState:
    del state
    return command.state


def _number(state: DocumentState, photo: int) -> int:
    count = len(state.photos)
    check.require(
        0 <= photo < count, "photo", f"must be one of {count}, counted from 0", photo, "name another"
    )
    return photo


def _on(state: DocumentState, photo: int, change: Callable[[DrawnPhoto], DrawnPhoto]) -> DocumentState:
    return state.with_photo(_number(state, photo), change)


def _mark(state: DocumentState, number: int, **values: Any) -> DocumentState:
    def change(photo: DrawnPhoto) -> DrawnPhoto:
        marks = replace(photo.marks, **values)
        check_photo_marks(marks, photo)
        return replace(photo, marks=marks)

    return _on(state, number, change)


def _more(drawn: tuple[_Drawn, ...], one: _Drawn, what: str) -> tuple[_Drawn, ...]:
    count = len(drawn)
    check.require(count < _MOST_STROKES, what, f"must be at most {_MOST_STROKES}", count + 1, "remove some")
    return (*drawn, one)


def _fewer(drawn: tuple[_Drawn, ...], indices: Sequence[int], what: str) -> tuple[_Drawn, ...]:
    there = len(indices) > 0 and all(0 <= k < len(drawn) for k in indices)
    check.require(
        there, what, f"must be named by numbers below {len(drawn)}", list(indices)[:5], "look again"
    )
    return tuple(one for k, one in enumerate(drawn) if k not in set(indices))


def _refuse_attached(photo: DrawnPhoto, kind: str) -> None:
    held = [place.rsplit("/", 1)[-1] for name, place in photo.attached if name == kind]
    remedy = "remove that file first"
    check.require(not held, photo.name, f"must not have a picture of {kind}, too", held[:1], remedy)


def _widest_gap(yaws: Sequence[float]) -> float:
    """The yaw farthest from all others; opposite sides show the same outline [degrees]."""
    if not yaws:
        return 0.0
    taken = sorted({yaw % 180.0 for yaw in yaws})
    gaps = [
        (after - before, before) for before, after in zip(taken, [*taken[1:], taken[0] + 180.0], strict=True)
    ]
    widest = max(gap for gap, _ in gaps)
    start = next(before for gap, before in gaps if gap == widest)
    return (start + 0.5 * widest) % 180.0
