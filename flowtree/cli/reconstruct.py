"""``flowtree reconstruct``: photographs in, a tree out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from flowtree import check
from flowtree.cli import asset_options as wanted
from flowtree.cli.outputs import check_distinct, check_new_folder, check_output
from flowtree.cli.per_photo import parse_yaws, per_photo
from flowtree.cli.progress import show_progress

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from flowtree.params import RenderParams
    from flowtree.pipeline.reconstruct import Reconstruction
    from flowtree.project.project import Project

_PER_PHOTO = "May be repeated: the k-th belongs to the k-th photo, or 1=FILE names the photo (from 0)."


def reconstruct(
    photos: Annotated[
        list[Path] | None, typer.Argument(help="Photos of one tree.", show_default=False)
    ] = None,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="The tree: .glb, .usdc, .obj, .ply …")
    ] = Path("tree.glb"),
    yaw: Annotated[str | None, typer.Option(help="From where each photo was taken [degrees]: 0,90.")] = None,
    height: Annotated[float | None, typer.Option(help="Of the tree [m].", show_default="10")] = None,
    seed: Annotated[
        int | None, typer.Option(help="Another seed, a similar, different tree.", show_default="0")
    ] = None,
    strokes: Annotated[
        list[str] | None,
        typer.Option(
            help="Drawn branches: .svg, .json or .png; a .json may also say where foot, top, first fork and "
            "branch tips are, and roll [degrees], distance [m] and focal_length [mm on 36 x 24 film] of the "
            f"photo. {_PER_PHOTO}"
        ),
    ] = None,
    trimap: Annotated[
        list[str] | None, typer.Option(help=f"White tree, black background, grey unknown. {_PER_PHOTO}")
    ] = None,
    scribbles: Annotated[
        list[str] | None,
        typer.Option(
            help=f"Strokes: green on the tree, red beside it, blue on what is before it. {_PER_PHOTO}"
        ),
    ] = None,
    paint: Annotated[
        list[str] | None, typer.Option(help=f"Density added, erased, redirected. {_PER_PHOTO}")
    ] = None,
    params: Annotated[Path | None, typer.Option(help="Parameters, as `flowtree params` prints them.")] = None,
    assignments: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="NAME=VALUE", help="One parameter; may be repeated, the last one counts."
        ),
    ] = None,
    skeleton: Annotated[
        Path | None, typer.Option(help="The branches as lines: .swc, .csv, .ply or .json.")
    ] = None,
    preview: Annotated[
        Path | None, typer.Option(help="A contact sheet of photos, mattes and tree: .png or .jpg.")
    ] = None,
    report: Annotated[Path | None, typer.Option(help="What was measured: .json.")] = None,
    project: Annotated[
        Path | None,
        typer.Option(
            help="A folder that keeps photos and settings; with photos it is written, without read."
        ),
    ] = None,
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
    """Make a tree from one or more photographs of it.

    The kind of output follows the file's ending. One photo alone is completed by its mirror image. With
    --project and no photos, the project's tree is made; options then change this run, not the project.
    """
    from flowtree.export.export_skeleton import SKELETON_ENDINGS, export_skeleton
    from flowtree.export.export_tree import TREE_ENDINGS
    from flowtree.files import write_whole
    from flowtree.render.write_picture import PICTURE_ENDINGS, write_picture

    check_output(output, TREE_ENDINGS, "--output")
    check_output(skeleton, SKELETON_ENDINGS, "--skeleton")
    check_output(preview, PICTURE_ENDINGS, "--preview")
    check_output(report, (".json",), "--report")
    check_distinct(output, skeleton, preview, report)
    if photos and project is not None:
        check_new_folder(project)
    if not photos and project is None:
        raise typer.BadParameter("name at least one photo, or --project", param_hint="PHOTOS")
    with show_progress() as progress:
        from flowtree.pipeline.build_report import report_bytes
        from flowtree.project.reconstruct_project import reconstruct_project
        from flowtree.project.save_project import save_project

        files = {"strokes": strokes, "trimap": trimap, "scribbles": scribbles, "paint": paint}
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
        settings = [*(assignments or []), *given]
        work = _gather(photos or [], project, yaw, height, seed, params, settings, files)
        wanted.check_wanted(output, work.params)
        result = reconstruct_project(work, progress=progress)
        if photos and project is not None:
            save_project(work, project)
        written = wanted.write_asset(result.asset, result.tree, output, work.params)
        if skeleton is not None:
            export_skeleton(result.skeleton, skeleton)
        if preview is not None:
            write_picture(draw_preview(result, work.params.render), preview)
        if report is not None:
            write_whole(report, report_bytes({**result.report, "asset": written.figures}))
    print_result(result.report, written)


def draw_preview(result: Reconstruction, params: RenderParams) -> NDArray[np.uint8]:
    """The contact sheet of a reconstruction: (h, w, 3) uint8 sRGB."""
    from flowtree.render.render_sheet import render_sheet

    scores = [view["soft_iou"] for view in result.report["views"]]
    return render_sheet(
        result.photos,
        result.mattes,
        result.cameras,
        result.graphs,
        result.tree,
        scores=scores,
        params=params,
    )


def print_result(report: dict[str, Any], written: wanted.Written) -> None:
    """What came out, in a few lines: the file on stdout, warnings on stderr."""
    scores = ", ".join(f"{view['soft_iou']:.2f}" for view in report["views"])
    wanted.print_tree(report, written, f"; soft IoU with the photos {scores}")


def _gather(
    photos: list[Path],
    folder: Path | None,
    yaw: str | None,
    height: float | None,
    seed: int | None,
    params_file: Path | None,
    assignments: list[str],
    files: dict[str, list[str] | None],
) -> Project:
    """The project to work on: made from the options, or read and changed by them."""
    from dataclasses import replace

    from flowtree.configuration import load_params, override_params
    from flowtree.project.load_project import load_project
    from flowtree.project.project import Project

    if photos:
        known = Project(photos=tuple(photos))
    else:
        check.require(folder is not None, "photos", "must be at least one", "none", "name a photo")
        known = load_project(Path(str(folder)))
    count = len(known.photos)
    params = known.params if params_file is None else load_params(params_file)
    return replace(
        known,
        yaws=known.yaws if yaw is None else parse_yaws(yaw),
        height=known.height if height is None else height,
        seed=known.seed if seed is None else seed,
        params=override_params(params, assignments),
        strokes={**known.strokes, **per_photo(files["strokes"], count, "--strokes")},
        trimaps={**known.trimaps, **per_photo(files["trimap"], count, "--trimap")},
        scribbles={**known.scribbles, **per_photo(files["scribbles"], count, "--scribbles")},
        paint={**known.paint, **per_photo(files["paint"], count, "--paint")},
    )
