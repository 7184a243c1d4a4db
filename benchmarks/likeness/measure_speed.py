"""How long large photographs take."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from benchmarks.likeness.bench import Bench, Row, load_grey
from benchmarks.likeness.draw_scribble import draw_scribble
from benchmarks.watch_command import watch_command
from flowtree.matting.extract_matte import extract_matte
from flowtree.model.photo import Photo
from flowtree.photos.load_photo import load_photo

_WHOLE, _MATTE, _SCRIBBLE = 15.0, 4.0, 1.0  # [s]
_LARGE = (3000, 4000)  # 12 megapixels
_ROUNDS = 2

T = TypeVar("T")


def measure_speed(bench: Bench, names: Sequence[str]) -> list[Row]:
    """The faster of two runs each: a whole process to a GLB, a matte with reading, one more scribble.

    The photographs are the known trees' loose ones, enlarged to 12 megapixels.
    """
    name = names[0]
    folder = bench.data / "truth" / name
    with tempfile.TemporaryDirectory(prefix="flowtree-speed-") as temporary:
        files = []
        for number in (0, 1):
            file = Path(temporary) / f"photo_{number}.jpg"
            with Image.open(folder / f"photo_{number}.jpg") as small:
                small.resize(_LARGE, Image.Resampling.BICUBIC).save(file, quality=92)
            files.append(file)
        output = str(Path(temporary) / "tree.glb")
        command = ["reconstruct", *map(str, files), "--yaw", "0,90", "-o", output]
        watch_command(command)  # compiles, where that was not kept
        whole = min(watch_command(command).whole for _ in range(_ROUNDS))
        matte, (photo, alpha) = _timed(lambda: _cut_out(files[0], bench))
        nothing = np.zeros(alpha.shape, np.uint8)
        truth = cv2.resize(load_grey(folder / "alpha_0.png"), alpha.shape[::-1])
        scribbles = draw_scribble(alpha, truth, nothing)
        mended = 0.0
        if scribbles is not None:
            mended, _ = _timed(lambda: extract_matte(photo, scribbles=scribbles, params=bench.params.matting))
    return [
        Row("two 12-megapixel photos to GLB, whole process", _WHOLE, whole, {name: whole}, True, "s"),
        Row("a 12-megapixel photo to its matte", _MATTE, matte, {name: matte}, True, "s"),
        Row("the matte after one more scribble", _SCRIBBLE, mended, {name: mended}, True, "s"),
    ]


def _cut_out(file: Path, bench: Bench) -> tuple[Photo, NDArray[np.float32]]:
    photo = load_photo(file, params=bench.params.photos)
    return photo, extract_matte(photo, params=bench.params.matting).alpha


def _timed(work: Callable[[], T]) -> tuple[float, T]:
    """Seconds of the fastest run, and what it made."""
    best = float("inf")
    for _ in range(_ROUNDS):
        start = time.perf_counter()
        made = work()
        best = min(best, time.perf_counter() - start)
    return best, made
