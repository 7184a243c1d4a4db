"""A tree as one binary glTF 2.0 file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from flowtree import check
from flowtree.export.check_asset import check_asset
from flowtree.export.glb_builder import GlbBuilder
from flowtree.export.glb_materials import GlbMaterials
from flowtree.export.glb_parts import GlbParts
from flowtree.export.glb_skin import add_animation, add_skin
from flowtree.export.glb_vertices import Frame, frame_around
from flowtree.export.merge_leaves import merge_leaves
from flowtree.export.name_bodies import name_bodies
from flowtree.files import write_whole
from flowtree.model.asset import Card, TreeAsset
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.tree import TreeModel
from flowtree.model.wind import Armature, Sway

# Each level is shown down to a quarter of the screen's area at which the one before it ends; the last always.
_COVERAGE, _COVERAGE_RATIO = 0.25, 0.25


def write_glb(
    tree: TreeModel | TreeAsset,
    path: Path,
    *,
    quantise: bool = False,
    instanced: bool = False,
    engine: str = "godot",
) -> None:
    """Writes a tree as binary glTF: metres, y up, the foot at the origin (glTF 2.0, section 3.4).

    See `encode_glb` for what is inside.

    Raises:
        InputError: the tree is broken (see `check_asset`) or larger than the format allows.
        OutputError: the file could not be written; what stood there is untouched.
    """
    write_whole(path, encode_glb(tree, quantise=quantise, instanced=instanced, engine=engine))


def encode_glb(
    tree: TreeModel | TreeAsset,
    *,
    quantise: bool = False,
    instanced: bool = False,
    engine: str = "godot",
) -> bytes:
    """The bytes of the GLB file; the same tree always gives the same ones.

    Nodes: ``<name>`` with the children ``<name>_wood`` and, unless the tree is bare, ``<name>_leaves``, each
    with a mesh. With several levels or cards those stand below ``<name>_LOD0``, ``<name>_LOD1``, … instead;
    the scene to show holds level 0, which names the others (MSFT_lod), and each of them is a scene of its own
    for programs that do not know that extension; an octahedral card, which needs a shader of its own, stands
    only there. Skinned meshes are roots of the scene, as glTF wants them,
    and name their own next levels.

    All leaves are one mesh (Blender makes an object of every instance). Opaque pictures and normal maps are
    JPEG, those with alpha PNG.

    Args:
        tree: with or without levels, cards, wind and collision.
        quantise: store places in 16 and directions in 8 bits (KHR_mesh_quantization): two thirds of the file,
            for programs that read it.
        instanced: store one leaf and the leaves' places (EXT_mesh_gpu_instancing), for programs that read it.
        engine: whose names solid bodies get (see `name_bodies`).

    Raises:
        InputError: the tree is broken (see `check_asset`) or larger than the format allows, or leaves shall
            be instanced and carry wind.
    """
    asset = tree if isinstance(tree, TreeAsset) else TreeAsset((tree,))
    check_asset(asset)
    moved = any(wind.armature is not None or wind.leaves for wind in asset.winds)
    rule = "cannot carry wind, which moves single vertices"
    check.require(
        not (instanced and moved), "instanced leaves", rule, "both", "leave out --instanced or --wind"
    )
    return _Writer(asset, quantise=quantise, instanced=instanced).encode(engine)


class _Writer:
    """One asset on its way into one file."""

    def __init__(self, asset: TreeAsset, *, quantise: bool, instanced: bool) -> None:
        self._asset = asset
        self._leaves = [None if instanced else _merged(level) for level in asset.levels]
        self._builder = GlbBuilder()
        self._frame = _cube(asset, self._leaves) if quantise else None
        self._parts = GlbParts(self._builder, GlbMaterials(self._builder, _materials(asset)), self._frame)
        self._armatures: list[tuple[Armature, int, list[int]]] = []
        name = asset.levels[0].name if asset.levels else asset.cards[0].name
        self._name = name.encode("utf-8", "replace").decode() or "Tree"
        steps = len(asset.levels) + len(asset.cards)
        self._steps = [self._name] if steps == 1 else [f"{self._name}_LOD{k}" for k in range(steps)]

    def encode(self, engine: str) -> bytes:
        """The whole file."""
        asset, builder = self._asset, self._builder
        below: list[int] = []
        root = builder.add("nodes", {"name": self._name, "children": below, "extras": _extras(asset)})
        parts = [self._level(k) for k in range(len(asset.levels))]
        cards = [self._card(k, card) for k, card in enumerate(asset.cards, len(asset.levels))]
        if self._armatures:
            below += [joints[0] for _, _, joints in self._armatures]
            chains = [[level["wood"] for level in parts if "wood" in level]]
            chains += [[level["leaves"] for level in parts if "leaves" in level]]
            chains[0 if chains[0] else 1] += self._plain(cards)
            scenes = [[root, *level.values()] for level in parts]
        elif len(self._steps) == 1:
            below += parts[0].values() if parts else cards
            cards = []
            chains, scenes = [], [[root]]
        else:
            groups = [
                builder.add("nodes", {"name": step, "children": list(level.values())})
                for step, level in zip(self._steps, parts, strict=False)
            ]
            below.append(groups[0])
            chains, scenes = [groups + self._plain(cards)], [[root], *([group] for group in groups[1:])]
        for chain in chains:
            self._link(chain)
        if asset.collision is not None:
            mesh = f"{self._steps[0]}_wood"
            bodies = name_bodies(asset.collision, engine, tree=self._name, mesh=mesh)
            below += [self._parts.add_body(*body) for body in bodies]
        if not below:
            del builder.entry("nodes", root)["children"]
        names = [self._name, *self._steps[1:]]
        for name, nodes in zip(names, scenes + [[card] for card in cards], strict=True):
            # three.js renames a node that is called as its scene.
            builder.add("scenes", {"name": f"{name}_scene", "nodes": nodes})
        return builder.finish()

    def _level(self, k: int) -> dict[str, int]:
        """The nodes of one level: its wood, its leaves, as far as there are any."""
        level, step = self._asset.levels[k], self._steps[k]
        wind = self._asset.winds[k] if self._asset.winds else None
        skin = None if wind is None or wind.armature is None else self._skin(wind.armature, wind.sway)
        nodes: dict[str, int] = {}
        if len(level.wood.triangles):
            more = wind.wood if wind is not None else None
            nodes["wood"] = self._parts.add_mesh(
                f"{step}_wood", level.wood, level.bark, attributes=more, skin=skin
            )
        foliage = _grown(level)
        if foliage is None:
            return nodes
        merged = self._leaves[k]
        if merged is None:
            nodes["leaves"] = self._parts.add_instances(f"{step}_leaves", foliage)
        else:
            more = wind.leaves if wind is not None else None
            nodes["leaves"] = self._parts.add_mesh(
                f"{step}_leaves", merged, foliage.material, attributes=more, skin=skin
            )
        return nodes

    def _card(self, k: int, card: Card) -> int:
        name = self._steps[k] if len(self._steps) > 1 else f"{self._name}_card"
        node = self._parts.add_mesh(name, card.mesh, card.material)
        self._builder.entry("nodes", node)["extras"] = {"impostor": card.name, "frames": card.frames}
        return node

    def _plain(self, cards: list[int]) -> list[int]:
        """Those that show the tree as they are: a map of many pictures needs a shader of its own."""
        return [node for node, card in zip(cards, self._asset.cards, strict=True) if card.frames == 1]

    def _skin(self, armature: Armature, sway: Sway | None) -> int:
        """The skin of a level; levels with the same joints share theirs, and with it the motion."""
        for other, skin, _ in self._armatures:
            if np.array_equal(other.points, armature.points) and np.array_equal(
                other.parent, armature.parent
            ):
                return skin
        skin, joints = add_skin(self._builder, self._steps[len(self._armatures)], armature, self._frame)
        self._armatures.append((armature, skin, joints))
        if sway is not None:
            add_animation(self._builder, sway, joints)
        return skin

    def _link(self, nodes: list[int]) -> None:
        """Has the first node name the others as its coarser levels (MSFT_lod)."""
        if len(nodes) < 2:
            return
        self._builder.use("MSFT_lod")
        entry = self._builder.entry("nodes", nodes[0])
        entry["extensions"] = {"MSFT_lod": {"ids": nodes[1:]}}
        ends = [_COVERAGE * _COVERAGE_RATIO**k for k in range(len(nodes) - 1)]
        entry["extras"] = {"MSFT_screencoverage": [*ends, 0.0]}


def _extras(asset: TreeAsset) -> dict[str, Any]:
    """What the tree's node says of it."""
    if not asset.levels:
        return {"height": float(asset.cards[0].mesh.positions[:, 1].max())}
    first = asset.levels[0]
    leaves = 0 if first.foliage is None else len(first.foliage.position)
    return {"height": float(first.height), "leaves": leaves}


def _grown(level: TreeModel) -> Foliage | None:
    """The leaves, if there is anything of them to see."""
    foliage = level.foliage
    return foliage if foliage is not None and len(foliage.position) and len(foliage.leaf.triangles) else None


def _merged(level: TreeModel) -> TreeMesh | None:
    foliage = _grown(level)
    return None if foliage is None else merge_leaves(foliage)


def _materials(asset: TreeAsset) -> list[Material]:
    """What will be laid on something, in the order in which it is."""
    used: list[Material] = []
    for level in asset.levels:
        used += [level.bark] if len(level.wood.triangles) else []
        foliage = _grown(level)
        used += [] if foliage is None else [foliage.material]
    return used + [card.material for card in asset.cards]


def _cube(asset: TreeAsset, leaves: Sequence[TreeMesh | None]) -> Frame:
    meshes = [level.wood for level in asset.levels] + [card.mesh for card in asset.cards]
    places = [mesh.positions for mesh in (*meshes, *leaves) if mesh is not None and len(mesh.positions)]
    # Leaves that are instanced are the only ones that need no frame, and may be all there is.
    return frame_around(places or [np.zeros((1, 3), np.float32)])
