"""``flowtree render``: a picture of a finished tree."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flowtree.cli.outputs import check_distinct, check_output
from flowtree.cli.progress import show_progress


def render(
    tree: Annotated[Path, typer.Argument(help="A .glb that flowtree wrote.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="The picture: .png or .jpg.")] = Path(
        "view.png"
    ),
    yaw: Annotated[float, typer.Option(help="Where the camera stands [degrees].")] = 0.0,
    size: Annotated[
        int | None, typer.Option(help="Height and width of the picture [px].", show_default="render.size")
    ] = None,
    mask: Annotated[bool, typer.Option("--mask", help="Only how much of each pixel is tree.")] = False,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="One parameter; may be repeated.")
    ] = None,
) -> None:
    """Draw a tree with flowtree's own ray caster."""
    from flowtree.render.write_picture import PICTURE_ENDINGS, write_picture

    check_output(output, PICTURE_ENDINGS, "--output")
    check_distinct(tree, output)
    with show_progress() as progress:
        import numpy as np

        from flowtree.configuration import override_params
        from flowtree.export.read_glb import read_glb
        from flowtree.params import Params
        from flowtree.render.fit_camera import fit_camera
        from flowtree.render.render_mask import render_mask
        from flowtree.render.render_view import render_view

        sized = [] if size is None else [f"render.size={size}"]
        chosen = override_params(Params(), [*sized, *(assignments or ())]).render
        progress("reading", 0.0)
        model = read_glb(tree)
        progress("rendering", 0.2)
        camera = fit_camera(model, yaw, chosen.size)
        if mask:
            alpha = np.rint(render_mask(model, camera) * 255.0).astype(np.uint8)
            write_picture(alpha, output)
        else:
            write_picture(render_view(model, camera, params=chosen), output)
    typer.echo(str(output))
