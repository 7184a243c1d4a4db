"""A tree as USD, its leaves as a point instancer."""

from __future__ import annotations

import os
import re
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import __version__, check
from flowtree.export.check_asset import check_asset
from flowtree.export.encode_texture import encode_texture
from flowtree.export.mean_color import mean_color
from flowtree.export.tint_texture import tint_texture
from flowtree.files import write_all_whole
from flowtree.model.asset import TreeAsset
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel

USD_ENDINGS = (".usda", ".usdc", ".usdz")
# About the first day that a package can name, on the clock of wherever it is written.
_DAY = (1980, 1, 2, 0, 0, 0, 0, 0, -1)
_ENDINGS = {"image/png": "png", "image/jpeg": "jpg"}


def write_usd(tree: TreeModel | TreeAsset, path: Path) -> None:
    """Writes ``NAME.usda`` or ``NAME.usdc`` with its textures ``NAME_….png`` beside it, or one ``NAME.usdz``.

    Metres, y up. The default prim is a component with ``wood``, a mesh, and ``leaves``, a point instancer of
    one leaf; levels and cards are the variants ``LOD0``, ``LOD1``, … of its variant set ``LOD``. Materials
    are UsdPreviewSurface; that cannot multiply a texture with a colour, so the mean of the leaves' colours is
    multiplied into their picture, and each leaf's own stands in the instancer's ``displayColor``. Wind, solid
    bodies, and cards that need a shader of their own are left out.

    Raises:
        InputError: the tree is broken (see `check_asset`), or usd-core is not installed.
        OutputError: one of the files could not be written; what stood there is untouched, of all of them.
    """
    asset = tree if isinstance(tree, TreeAsset) else TreeAsset((tree,))
    check_asset(asset)
    if asset.levels:
        asset = replace(asset, cards=tuple(card for card in asset.cards if card.frames == 1))
    stem = re.sub(r"\W", "_", path.stem)
    with tempfile.TemporaryDirectory() as folder:
        beside = Path(folder)
        pictures = _Stage(asset, stem, beside).save(beside / f"{stem}.usdc", path)
        contents = {path.with_name(name): data for name, data in pictures.items()}
        contents[path] = (beside / f"whole{path.suffix.lower()}").read_bytes()
        write_all_whole(contents)


def import_usd() -> Any:
    """The modules of usd-core: loaded when a file is written, because few people have them.

    Raises:
        InputError: it is not installed.
    """
    try:
        from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdShade, UsdUtils, Vt
    except ImportError:
        check.fail("USD", "needs the package usd-core", "none", "run: pip install 'flowtree-3d[usd]'")
    return Gf, Kind, Sdf, Usd, UsdGeom, UsdShade, UsdUtils, Vt


class _Stage:
    """A stage while it grows, and the pictures beside it."""

    def __init__(self, asset: TreeAsset, stem: str, folder: Path) -> None:
        self._gf, kind, self._sdf, usd, self._geom, self._shade, self._utils, self._vt = import_usd()
        self._stem = stem
        self._pictures: dict[str, bytes] = {}
        self._bound: dict[str, Any] = {}
        self._folder = folder
        self._stage = usd.Stage.CreateInMemory()
        self._stage.GetRootLayer().comment = f"flowtree {__version__}"
        self._geom.SetStageUpAxis(self._stage, self._geom.Tokens.y)
        self._geom.SetStageMetersPerUnit(self._stage, 1.0)
        name = re.sub(r"\W", "_", (asset.levels or asset.cards)[0].name) or "Tree"
        name = f"_{name}" if name[0].isdigit() else name
        self._root = self._geom.Xform.Define(self._stage, f"/{name}").GetPrim()
        self._stage.SetDefaultPrim(self._root)
        usd.ModelAPI(self._root).SetKind(kind.Tokens.component)
        steps = len(asset.levels) + len(asset.cards)
        variants = self._root.GetVariantSets().AddVariantSet("LOD") if steps > 1 else None
        for k in range(steps):
            if variants is None:
                self._step(asset, k, "")
                continue
            variants.AddVariant(f"LOD{k}")
            variants.SetVariantSelection(f"LOD{k}")
            with variants.GetVariantEditContext():
                self._step(asset, k, f"_LOD{k}")
        if variants is not None:
            variants.SetVariantSelection("LOD0")

    def save(self, whole: Path, path: Path) -> dict[str, bytes]:
        """Writes the stage beside its pictures as ``whole`` with the path's ending; returns the pictures.

        In a package the pictures lie inside, and none are returned.
        """
        ending = path.suffix.lower()
        if ending != ".usdz":
            self._stage.GetRootLayer().Export(str(whole.with_name(f"whole{ending}")))
            return self._pictures
        self._stage.GetRootLayer().Export(str(whole))
        for name, data in self._pictures.items():
            whole.with_name(name).write_bytes(data)
        for file in whole.parent.iterdir():  # a package keeps the times of its files
            os.utime(file, (time.mktime(_DAY),) * 2)
        packed = whole.with_name("whole.usdz")
        made = self._utils.CreateNewUsdzPackage(self._sdf.AssetPath(str(whole)), str(packed))
        check.require(bool(made), path.name, "must become a package", "a failure of usd-core", "use .usdc")
        return {}

    def _step(self, asset: TreeAsset, k: int, suffix: str) -> None:
        """A level, or after the last of them a card."""
        root = self._root.GetPath()
        if k >= len(asset.levels):
            card = asset.cards[k - len(asset.levels)]
            self._mesh(f"{root}/card", card.mesh, card.material, f"card{suffix}")
            return
        tree = asset.levels[k]
        if len(tree.wood.triangles):
            self._mesh(f"{root}/wood", tree.wood, tree.bark, f"wood{suffix}")
        foliage = tree.foliage
        if foliage is not None and len(foliage.position) and len(foliage.leaf.triangles):
            self._leaves(f"{root}/leaves", foliage, f"leaves{suffix}")

    def _leaves(self, path: str, foliage: Foliage, material: str) -> None:
        vt, count = self._vt, len(foliage.position)
        instancer = self._geom.PointInstancer.Define(self._stage, path)
        tint = foliage.color.mean(axis=0, dtype=np.float64)
        leaf = replace(
            foliage.leaf, colors=np.broadcast_to(tint.astype(np.float32), foliage.leaf.positions.shape)
        )
        prototype = self._mesh(f"{path}/leaf", leaf, foliage.material, material)
        instancer.CreatePrototypesRel().SetTargets([prototype.GetPath()])
        instancer.CreateProtoIndicesAttr(vt.IntArray.FromNumpy(np.zeros(count, np.int32)))
        instancer.CreatePositionsAttr(self._vectors(foliage.position))
        turns = foliage.rotation / np.linalg.norm(foliage.rotation, axis=1, keepdims=True)
        # USD's half quaternions keep a leaf's direction to a tenth of a degree.
        instancer.CreateOrientationsAttr(vt.QuathArray.FromNumpy(turns.astype(np.float16)))
        instancer.CreateScalesAttr(self._vectors(np.repeat(foliage.scale[:, None], 3, axis=1)))
        colors = self._geom.PrimvarsAPI(instancer.GetPrim()).CreatePrimvar(
            "displayColor", self._sdf.ValueTypeNames.Color3fArray, self._geom.Tokens.vertex
        )
        colors.Set(self._vectors(foliage.color))
        boxes = instancer.ComputeExtentAtTime(0.0, 0.0)
        instancer.CreateExtentAttr(boxes)

    def _mesh(self, path: str, mesh: TreeMesh, material: Material, name: str) -> Any:
        vt, tokens = self._vt, self._geom.Tokens
        made = self._geom.Mesh.Define(self._stage, path)
        made.CreateSubdivisionSchemeAttr(tokens.none)
        made.CreateDoubleSidedAttr(material.double_sided)
        made.CreatePointsAttr(self._vectors(mesh.positions))
        made.CreateFaceVertexCountsAttr(vt.IntArray.FromNumpy(np.full(len(mesh.triangles), 3, np.int32)))
        made.CreateFaceVertexIndicesAttr(vt.IntArray.FromNumpy(mesh.triangles.reshape(-1).astype(np.int32)))
        made.CreateNormalsAttr(self._vectors(mesh.normals))
        made.SetNormalsInterpolation(tokens.vertex)
        made.CreateExtentAttr(
            self._vectors(np.stack([mesh.positions.min(axis=0), mesh.positions.max(axis=0)]))
        )
        tint = np.ones(3) if mesh.colors is None else mesh.colors.mean(axis=0, dtype=np.float64)
        made.CreateDisplayColorAttr(self._vectors((tint * mean_color(material))[None]))
        types = self._sdf.ValueTypeNames
        uvs = self._geom.PrimvarsAPI(made.GetPrim()).CreatePrimvar("st", types.TexCoord2fArray, tokens.vertex)
        # USD's texture coordinates start at the picture's lower edge.
        turned = mesh.uvs * np.array([1, -1], np.float32) + np.array([0, 1], np.float32)
        uvs.Set(vt.Vec2fArray.FromNumpy(turned.astype(np.float32)))
        self._shade.MaterialBindingAPI.Apply(made.GetPrim()).Bind(self._material(material, tint, name))
        return made

    def _vectors(self, rows: NDArray[Any]) -> Any:
        return self._vt.Vec3fArray.FromNumpy(np.ascontiguousarray(rows, np.float32))

    def _material(self, material: Material, tint: NDArray[np.float64], name: str) -> Any:
        """A material in the tint (3,), linear, in a scope of its own below the root."""
        shade, types = self._shade, self._sdf.ValueTypeNames
        scope = f"{self._root.GetPath()}/materials"
        self._geom.Scope.Define(self._stage, scope)
        made = shade.Material.Define(self._stage, f"{scope}/{name}")
        surface = self._shader(made, "surface", "UsdPreviewSurface")
        surface.CreateInput("metallic", types.Float).Set(0.0)
        surface.CreateInput("roughness", types.Float).Set(float(material.roughness))
        reader = self._shader(made, "st", "UsdPrimvarReader_float2")
        reader.CreateInput("varname", types.String).Set("st")
        masked = material.alpha_cutoff is not None
        pixels = material.base_color if masked else material.base_color[:, :, :3]
        color = self._texture(made, "color", tint_texture(pixels, tint), reader, masked=masked)
        surface.CreateInput("diffuseColor", types.Color3f).ConnectToSource(color.ConnectableAPI(), "rgb")
        if masked:
            surface.CreateInput("opacity", types.Float).ConnectToSource(color.ConnectableAPI(), "a")
            surface.CreateInput("opacityThreshold", types.Float).Set(float(material.alpha_cutoff or 0.0))
        if material.normal is not None:
            normal = self._texture(made, "normal", material.normal, reader, masked=False)
            normal.GetInput("sourceColorSpace").Set("raw")
            normal.CreateInput("scale", types.Float4).Set(self._gf.Vec4f(2, 2, 2, 1))
            normal.CreateInput("bias", types.Float4).Set(self._gf.Vec4f(-1, -1, -1, 0))
            surface.CreateInput("normal", types.Normal3f).ConnectToSource(normal.ConnectableAPI(), "rgb")
        output = surface.CreateOutput("surface", types.Token)
        made.CreateSurfaceOutput().ConnectToSource(output)
        return made

    def _shader(self, material: Any, name: str, kind: str) -> Any:
        shader = self._shade.Shader.Define(self._stage, f"{material.GetPath()}/{name}")
        shader.CreateIdAttr(kind)
        return shader

    def _texture(
        self, material: Any, name: str, pixels: NDArray[np.uint8], reader: Any, *, masked: bool
    ) -> Any:
        types = self._sdf.ValueTypeNames
        data, media = encode_texture(pixels, lossy=not masked)
        # Levels share their pictures.
        known = (file for file, other in self._pictures.items() if other == data)
        file = next(known, f"{self._stem}_{material.GetPrim().GetName()}_{name}.{_ENDINGS[media]}")
        self._pictures[file] = data
        texture = self._shader(material, name, "UsdUVTexture")
        texture.CreateInput("file", types.Asset).Set(self._sdf.AssetPath(f"./{file}"))
        texture.CreateInput("sourceColorSpace", types.Token).Set("sRGB")
        wrap = "clamp" if masked else "repeat"
        for axis in ("wrapS", "wrapT"):
            texture.CreateInput(axis, types.Token).Set(wrap)
        reader.CreateOutput("result", types.Float2)
        texture.CreateInput("st", types.Float2).ConnectToSource(reader.ConnectableAPI(), "result")
        texture.CreateOutput("rgb", types.Float3)
        if masked:
            texture.CreateOutput("a", types.Float)
        return texture
