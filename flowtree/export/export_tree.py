"""Trees into the format that the file's ending names."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from flowtree import check
from flowtree.export.write_glb import write_glb
from flowtree.export.write_obj import write_obj
from flowtree.export.write_ply import write_ply
from flowtree.export.write_usd import USD_ENDINGS, import_usd, write_usd
from flowtree.model.asset import TreeAsset
from flowtree.model.tree import TreeModel
from flowtree.params import ExportParams

TREE_ENDINGS = (".glb", ".obj", ".ply", *USD_ENDINGS)


def export_tree(
    tree: TreeModel | TreeAsset,
    path: Path,
    *,
    params: ExportParams = ExportParams(),
    engine: str = "godot",
) -> tuple[Path, ...]:
    """Writes a tree as ``.glb``, ``.usda``, ``.usdc``, ``.usdz``, ``.obj`` or ``.ply``.

    GLB holds all of an asset, USD its levels and cards, OBJ and PLY the finest level.

    Args:
        tree: with or without levels, cards, wind and solid bodies.
        path: of the file; with ``separate_levels`` each level's name has ``_LOD0``, ``_LOD1``, … before the
            ending, where there are several.
        params: how it is stored.
        engine: whose names solid bodies get (see `name_bodies`).

    Returns: the files, without what lies beside them.

    Raises:
        InputError: another ending, a broken tree, or a parameter that this kind of file cannot follow.
        OutputError: a file could not be written; what stood there is untouched.
    """
    check_export(path, params)
    ending = path.suffix.lower()
    asset = tree if isinstance(tree, TreeAsset) else TreeAsset((tree,))
    written = []
    for suffix, part in _parts(asset) if params.separate_levels else [("", asset)]:
        file = path.with_name(f"{path.stem}{suffix}{path.suffix}")
        if ending == ".glb":
            write_glb(part, file, quantise=params.quantise, instanced=params.instanced, engine=engine)
        elif ending in USD_ENDINGS:
            write_usd(part, file)
        elif part.levels:  # the others have no place for cards
            (write_obj if ending == ".obj" else write_ply)(part.levels[0], file)
        else:
            continue
        written.append(file)
    return tuple(written)


def check_export(path: Path, params: ExportParams) -> None:
    """Refuses a file that could not be written in the end, before the work for it begins.

    Raises:
        InputError: another ending, a parameter that this kind of file cannot follow, or no usd-core for USD.
    """
    ending = path.suffix.lower()
    rule = f"must end in {', '.join(TREE_ENDINGS)}"
    check.require(ending in TREE_ENDINGS, f"tree {path.name}", rule, ending or "no ending", "rename it")
    for name in ("quantise", "instanced"):
        able = ending == ".glb" or not getattr(params, name)
        check.require(able, name, "needs a .glb file", ending, "name such a file, or leave it out")
    if ending in USD_ENDINGS:
        import_usd()


def _parts(asset: TreeAsset) -> Iterator[tuple[str, TreeAsset]]:
    """Each level and each card alone; solid bodies go with the finest."""
    if len(asset.levels) + len(asset.cards) == 1:
        yield "", asset
        return
    for k, level in enumerate(asset.levels):
        yield f"_LOD{k}", TreeAsset((level,), (), asset.winds[k : k + 1], None if k else asset.collision)
    for k, card in enumerate(asset.cards, len(asset.levels)):
        yield f"_LOD{k}", TreeAsset((), (card,))
