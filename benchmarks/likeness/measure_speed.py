"""How long large photographs take."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
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
from flowtree.matting.prepare_photo import prepare_photo
from flowtree.model.photo import Photo
from flowtree.photos.load_photo import load_photo

_WHOLE, _MATTE, _SCRIBBLE = 15.0, 4.0, 1.0  # [s]
_LARGE = (3000, 4000)  # 12 megapixels
_ROUNDS = 2

T = TypeVar("T")


def measure_speed(bench: Bench, names: Sequence[str]) -> list[Row]:
    """The faster of two runs each: a whole process to a GLB, a matte with reading, one more scribble.

    The photographs are the known trees' loose ones, enlarged to 12 megapixels; the slowest tree counts.
    """
    whole, matte, mended = {}, {}, {}
    with tempfile.TemporaryDirectory(prefix="flowtree-speed-") as temporary:
        for name in names:
            files = [
                _enlarge(bench.data / "truth" / name / f"photo_{number}.jpg", Path(temporary))
                for number in (0, 1)
            ]
            output = str(Path(temporary) / "tree.glb")
            command = ["reconstruct", *map(str, files), "--yaw", "0,90", "-o", output]
            if name == names[0]:
                watch_command(command)  # compiles, where that was not kept
            whole[name] = min(watch_command(command).whole for _ in range(_ROUNDS))
            matte[name], (photo, alpha) = _timed(partial(_cut_out, files[0], bench))
            truth = cv2.resize(load_grey(bench.data / "truth" / name / "alpha_0.png"), alpha.shape[::-1])
            scribbles = draw_scribble(alpha, truth, np.zeros(alpha.shape, np.uint8))
            if scribbles is not None:
                again = partial(
                    extract_matte,
                    photo,
                    scribbles=scribbles,
                    prepared=prepare_photo(photo, params=bench.params.matting),
                    params=bench.params.matting,
                )
                mended[name], _ = _timed(again)
    rows = (
        ("two 12-megapixel photos to GLB, whole process", _WHOLE, whole),
        ("a 12-megapixel photo to its matte", _MATTE, matte),
        ("the matte after one more scribble", _SCRIBBLE, mended),
    )
    return [
        Row(measure, asked, max(took.values(), default=0.0), took, at_most=True, unit="s")
        for measure, asked, took in rows
    ]


def _enlarge(photo: Path, folder: Path) -> Path:
    """A picture of 12 megapixels."""
    file = folder / photo.name
    with Image.open(photo) as small:
        small.resize(_LARGE, Image.Resampling.BICUBIC).save(file, quality=92)
    return file


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
