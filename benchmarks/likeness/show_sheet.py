"""Contact sheets of what was measured."""

from __future__ import annotations

from benchmarks.likeness.bench import Bench
from flowtree.pipeline.reconstruct import Reconstruction
from flowtree.render.render_sheet import render_sheet
from flowtree.render.write_picture import write_picture


def show_sheet(bench: Bench, name: str, made: Reconstruction) -> None:
    """Writes ``NAME.jpg`` into the bench's folder, if it has one."""
    if bench.folder is None:
        return
    sheet = render_sheet(
        made.photos,
        made.mattes,
        made.cameras,
        made.graphs,
        made.tree,
        scores=[view["soft_iou"] for view in made.report["views"]],
        params=bench.params.render,
    )
    write_picture(sheet, bench.folder / f"{name}.jpg", quality=85)
