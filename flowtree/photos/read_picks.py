"""Reads the colours that somebody picked on a photo."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.params import MattingParams
from flowtree.photos.read_drawn_json import read_drawn_json

_FORM = '{"strokes": [], "tree_colors": ["#3a5f0b"], "background_colors": ["#8fb5e0"]}'
_MOST = 64


@dataclass(frozen=True)
class Picks:
    """What a file of scribbles says besides its strokes.

    Attributes:
        tree: colours of the tree, #rrggbb.
        background: colours beside it.
        strokes: whether there are strokes, too.
    """

    tree: tuple[str, ...] = ()
    background: tuple[str, ...] = ()
    strokes: bool = True


def read_picks(path: str | Path) -> Picks:
    """Reads the picked colours of a JSON file of scribbles; there are none in any other file.

    The file of `read_scribbles` may hold ``"tree_colors"`` and ``"background_colors"`` beside its strokes, or
    with an empty list of strokes.

    Args:
        path: the file.

    Raises:
        InputError: no such file, no JSON, colours that are none.
    """
    file = Path(path)
    if file.suffix.lower() != ".json":
        return Picks()
    content = read_drawn_json(file, holds="scribbles", form=_FORM)
    if not isinstance(content, dict):
        return Picks()  # `read_scribbles` says what it must be
    tree, background = (
        check_colors(content.get(name, []), f"{file.name}, {name}")
        for name in ("tree_colors", "background_colors")
    )
    return Picks(tree, background, content.get("strokes") != [] or not (tree or background))


def with_picks(params: MattingParams, picks: Picks) -> MattingParams:
    """Parameters of matting for one photo: with its own colours besides those that hold for all."""
    if not picks.tree and not picks.background:
        return params
    colors = {
        "foreground_colors": (*params.foreground_colors, *picks.tree),
        "background_colors": (*params.background_colors, *picks.background),
    }
    return params.model_copy(update=colors)


def check_colors(colors: Any, thing: str) -> tuple[str, ...]:
    """The colours, if they are a list of #rrggbb.

    Raises:
        InputError: they are not.
    """
    listed = isinstance(colors, list | tuple) and len(colors) <= _MOST
    check.require(
        listed, thing, f"must be a list of at most {_MOST} colours", repr(colors)[:40], f"write {_FORM}"
    )
    for color in colors:
        valid = isinstance(color, str) and re.fullmatch(r"#[0-9a-fA-F]{6}", color) is not None
        check.require(
            valid, thing, "must hold colours as #rrggbb", repr(color)[:40], "write them like #3a5f0b"
        )
    return tuple(colors)
