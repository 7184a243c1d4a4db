"""Contact sheets of what was measured."""

from __future__ import annotations

from benchmarks.likeness.bench import Bench
from flowtree.params import RenderParams
from flowtree.pipeline.reconstruct import Reconstruction
from flowtree.render.render_sheet import render_sheet
from flowtree.render.write_picture import write_picture

_PARAMS = RenderParams(size=520)


def show_sheet(bench: Bench, name: str, made: Reconstruction) -> None:
    """Writes ``NAME.jpg`` into the bench's folder, if it has one."""
    if bench.folder is not None:
        sheet = render_sheet(made.photos, made.mattes, made.cameras, made.graphs, made.tree, params=_PARAMS)
        write_picture(sheet, bench.folder / f"{name}.jpg", quality=85)
