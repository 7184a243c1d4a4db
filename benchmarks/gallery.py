"""Makes the pictures of the README from the bundled pair."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from flowtree.params import RenderParams
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_sheet import render_sheet
from flowtree.render.render_view import render_view
from flowtree.render.write_picture import write_picture

_ROOT = Path(__file__).parents[1]
_PAIR = [_ROOT / "flowtree" / "cli" / "demo" / f"photo_{k}.jpg" for k in (0, 1)]
_HEIGHT = 11.0  # [m]
_SIDE = 560  # pixels of one panel
_YAWS = (0.0, 45.0, 90.0)
_SKY, _GROUND = np.array([196.0, 214.0, 232.0]), np.array([240.0, 240.0, 236.0])


def main(argv: list[str]) -> int:
    """Writes demo.jpg and sheet.jpg into benchmarks/gallery."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks gallery", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=_ROOT / "benchmarks" / "gallery")
    folder = parser.parse_args(argv).output
    folder.mkdir(parents=True, exist_ok=True)
    made = reconstruct(_PAIR, yaws=(0.0, 90.0), height=_HEIGHT)
    write_picture(_views(made), folder / "demo.jpg", quality=88)
    params = RenderParams(size=_SIDE)
    sheet = render_sheet(made.photos, made.mattes, made.cameras, made.graphs, made.tree, params=params)
    write_picture(sheet, folder / "sheet.jpg", quality=85)
    for name in ("demo.jpg", "sheet.jpg"):
        print(f"gallery.{name} {(folder / name).stat().st_size / 1000:.0f} kB")
    return 0


def _views(made: Reconstruction) -> np.ndarray:
    """The tree from three sides, over a plain sky: (h, 3 h, 3) uint8."""
    panels = []
    for yaw in _YAWS:
        camera = fit_camera(made.tree, yaw, _SIDE)
        drawn = render_view(made.tree, camera, params=RenderParams(size=_SIDE)).astype(np.float64)
        share = np.linspace(0.0, 1.0, _SIDE)[:, None, None]
        backdrop = _SKY * (1.0 - share) + _GROUND * share
        alpha = drawn[..., 3:] / 255.0
        panels.append(drawn[..., :3] * alpha + backdrop * (1.0 - alpha))
    return np.rint(np.concatenate(panels, axis=1)).astype(np.uint8)
