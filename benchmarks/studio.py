"""Times the studio: from a command to its matte, skeleton and tree, on two photos of 12 megapixels."""

from __future__ import annotations

import argparse
import queue
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

from PIL import Image

from benchmarks.describe_machine import describe_machine
from flowtree import check
from flowtree.project import commands as do
from flowtree.studio.keep_picture import DEMO
from flowtree.studio.session import Session

#: What each may take [s].
BOUNDS = {
    "first.tree": 30.0,
    "scribble.matte": 0.4,
    "stroke.skeleton": 2.0,
    "stroke.tree": 6.0,
    "paint.skeleton": 2.0,
    "paint.tree": 6.0,
    "cancel": 0.5,
}
_LARGE = (3000, 4000)  # 12 megapixels
_PATIENCE = 300.0  # [s]
_LAYERS = {"matte/0": "matte", "skeleton": "skeleton", "tree.glb": "tree"}


def main(argv: list[str]) -> int:
    """Prints medians beside `BOUNDS`; returns 0 where all are kept."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks studio", description=__doc__)
    parser.add_argument("--rounds", type=int, default=5, help="of every kind of edit, whose median counts")
    options = parser.parse_args(argv)
    check.require(options.rounds > 0, "--rounds", "must be at least 1", options.rounds, "give more")
    with tempfile.TemporaryDirectory(prefix="flowtree-studio-") as folder:
        found = time_session(Path(folder), options.rounds, _enlarge(Path(folder)))
    for key, values in found.items():
        asked = f" (asked <= {BOUNDS[key]:g})" if key in BOUNDS else ""
        print(f"studio.{key} {median(values):.2f} s{asked}")
    print(describe_machine())
    return 0 if all(median(found[key]) <= bound for key, bound in BOUNDS.items()) else 1


def time_session(folder: Path, rounds: int, photos: Sequence[Path]) -> dict[str, list[float]]:
    """Seconds from a command until each layer that it changes comes."""
    session = Session.open(folder / "project")
    events: queue.Queue[tuple[float, dict[str, Any]]] = queue.Queue()
    session.listen(lambda event: events.put((time.perf_counter(), event)))
    found: dict[str, list[float]] = {}
    try:
        begin = time.perf_counter()
        for photo in photos:
            session.add_photo(photo.name, photo.read_bytes())
        _note(found, "first", _await(events, begin))
        for number in range(rounds):
            for name, command in _edits(session, number):
                begin = time.perf_counter()
                session.apply(command)
                _note(found, name, _await(events, begin))
        for number in range(rounds):
            session.apply(do.SetSeed(100 + number))
            time.sleep(0.1 + 0.2 * number)  # in another stage each time
            begin = time.perf_counter()
            session.cancel()
            while session.busy:
                time.sleep(0.005)
            found.setdefault("cancel", []).append(time.perf_counter() - begin)
    finally:
        session.close()
    return found


def _edits(session: Session, number: int) -> list[tuple[str, do.Command]]:
    """One edit of each kind, another one each time."""
    photo = session.state_json()["photos"][0]
    wide, high = float(photo["width"]), float(photo["height"])
    at = 0.3 + 0.02 * number
    branch = ((0.5 * wide, 0.75 * high), (0.4 * wide, 0.5 * high), (at * wide, 0.35 * high))
    beside = ((0.04 * wide, (0.1 + at) * high), (0.06 * wide, (0.12 + at) * high))
    hole = ((at * wide, 0.4 * high), (at * wide, 0.45 * high))
    return [
        ("scribble", do.AddScribble(0, "background", 0.02 * wide, beside)),
        ("stroke", do.AddStroke(0, branch)),
        ("paint", do.AddPaint(0, "erase", 0.1 * wide, hole)),
        ("slider", do.SetParam("leaves.amount", 0.8 + 0.01 * number)),
    ]


def _await(events: queue.Queue[tuple[float, dict[str, Any]]], begin: float) -> Mapping[str, float]:
    """Seconds until the first layer of each name came, once the tree is done; twigs follow the skeleton."""
    seen: dict[str, float] = {}
    while True:
        when, event = events.get(timeout=_PATIENCE)
        check.require(
            event["event"] != "failed", "the studio", "must succeed", event.get("message"), "mend it"
        )
        if event["event"] == "layer" and event["name"] in _LAYERS:
            seen.setdefault(_LAYERS[event["name"]], when - begin)
        if event["event"] == "done" and event["job"] == "tree":
            return seen


def _note(found: dict[str, list[float]], name: str, seen: Mapping[str, float]) -> None:
    for layer, seconds in seen.items():
        found.setdefault(f"{name}.{layer}", []).append(seconds)


def _enlarge(folder: Path) -> list[Path]:
    """The bundled pair at 12 megapixels."""
    files = []
    for photo in DEMO:
        with Image.open(photo) as small:
            file = folder / photo.name
            small.resize(_LARGE, Image.Resampling.BICUBIC).save(file, quality=92)
        files.append(file)
    return files
