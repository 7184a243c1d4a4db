"""Options that say what a tree's file shall hold: the same for every command that writes one."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from flowtree import check

if TYPE_CHECKING:
    from flowtree.model.asset import TreeAsset
    from flowtree.model.tree import TreeModel
    from flowtree.params import Params

MaxTriangles = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help="Triangles of the finest level; 0 leaves the tree as it is.",
        show_default="50000",
    ),
]
Levels = Annotated[
    int | None, typer.Option(metavar="N", help="Levels of detail in the file, 1 to 4.", show_default="1")
]
SeparateLevels = Annotated[
    bool, typer.Option("--separate-levels", help="A file for each level: NAME_LOD0, NAME_LOD1, …")
]
Impostor = Annotated[
    str | None, typer.Option(metavar="KIND", help="Cards for far away: crossed or octahedral.")
]
WindLayout = Annotated[
    str | None,
    typer.Option(
        "--wind",
        metavar="LAYOUT",
        help="What vertices carry for wind shaders: attributes, colors, godot, unity or unreal.",
    ),
]
Sway = Annotated[bool, typer.Option("--sway", help="Joints, and a looping motion of them (GLB).")]
Collision = Annotated[
    str | None,
    typer.Option(metavar="ENGINE", help="Bodies for physics, named for godot, unity or unreal (GLB)."),
]
Instanced = Annotated[
    bool, typer.Option("--instanced", help="One leaf and its places, not all leaves (GLB).")
]
Quantise = Annotated[bool, typer.Option("--quantise", help="Fewer bits a vertex, a smaller file (GLB).")]
Atlas = Annotated[bool, typer.Option("--atlas", help="Bark and leaf in one texture.")]
TextureSize = Annotated[
    int | None,
    typer.Option(metavar="PX", help="Longer side of a texture at most.", show_default="2048"),
]
Twig = Annotated[
    str | None,
    typer.Option(metavar="FILE", help="A drawn twig, the example for all: .svg, .json or .png."),
]


class Written(NamedTuple):
    """What was written.

    Attributes:
        files: without those that lie beside them.
        figures: of what is in them, for the report.
    """

    files: tuple[Path, ...]
    figures: dict[str, Any]


def asset_assignments(
    *,
    max_triangles: int | None = None,
    levels: int | None = None,
    separate_levels: bool = False,
    impostor: str | None = None,
    wind: str | None = None,
    sway: bool = False,
    collision: str | None = None,
    instanced: bool = False,
    quantise: bool = False,
    atlas: bool = False,
    texture_size: int | None = None,
    twig: str | None = None,
) -> list[str]:
    """The options that were given, as ``NAME=VALUE`` of the parameters they stand for."""
    given: Mapping[str, object] = {
        "asset.max_triangles": max_triangles,
        "asset.levels": levels,
        "asset.impostor": impostor,
        "asset.atlas": atlas or None,
        "asset.texture_size": texture_size,
        "wind.channels": wind,
        "wind.sway": sway or None,
        "collision.engine": collision,
        "export.separate_levels": separate_levels or None,
        "export.instanced": instanced or None,
        "export.quantise": quantise or None,
        "twigs.sketch": twig,
    }
    return [f"{name}={_toml(value)}" for name, value in given.items() if value is not None]


def _toml(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def check_wanted(output: Path, params: Params) -> None:
    """Refuses what could not be written in the end, before the work begins.

    Raises:
        InputError: a kind of file that cannot follow the parameters, or parameters that exclude each other.
    """
    from flowtree.export.export_tree import check_export

    check_export(output, params.export)
    moved = params.wind.sway or params.wind.channels != "none"
    rule = "cannot carry wind, which moves single vertices"
    both = params.export.instanced and moved
    check.require(not both, "instanced leaves", rule, "both", "leave out --instanced or --wind")


def write_asset(asset: TreeAsset, tree: TreeModel, output: Path, params: Params) -> Written:
    """Writes a tree as the parameters ask for.

    Args:
        asset: what is written.
        tree: the same at full detail.
        output: the file.
        params: of which ``export``, ``meshing`` and ``collision`` count.
    """
    from flowtree.export.export_tree import export_tree
    from flowtree.pipeline.build_report import asset_figures

    if params.meshing.surface == "quads" and len(asset.levels[0].wood.triangles) < len(tree.wood.triangles):
        reason = "fewer triangles than the quads' have been asked for, and only rings can be that few"
        typer.echo(f"note: {reason}; --max-triangles 0 keeps the quads", err=True)
    files = export_tree(asset, output, params=params.export, engine=params.collision.engine)
    sizes = {file.name: file.stat().st_size for file in files}
    return Written(files, {**asset_figures(asset), "files": sizes})


def print_tree(report: Mapping[str, Any], written: Written, more: str = "") -> None:
    """What came out, in a line: on stdout, warnings on stderr.

    Args:
        report: of the tree.
        written: its files.
        more: how good it is, in words.
    """
    for warning in report["warnings"]:
        typer.echo(f"note: {warning}", err=True)
    names = ", ".join(str(file) for file in written.files)
    triangles = ", ".join(str(level["triangles"]) for level in written.figures["levels"])
    size = sum(written.figures["files"].values()) / 1e6
    typer.echo(
        f"{names}: {report['skeleton']['branches']} branches, {report['leaves']} leaves; "
        f"{triangles} triangles, {size:.1f} MB{more}"
    )
