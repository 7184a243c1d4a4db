"""Documents on two small pictures, and commands for them."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

from hypothesis import strategies as st
from PIL import Image

from flowtree.project import commands as do
from flowtree.project.document import Document
from flowtree.project.write_folder import place_of
from tests.pictures import draw_tree

WIDTH, HEIGHT = 60, 80


def two_photos(folder: Path) -> Document:
    """A document whose folder holds two photos of 60 x 80 pixels."""
    document = Document()
    for number in range(2):
        place = put_photo(folder, f"oak_{number}.png", number)
        document.apply(do.AddPhoto(place, WIDTH, HEIGHT))
    return document


def put_photo(folder: Path, name: str, seed: int) -> str:
    """Writes a small picture where photos lie in a project's folder; returns its place."""
    content = BytesIO()
    Image.fromarray(draw_tree(seed, size=(WIDTH, HEIGHT))).save(content, "PNG")
    data = content.getvalue()
    place = place_of("photos", name, data)
    (folder / place).parent.mkdir(parents=True, exist_ok=True)
    (folder / place).write_bytes(data)
    return place


def _points(least: int) -> st.SearchStrategy[tuple[tuple[float, float], ...]]:
    point = st.tuples(st.floats(1, WIDTH - 1), st.floats(1, HEIGHT - 1))
    return st.lists(point, min_size=least, max_size=4, unique=True).map(tuple)


_photo = st.integers(0, 1)
_width = st.floats(0.5, 20)
_share = st.floats(0.1, 1)
COMMANDS = st.one_of(
    st.builds(do.SetYaw, _photo, st.floats(-180, 180)),
    st.builds(do.PlacePhoto, _photo, st.tuples(st.floats(1, 59), st.floats(41, 79)), st.floats(1, 39)),
    st.builds(do.SetMark, _photo, st.just("roll"), st.none() | st.floats(-45, 45)),
    st.builds(do.SetMark, _photo, st.just("fork"), st.none() | st.just((30.0, 40.0))),
    st.builds(do.SetSeeds, _photo, _points(0)),
    st.builds(do.AddScribble, _photo, st.sampled_from(["tree", "background", "unknown"]), _width, _points(1)),
    st.builds(do.RemoveScribbles, _photo, st.just((0,))),
    st.builds(do.SetColors, _photo, st.just(("#3a5f0b",)), st.sampled_from([(), ("#8FB5e0", "#aabbcc")])),
    st.builds(do.AddStroke, _photo, _points(2), st.none() | _width, st.booleans()),
    st.builds(do.ReplaceStroke, _photo, st.just(0), _points(2)),
    st.builds(do.RemoveStrokes, _photo, st.just((0,))),
    st.builds(
        do.AddPaint, _photo, st.sampled_from(["add", "erase", "direct"]), _width, _points(2), _share, _share
    ),
    st.builds(do.RemovePaint, _photo, st.just((0,))),
    st.builds(do.SetHeight, st.none() | st.floats(1, 50)),
    st.builds(do.SetSeed, st.integers(0, 1000)),
    st.builds(do.SetParam, st.just("flow.step"), st.floats(0.001, 0.1)),
    st.builds(do.SetParam, st.just("matting.foreground_colors"), st.just(("#00ff00",))),
    st.builds(do.ResetParams, st.sampled_from([None, "flow"])),
    st.builds(do.RemovePhoto, st.just(1)),
)
