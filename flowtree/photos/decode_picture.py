"""Decodes a picture file of any common kind, capped before decoding, scaled down and upright."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from flowtree import check
from flowtree.params import PhotoParams
from flowtree.photos.lift_pillow_cap import lift_pillow_cap
from flowtree.photos.read_focal_length import read_focal_length

_LEAST_SIDE = 16
_ORIENTATION = 0x0112


@dataclass(frozen=True)
class Picture:
    """A decoded picture file.

    Attributes:
        rgb: (h, w, 3) uint8 sRGB, upright.
        alpha: (h, w) uint8, or None where the file has no alpha channel or a wholly opaque one.
        scale: pixels per pixel of the upright file, at most 1.
        focal_length: [pixels] as the file says it, or None.
    """

    rgb: NDArray[np.uint8]
    alpha: NDArray[np.uint8] | None
    scale: float
    focal_length: float | None = None


def decode_picture(path: str | Path, *, side: int | None, params: PhotoParams = PhotoParams()) -> Picture:
    """Reads a JPEG, PNG (8 or 16 bit; grey, palette, RGB, with alpha), WebP or TIFF file.

    Args:
        path: the file.
        side: larger side [pixels] to scale down to, by area averaging; None keeps the file's size.
        params: ``max_megapixels`` is checked on the header, before a pixel is decoded.

    Raises:
        InputError: no such file, not a picture, truncated, too large, or smaller than 16 x 16 pixels.
    """
    file = Path(path)
    check.require(file.exists(), file.name, "must be a picture file", "no such file", "check the path")
    check.require(file.is_file(), file.name, "must be a picture file", "a directory", "name a file in it")
    with lift_pillow_cap():
        return _decode(file, side, params.max_megapixels)


def _decode(file: Path, side: int | None, max_megapixels: float) -> Picture:
    try:
        opened = Image.open(file)
    except (UnidentifiedImageError, SyntaxError):
        _refuse(file, "something else")
    except Exception as error:  # a plugin raises whatever it stumbles over
        _refuse(file, f"a file that cannot be opened ({error})")
    with opened:
        width, height = opened.size
        size = f"{width} x {height} pixels"
        megapixels = width * height / 1e6
        check.require(
            megapixels <= max_megapixels,
            file.name,
            f"must have at most {max_megapixels:g} megapixels",
            size,
            "scale it down or raise photos.max_megapixels",
        )
        large = min(width, height) >= _LEAST_SIDE
        check.require(
            large,
            file.name,
            f"must be at least {_LEAST_SIDE} x {_LEAST_SIDE} pixels",
            size,
            "use a larger one",
        )
        scale = 1.0 if side is None else min(1.0, side / max(width, height))
        out_width, out_height = max(1, round(width * scale)), max(1, round(height * scale))
        check.require(
            min(out_width, out_height) >= _LEAST_SIDE,
            file.name,
            f"must keep {_LEAST_SIDE} pixels across when scaled to the working size",
            size,
            "crop it around the tree",
        )
        try:
            if scale < 1.0:
                opened.draft("RGB", (out_width, out_height))  # JPEG alone: decodes at 1/2, 1/4 or 1/8
            pixels = _as_rgba_or_rgb(opened)
            turn, focal = _shot(opened, width, height)
        except Exception as error:  # decoders raise whatever they stumble over in damaged data
            _refuse(file, f"damaged or truncated data ({error})")
    rgb, alpha = np.ascontiguousarray(pixels[..., :3]), None
    if pixels.shape[2] == 4 and pixels[..., 3].min() < 255:
        alpha = np.ascontiguousarray(pixels[..., 3])
    if (out_height, out_width) != rgb.shape[:2]:
        rgb, alpha = _shrink(rgb, alpha, (out_width, out_height))
    rgb = _upright(rgb, turn)
    focal = None if focal is None else focal * scale
    return Picture(rgb, None if alpha is None else _upright(alpha, turn), scale, focal)


def _refuse(file: Path, got: str) -> NoReturn:
    check.fail(file.name, "must be a whole JPEG, PNG, WebP or TIFF picture", got, "export it again")


def _as_rgba_or_rgb(image: Image.Image) -> NDArray[np.uint8]:
    """The pixels (h, w, 3 or 4) uint8 of an image in any of Pillow's modes."""
    if image.mode == "F" or image.mode.startswith("I"):
        grey = np.nan_to_num(np.asarray(image, np.float32), nan=0.0, posinf=0.0, neginf=0.0)
        deep = image.mode.startswith("I;16")
        most = float(grey.max())
        white = 65535.0 if deep else next((w for w in (1.0, 255.0, 65535.0) if most <= w), most)
        level = np.clip(np.rint(grey * (255.0 / white)), 0, 255).astype(np.uint8)
        return np.repeat(level[..., None], 3, axis=2)
    mode = "RGBA" if image.has_transparency_data else "RGB"
    return np.asarray(image.convert(mode), np.uint8)


def _shot(image: Image.Image, width: int, height: int) -> tuple[int, float | None]:
    """Orientation and focal length [pixels of the file] of the shot."""
    try:
        exif = image.getexif()
        return int(exif.get(_ORIENTATION, 1)), read_focal_length(exif, width, height)
    except Exception:  # damaged metadata must not cost the picture
        return 1, None


def _shrink(
    rgb: NDArray[np.uint8], alpha: NDArray[np.uint8] | None, size: tuple[int, int]
) -> tuple[NDArray[np.uint8], NDArray[np.uint8] | None]:
    """Area averages; under an alpha channel colours count by their alpha, so that nothing bleeds in."""
    if alpha is None:
        return _uint8(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA)), None
    cover = np.maximum(alpha.astype(np.float32), 1e-3)
    weight = cv2.resize(cover, size, interpolation=cv2.INTER_AREA)
    colour = cv2.resize(rgb * cover[..., None], size, interpolation=cv2.INTER_AREA) / weight[..., None]
    return _uint8(colour), _uint8(weight)


def _uint8(values: NDArray[Any]) -> NDArray[np.uint8]:
    level: NDArray[np.uint8] = np.clip(np.rint(values), 0, 255).astype(np.uint8)
    return level


def _upright(pixels: NDArray[np.uint8], orientation: int) -> NDArray[np.uint8]:
    """Undoes the EXIF orientation 1 to 8 (2, 4, 5, 7 are mirrored)."""
    if orientation in (5, 6, 7, 8):
        pixels = np.swapaxes(pixels, 0, 1)
    if orientation in (2, 3, 6, 7):
        pixels = pixels[:, ::-1]
    if orientation in (3, 4, 7, 8):
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)
