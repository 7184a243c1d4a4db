"""``flowtree demo``: a tree from the bundled pair of pictures."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer

from flowtree.cli.asset_options import write_asset
from flowtree.cli.outputs import check_folder
from flowtree.cli.progress import show_progress
from flowtree.cli.reconstruct import draw_preview, print_result

_PAIR = ("photo_0.jpg", "photo_1.jpg")
_HEIGHT = 11.0  # [m], of the tree in the pictures


def demo(
    output: Annotated[Path, typer.Option("-o", "--output", help="A folder for the results.")] = Path(
        "flowtree-demo"
    ),
) -> None:
    """Make a tree from two bundled pictures: tree.glb, preview.png and report.json."""
    start = time.perf_counter()
    with show_progress() as progress:
        from flowtree.errors import OutputError
        from flowtree.files import write_whole
        from flowtree.params import Params
        from flowtree.pipeline.build_report import report_bytes
        from flowtree.pipeline.reconstruct import reconstruct
        from flowtree.render.write_picture import write_picture

        try:
            output.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = f"{output}: no folder can be made there: {error.strerror}; name another with -o"
            raise OutputError(reason) from error
        check_folder(output)
        pictures = [Path(__file__).parent / "demo" / name for name in _PAIR]
        result = reconstruct(pictures, yaws=(0.0, 90.0), height=_HEIGHT, progress=progress)
        tree, preview, report = (output / name for name in ("tree.glb", "preview.png", "report.json"))
        params = Params()
        written = write_asset(result.asset, result.tree, tree, params)
        write_picture(draw_preview(result, params.render), preview)
        write_whole(report, report_bytes({**result.report, "asset": written.figures}))
    typer.echo(f"Two pictures of a tree, from {' and '.join(str(picture) for picture in pictures)}")
    print_result(result.report, written)
    typer.echo(f"{preview}: a contact sheet: what came in, and the tree beside it")
    typer.echo(f"{report}: what was measured")
    typer.echo(f"in {time.perf_counter() - start:.1f} s")
