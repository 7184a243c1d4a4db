"""``flowtree matte``: one photograph cut out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flowtree.cli.outputs import check_output
from flowtree.cli.progress import show_progress


def matte(
    photo: Annotated[Path, typer.Argument(help="A photo of the tree.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="The tree over nothing: .png with an alpha channel.")
    ] = Path("matte.png"),
    trimap: Annotated[Path | None, typer.Option(help="White tree, black background, grey unknown.")] = None,
    scribbles: Annotated[
        Path | None,
        typer.Option(
            help="Strokes: green on the tree, red on the background, blue on what stands before it."
        ),
    ] = None,
    params: Annotated[Path | None, typer.Option(help="Parameters, as `flowtree params` prints them.")] = None,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="One parameter; may be repeated.")
    ] = None,
) -> None:
    """Cut a tree out of its photo; the result can stand for the photo in `flowtree reconstruct`."""
    check_output(output, (".png",), "--output")
    with show_progress() as progress:
        import numpy as np

        from flowtree.configuration import load_params, override_params
        from flowtree.matting.extract_matte import extract_matte
        from flowtree.params import Params
        from flowtree.photos.load_photo import load_photo
        from flowtree.photos.read_picks import Picks, read_picks, with_picks
        from flowtree.photos.read_scribbles import read_scribbles
        from flowtree.photos.read_trimap import read_trimap
        from flowtree.render.write_picture import write_picture

        chosen = override_params(Params() if params is None else load_params(params), assignments or ())
        progress("photos", 0.0)
        picture = load_photo(photo, params=chosen.photos)
        progress("matting", 0.1)
        picks = Picks(strokes=False) if scribbles is None else read_picks(scribbles)
        cut = extract_matte(
            picture,
            trimap=None if trimap is None else read_trimap(trimap, picture, params=chosen.photos),
            scribbles=read_scribbles(scribbles, picture, params=chosen.photos)
            if scribbles is not None and picks.strokes
            else None,
            params=with_picks(chosen.matting, picks),
        )
        alpha = np.rint(cut.alpha * 255.0).astype(np.uint8)
        write_picture(np.dstack([cut.foreground, alpha]), output)
    typer.echo(f"{output}: {cut.method} matte, {cut.alpha.mean():.0%} of the picture is tree")
