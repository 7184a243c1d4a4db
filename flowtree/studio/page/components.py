"""The two components that are ours: the photo board and the tree viewer."""

from __future__ import annotations

from pathlib import Path

import nicegui.elements.scene  # noqa: F401  # registers three.js, which the viewer imports
from nicegui.dependencies import register_esm
from nicegui.element import Element

STATIC = Path(__file__).parents[1] / "static"

# A browser keeps the modules for as long as their address is the same: it tells of the newest of them.
register_esm("flowtree-studio", STATIC, max_time=max(file.stat().st_mtime for file in STATIC.iterdir()))


class PhotoBoard(Element, component=STATIC / "photo_board.js"):
    """All photos to be arranged, or one to draw on (``static/photo_board.mjs``)."""


class TreeViewer(Element, component=STATIC / "tree_viewer.js"):
    """The tree in space and everything on the way to it (``static/tree_viewer.mjs``)."""
