"""Bark cut out of a photograph."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from flowtree.geometry.srgb import LIGHT_OF_BYTE, decode_srgb, encode_srgb, encode_srgb_bytes
from flowtree.meshing.light_bark import light_bark
from flowtree.meshing.quilt_texture import quilt_texture
from flowtree.meshing.rectify_trunk import TrunkPicture, TrunkStrip, rectify_trunk
from flowtree.meshing.relief_map import relief_map
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.mesh import Material
from flowtree.model.skeleton import Skeleton

NARROWEST = 110.0  # pixels of unrolled bark: less is a blur at arm's length
_SHORTEST = 0.3  # of the texture's length, the unrolled bark's width
_LARGEST = 512  # pixels of the texture
_BLOCK = 0.45  # of the strip's smaller side, quilted
_GREEN = 0.06  # share of pixels that are leaves, grass or moss
_STRANGE = 0.12  # share of pixels whose colour is not the bark's
_DETAIL = 0.02  # relative contrast of single pixels, below which a picture is out of focus
_SHADE = 0.22  # of the strip's width: wider light and dark is light and shade, not bark
_FLECK = 1.4  # times the median
_DEPTH = 0.010  # of the texture's length: relief between dark furrows and light ridges
_ROUGHNESS = 0.92

_Light = NDArray[np.float32]


def cut_bark(
    skeleton: Skeleton,
    matte: Matte,
    camera: Camera,
    picture: TrunkPicture,
    *,
    scale: float,
    seed: int = 0,
) -> Material | None:
    """Bark from a photograph's trunk, if it is large, clear and sharp enough there.

    The paper textures its branches from photographs; it does not say how. Here the trunk is unrolled
    (`rectify_trunk`), its light and shade are taken out, and a texture that repeats both ways is quilted of
    it. Dark is taken for deep in the normal map.

    Args:
        skeleton: with radii [m].
        matte: of the view.
        camera: of the view.
        picture: of the view, as fine as there is.
        scale: length that the texture is to show [m].
        seed: of the quilting.

    Returns: the material; None where the view does not show enough.
    """
    strip = rectify_trunk(skeleton, matte, camera, picture)
    if strip is None or not _is_usable(strip, scale):
        return None
    light = _flatten(LIGHT_OF_BYTE[strip.rgb].astype(np.float32))
    size = int(np.clip(8 * round(scale / strip.metres_per_pixel / 8), 64, _LARGEST))
    shown = size * strip.metres_per_pixel / scale
    if shown < 1.0:  # finer than the texture may be
        light = np.asarray(cv2.resize(light, None, fx=shown, fy=shown, interpolation=cv2.INTER_AREA))
    block = round(_BLOCK * min(light.shape[:2]))
    tile = quilt_texture(light, size, block=block, random=np.random.default_rng(seed))
    mean = light.mean(axis=(0, 1))
    lit = decode_srgb(light_bark(255.0 * encode_srgb(mean)) / 255.0)
    tile *= (lit / np.maximum(tile.mean(axis=(0, 1)), 1e-6)).astype(np.float32)
    grey = tile.mean(axis=2).astype(np.float64)
    relief = np.clip(grey / grey.mean() - 1.0, -1.0, 1.0)
    smooth = gaussian_filter(relief, size / 256.0, mode="wrap")
    return Material(
        name="bark_photo",
        base_color=encode_srgb_bytes(tile),
        normal=relief_map(np.asarray(_DEPTH * smooth, np.float64)),
        roughness=_ROUGHNESS,
    )


def _is_usable(strip: TrunkStrip, scale: float) -> bool:
    """Whether a strip is wide, sharp and shows nothing but bark."""
    height, width = strip.rgb.shape[:2]
    if width < NARROWEST or width * strip.metres_per_pixel < _SHORTEST * scale or height < width:
        return False
    rgb = cv2.GaussianBlur(strip.rgb, (0, 0), 1.0).astype(np.float32)
    red, green, blue = (rgb[..., k] for k in range(3))
    leaf = (green > red + 6.0) & (green > blue + 6.0)
    lab = cv2.cvtColor(np.asarray(rgb / 255.0, np.float32), cv2.COLOR_RGB2LAB)[..., 1:]
    middle = np.median(lab, axis=(0, 1))
    strange = np.linalg.norm(lab - middle, axis=2) > 14.0
    light = LIGHT_OF_BYTE[strip.rgb].mean(axis=2).astype(np.float32)
    fine = light - cv2.GaussianBlur(light, (0, 0), 1.2)
    detail = float(np.median(np.abs(fine))) / max(float(np.median(light)), 1e-4)
    return bool(leaf.mean() <= _GREEN and strange.mean() <= _STRANGE and detail >= _DETAIL)


def _flatten(light: _Light) -> _Light:
    """Linear colours (h, w, 3) without the wide light and shade of a round, half lit trunk."""
    bright = light.mean(axis=2)
    sigma = _SHADE * light.shape[1]
    # Logarithms: shade multiplies.
    logs = np.log(np.maximum(bright, 1e-3))
    wide = cv2.GaussianBlur(logs, (0, 0), sigma, borderType=cv2.BORDER_REFLECT)
    factor = np.exp(np.clip(float(np.median(logs)) - wide, -1.6, 1.6))
    flat = light * factor[..., None]
    tint = cv2.GaussianBlur(flat, (0, 0), sigma, borderType=cv2.BORDER_REFLECT)
    flat = flat * (np.median(flat, axis=(0, 1)) / np.maximum(tint, 1e-4)) ** 0.7
    # What is much brighter still are flecks of sun between shadows of leaves.
    relative = flat.mean(axis=2) / max(float(np.median(flat)), 1e-4)
    calm = np.where(relative > _FLECK, _FLECK + 0.2 * (relative - _FLECK), relative)
    flat = flat * (calm / np.maximum(relative, 1e-4))[..., None]
    return np.asarray(np.clip(flat, 0.0, 1.0), np.float32)
