"""Colours picked on a photo, beside its scribbles."""

from __future__ import annotations

import json

import pytest

from flowtree.errors import InputError
from flowtree.params import MattingParams
from flowtree.photos.read_picks import Picks, read_picks, with_picks

_STROKE = {"label": "tree", "points": [[3, 4]]}


def _read(folder, content):
    file = folder / "scribbles.json"
    file.write_text(json.dumps(content))
    return read_picks(file)


def test_colours_come_with_strokes_or_without(tmp_path):
    assert _read(tmp_path, {"strokes": [_STROKE]}) == Picks()
    colors = {"tree_colors": ["#3a5f0b"], "background_colors": ["#8FB5E0", "#ffffff"]}
    read = _read(tmp_path, {"strokes": [_STROKE], **colors})
    assert read == Picks(("#3a5f0b",), ("#8FB5E0", "#ffffff"), strokes=True)
    assert not _read(tmp_path, {"strokes": [], **colors}).strokes
    assert _read(tmp_path, {"strokes": []}).strokes, "an empty file is refused where strokes are read"
    assert read_picks(tmp_path / "scribbles.png") == Picks()


def test_a_photos_colours_come_on_top_of_those_for_all():
    params = MattingParams(foreground_colors=("#000000",))
    assert with_picks(params, Picks()) is params
    picked = with_picks(params, Picks(("#3a5f0b",), ("#ffffff",)))
    assert picked.foreground_colors == ("#000000", "#3a5f0b")
    assert picked.background_colors == ("#ffffff",)


@pytest.mark.parametrize("colors", ["#3a5f0b", ["green"], [3], {"a": 1}, ["#12345"], 65 * ["#123456"]])
def test_what_is_no_colour_is_one_clear_line(tmp_path, colors):
    with pytest.raises(InputError, match="tree_colors"):
        _read(tmp_path, {"strokes": [], "tree_colors": colors})
