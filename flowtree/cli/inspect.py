"""``flowtree inspect``: what a file holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer


def inspect(
    file: Annotated[Path, typer.Argument(help="A tree or a skeleton, ours or another program's.")],
    as_json: Annotated[bool, typer.Option("--json", help="For programs: everything, as JSON.")] = False,
) -> None:
    """Print what a file holds: bounds in metres, triangles, levels, joints, textures, what looks wrong."""
    from flowtree.export.inspect_file import inspect_file

    found = inspect_file(file)
    if as_json:
        typer.echo(json.dumps(found, indent=2, ensure_ascii=False))
        return
    typer.echo(f"{file}: {_kind(found)}, {_size(found['bytes'])}")
    for name, text in dict.fromkeys(_lines(found)):
        typer.echo(f"  {name:<12}{text}")
    for warning in found.get("warnings", []):
        typer.echo(f"  {'note':<12}{warning}")


def _kind(found: dict[str, Any]) -> str:
    generator = found.get("generator")
    return str(found["kind"]) + (f" by {generator}" if generator else "")


def _size(count: int | None) -> str:
    if count is None:
        return "outside the file"
    return f"{count / 1e6:.2f} MB" if count >= 1e6 else f"{count / 1e3:.1f} kB"


def _lines(found: dict[str, Any]) -> list[tuple[str, str]]:
    """Every fact with its name, most wanted first; what the file has none of is left out."""
    lines = []
    bounds = found.get("bounds")
    if bounds is not None:
        axes = zip("xyz", bounds["min"], bounds["max"], strict=True)
        lines.append(
            ("bounds", "  ".join(f"{axis} {low:.2f} to {high:.2f}" for axis, low, high in axes) + " m")
        )
    if found["kind"] == "skeleton":
        lines.append(
            ("branches", f"{found['branches']:,} in {found['orders']} orders, {found['nodes']:,} nodes")
        )
        lines.append(
            ("length", f"{found['total_length_m']:,.1f} m, trunk radius {found['trunk_radius_m']} m")
        )
        return lines
    closed = {True: "; the wood is closed", False: "; the wood is open", None: ""}[found.get("watertight")]
    lines.append(("triangles", f"{found['triangles']:,}{closed}"))
    levels = found.get("levels", [])
    lines += [("level", f"{level['name']}: {level['triangles']:,} triangles") for level in levels]
    lines += [("mesh", _mesh(mesh)) for mesh in found["meshes"]]
    if found.get("bodies"):
        triangles = sum(body["triangles"] for body in found["bodies"])
        names = ", ".join(body["name"] for body in found["bodies"][:2])
        lines.append(("bodies", f"{len(found['bodies'])} for physics, {triangles:,} triangles: {names} …"))
    for material in found.get("materials", []):
        sides = ", both sides" if material["double_sided"] else ""
        lines.append(("material", f"{material['name']}: {material['alpha_mode'].lower()}{sides}"))
    for texture in found.get("textures", []):
        size = "" if texture["width"] is None else f"{texture['width']} x {texture['height']}, "
        lines.append(("texture", f"{texture['name']}: {size}{_size(texture['bytes'])}"))
    lines += [("skin", f"{skin['joints']} joints") for skin in found.get("skins", [])]
    for motion in found.get("animations", []):
        lines.append(
            ("animation", f"{motion['name']}: {motion['seconds']:g} s, {motion['channels']} channels")
        )
    extensions = found.get("extensions", {})
    if extensions.get("used"):
        lines.append(("extensions", ", ".join(map(str, extensions["used"]))))
    return lines


def _mesh(mesh: dict[str, Any]) -> str:
    parts = [f"{mesh['triangles']:,} triangles", f"{mesh['vertices']:,} vertices"]
    if mesh.get("instances", 1) != 1:
        parts.append(f"{mesh['instances']:,} instances")
    if mesh.get("materials"):
        parts.append("material " + ", ".join(map(str, mesh["materials"])))
    usual = {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0", "COLOR_0"}
    more = [key for key in mesh.get("attributes", []) if key not in usual]
    if more:
        parts.append("with " + ", ".join(more))
    return f"{mesh['name']}: {', '.join(parts)}"
