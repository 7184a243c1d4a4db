"""``flowtree grow``: a skeleton in, a tree out."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from flowtree.cli import asset_options as wanted
from flowtree.cli.outputs import check_distinct, check_output
from flowtree.cli.progress import show_progress


def grow(
    skeleton: Annotated[Path, typer.Argument(help="Branches as lines: .swc, .csv (cylinders) or .json.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", help="The tree: .glb, .usdc, .obj, .ply …")
    ] = Path("tree.glb"),
    height: Annotated[
        float | None,
        typer.Option(help="To which the tree is scaled [m].", show_default="coordinates are metres"),
    ] = None,
    up: Annotated[str, typer.Option(metavar="AXIS", help="Which axis points to the sky: y or z.")] = "y",
    seed: Annotated[int, typer.Option(help="Other twigs and leaves.")] = 0,
    twigs: Annotated[
        bool | None,
        typer.Option(
            "--twigs/--no-twigs", help="Add twigs.", show_default="where the skeleton has none of ours"
        ),
    ] = None,
    leaves: Annotated[bool, typer.Option("--leaves/--no-leaves", help="Add leaves.")] = True,
    params: Annotated[Path | None, typer.Option(help="Parameters, as `flowtree params` prints them.")] = None,
    assignments: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="One parameter; may be repeated, the last one counts."
        ),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="What was made and repaired: .json.")] = None,
    max_triangles: wanted.MaxTriangles = None,
    levels: wanted.Levels = None,
    separate_levels: wanted.SeparateLevels = False,
    impostor: wanted.Impostor = None,
    wind: wanted.WindLayout = None,
    sway: wanted.Sway = False,
    collision: wanted.Collision = None,
    instanced: wanted.Instanced = False,
    quantise: wanted.Quantise = False,
    atlas: wanted.Atlas = False,
    texture_size: wanted.TextureSize = None,
    twig: wanted.Twig = None,
) -> None:
    """Give a skeleton wood, twigs and leaves; radii too, where it has none.

    The skeleton may come from any program; what is wrong with it is repaired and said, or refused. The kind
    of output follows the file's ending.
    """
    from flowtree.export.export_tree import TREE_ENDINGS

    check_output(output, TREE_ENDINGS, "--output")
    check_output(report, (".json",), "--report")
    check_distinct(skeleton, output, report)
    with show_progress() as progress:
        from flowtree.configuration import load_params, override_params
        from flowtree.export.read_skeleton import read_skeleton
        from flowtree.files import write_whole
        from flowtree.params import Params
        from flowtree.pipeline.build_report import report_bytes
        from flowtree.pipeline.grow_tree import grow_tree

        given = wanted.asset_assignments(
            max_triangles=max_triangles,
            levels=levels,
            separate_levels=separate_levels,
            impostor=impostor,
            wind=wind,
            sway=sway,
            collision=collision,
            instanced=instanced,
            quantise=quantise,
            atlas=atlas,
            texture_size=texture_size,
            twig=twig,
        )
        settings = [*(assignments or []), *([] if leaves else ["leaves.bear=never"]), *given]
        chosen = override_params(Params() if params is None else load_params(params), settings)
        wanted.check_wanted(output, chosen)
        progress("reading", 0.0)
        drawn = read_skeleton(skeleton)
        axis: Literal["y", "z"] = up  # type: ignore[assignment]  # checked where it is used
        grown = grow_tree(
            drawn, height=height, up=axis, twigs=twigs, params=chosen, seed=seed, progress=progress
        )
        written = wanted.write_asset(grown.asset, grown.tree, output, chosen)
        if report is not None:
            write_whole(report, report_bytes({**grown.report, "asset": written.figures}))
    wanted.print_tree(grown.report, written)
