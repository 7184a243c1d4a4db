"""Makes the pictures of the README: of the bundled pair, and of trees made from photographs of many kinds."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.cli.reconstruct import draw_preview
from flowtree.model.tree import TreeModel
from flowtree.params import RenderParams
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.render.draw_panels import lay_over_sky
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_view import render_view
from flowtree.render.write_picture import write_picture

_ROOT = Path(__file__).parents[1]
_PAIR = [_ROOT / "flowtree" / "cli" / "demo" / f"photo_{k}.jpg" for k in (0, 1)]
_HEIGHT = 11.0  # [m], of the bundled tree
_SIDE = 560  # pixels of one panel
_YAWS = (0.0, 45.0, 90.0)
_DATA = _ROOT / ".." / "shared" / "data"
# Pictures of other people are shown by what was made of them, from the front.
_KINDS = (
    ("photos/catalpa.jpg", "photos/burr_oak.jpg", "photos/douglas_fir.jpg", "photos/osage_orange_yellow.jpg"),
    ("cutouts/palm-tree2.png", "cutouts/purple-leaf-plum.png", "photos/sycamore_bare.jpg", "truth/willow"),
)
_KIND_SIDE = 420
_FINE = RenderParams(samples=3)  # twigs are finer than a pixel


def main(argv: list[str]) -> int:
    """Writes demo.jpg, sheet.jpg and kinds.jpg into benchmarks/gallery."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks gallery", description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=_ROOT / "benchmarks" / "gallery")
    parser.add_argument("--data", type=Path, default=_DATA, help="the folder of photographs and known trees")
    options = parser.parse_args(argv)
    folder = options.output
    check.require(
        options.data.is_dir(),
        str(options.data),
        "must be a folder",
        "none",
        "name the data folder with --data",
    )
    folder.mkdir(parents=True, exist_ok=True)
    made = reconstruct(_PAIR, yaws=(0.0, 90.0), height=_HEIGHT)
    views = np.concatenate([_draw(made.tree, yaw, _SIDE) for yaw in _YAWS], axis=1)
    write_picture(views, folder / "demo.jpg", quality=88)
    write_picture(draw_preview(made, RenderParams()), folder / "sheet.jpg", quality=85)
    kinds = [np.concatenate([_make(options.data / name) for name in row], axis=1) for row in _KINDS]
    write_picture(np.concatenate(kinds, axis=0), folder / "kinds.jpg", quality=86)
    for name in ("demo.jpg", "sheet.jpg", "kinds.jpg"):
        print(f"gallery.{name} {(folder / name).stat().st_size / 1000:.0f} kB")
    return 0


def _make(picture: Path) -> NDArray[np.uint8]:
    """What one photograph, or the two loose ones of a known tree, became."""
    files = [picture / f"photo_{k}.jpg" for k in (0, 1)] if picture.is_dir() else [picture]
    return _draw(reconstruct(files).tree, 0.0, _KIND_SIDE)


def _draw(tree: TreeModel, yaw: float, side: int) -> NDArray[np.uint8]:
    """The tree over a plain sky: (side, side, 3) uint8."""
    camera = fit_camera(tree, yaw, side)
    return lay_over_sky(render_view(tree, camera, params=_FINE))
