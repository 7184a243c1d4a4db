"""What a USD file holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from flowtree import check


def inspect_usd(path: Path) -> dict[str, Any]:
    """Opens a stage of any origin with usd-core and lists what its default prim holds.

    Returns: ``{"kind", "bytes", "meshes": [{"name", "triangles", "vertices", "instances"}], "triangles",
        "levels": [{"name", "triangles", "vertices"}], "bounds": {"min", "max"} [m] or None, "warnings"}``; an
        instanced mesh counts as often as it stands there, polygons as the triangles they are cut into, and
        levels are the variants of a variant set ``LOD``.

    Raises:
        InputError: it cannot be read, or usd-core is not installed.
    """
    try:
        from pxr import Tf, Usd, UsdGeom
    except ImportError:
        check.fail("USD", "needs the package usd-core", "none", "run: pip install 'flowtree-3d[usd]'")
    check.require(path.is_file(), path.name, "must be a readable file", "none", "choose another file")
    try:
        stage = Usd.Stage.Open(str(path))
        root = stage.GetDefaultPrim() or stage.GetPseudoRoot()
        meshes = _meshes(root, UsdGeom)
        box = UsdGeom.BBoxCache(0, ["default", "render"]).ComputeWorldBound(root).ComputeAlignedRange()
        metres = UsdGeom.GetStageMetersPerUnit(stage)
        upward = str(UsdGeom.GetStageUpAxis(stage))
        levels = _levels(root, UsdGeom)
    except Tf.ErrorException:  # whose words are about usd-core's own source
        check.fail(path.name, "must be a well-formed file", "one that usd-core refuses", "export it again")
    bounds = None
    if not box.IsEmpty():
        low, high = (
            np.round(np.array(corner) * metres, 6).tolist() for corner in (box.GetMin(), box.GetMax())
        )
        bounds = {"min": low, "max": high}
    return {
        "kind": path.suffix.lower().lstrip("."),
        "bytes": path.stat().st_size,
        "meshes": meshes,
        "triangles": sum(mesh["triangles"] for mesh in meshes),
        "levels": levels,
        "bounds": bounds,
        "warnings": [] if upward == "Y" else [f"the {upward.lower()} axis points up"],
    }


def _meshes(root: Any, geom: Any) -> list[dict[str, Any]]:
    """Every mesh below a prim; those below a point instancer as often as it has instances."""
    meshes: list[dict[str, Any]] = []
    waiting = [(root, 1)]
    while waiting:
        prim, count = waiting.pop(0)
        if prim.IsA(geom.PointInstancer):
            count *= geom.PointInstancer(prim).GetInstanceCount()
        waiting += [(child, count) for child in prim.GetChildren()]
        if not prim.IsA(geom.Mesh):
            continue
        mesh = geom.Mesh(prim)
        corners = np.array(mesh.GetFaceVertexCountsAttr().Get() or [], np.int64)
        meshes.append(
            {
                "name": prim.GetName(),
                "triangles": int(np.maximum(corners - 2, 0).sum()) * count,
                "vertices": len(mesh.GetPointsAttr().Get() or []),
                "instances": count,
            }
        )
    return meshes


def _levels(root: Any, geom: Any) -> list[dict[str, Any]]:
    sets = root.GetVariantSets()
    if not sets.HasVariantSet("LOD"):
        return []
    chosen = sets.GetVariantSet("LOD")
    levels = []
    for name in chosen.GetVariantNames():
        chosen.SetVariantSelection(name)  # of the stage in memory alone
        meshes = _meshes(root, geom)
        counts = {key: sum(mesh[key] for mesh in meshes) for key in ("triangles", "vertices")}
        levels.append({"name": name, **counts})
    return levels
