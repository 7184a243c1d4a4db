"""The demo's pictures with their mattes: what a reconstruction starts from that need not find the tree."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree.matting.extract_matte import extract_matte
from flowtree.photos.load_photo import load_photo
from flowtree.render.write_picture import write_picture

PAIR = tuple(Path(__file__).parents[1] / "flowtree" / "cli" / "demo" / f"photo_{k}.jpg" for k in (0, 1))
HEIGHT = 11.0  # [m], of the tree in the pictures


def save_matted_pair(folder: Path) -> tuple[Path, ...]:
    """Cuts the bundled pictures out as ``flowtree matte`` does: PNG files with an alpha channel."""
    files = []
    for picture in PAIR:
        matte = extract_matte(load_photo(picture))
        file = folder / f"{picture.stem}.png"
        write_picture(np.dstack([matte.foreground, np.rint(matte.alpha * 255.0).astype(np.uint8)]), file)
        files.append(file)
    return tuple(files)
