"""A known tree and the one made from it, side by side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from benchmarks.measure_truth import INPUTS, Measured, Truth
from flowtree.params import RenderParams
from flowtree.render.assemble_scene import assemble_scene
from flowtree.render.gather_sky_light import gather_sky_light
from flowtree.render.render_view import render_scene

_SIDE, _LABEL = 480, 24  # [pixels]
_FINE = RenderParams(samples=3)  # twigs are finer than a pixel
_PAPER, _INK = np.array([226.0, 232.0, 238.0]), (40, 44, 50)


def draw_comparison(truth: Truth, measured: Measured) -> NDArray[np.uint8]:
    """Above the known tree, below the made one, from the same sides: (h, w, 3) uint8 sRGB."""
    scene = assemble_scene(measured.tree)
    sky = gather_sky_light(scene)
    yaws = sorted(truth.cameras)
    sheet = Image.new("RGB", (_SIDE * len(yaws), 2 * (_SIDE + _LABEL)), tuple(int(c) for c in _PAPER))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(14)
    for column, yaw in enumerate(yaws):
        camera, photo = truth.cameras[yaw], truth.photos[yaw]
        shrink = max(camera.width, camera.height) / _SIDE
        foot = camera.foot[0] / shrink, camera.foot[1] / shrink
        small = replace(
            camera, metres_per_pixel=camera.metres_per_pixel * shrink, foot=foot, width=_SIDE, height=_SIDE
        )
        drawn = render_scene(scene, sky, small, params=_FINE)
        known = _over_paper(np.dstack([photo.rgb, np.rint(255 * truth.alphas[yaw]).astype(np.uint8)]))
        known = known.resize(
            (round(camera.width / shrink), round(camera.height / shrink)), Image.Resampling.BOX
        )
        role = "input" if yaw in INPUTS else "held out"
        rows = (
            (known, f"{truth.name}, yaw {yaw} ({role})"),
            (_over_paper(drawn), f"made: soft IoU {measured.of_tree[yaw]:.3f}"),
        )
        for row, (panel, label) in enumerate(rows):
            top = row * (_SIDE + _LABEL)
            draw.text((column * _SIDE + 6, top + 3), label, fill=_INK, font=font)
            sheet.paste(panel, (column * _SIDE, top + _LABEL))
    return np.asarray(sheet, np.uint8)


def _over_paper(rgba: NDArray[np.uint8]) -> Image.Image:
    alpha = rgba[..., 3:] / 255.0
    return Image.fromarray(np.rint(rgba[..., :3] * alpha + _PAPER * (1.0 - alpha)).astype(np.uint8))
