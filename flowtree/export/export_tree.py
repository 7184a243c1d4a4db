"""Trees into the format that the file's ending names."""

from __future__ import annotations

from pathlib import Path

from flowtree import check
from flowtree.export.write_glb import write_glb
from flowtree.export.write_obj import write_obj
from flowtree.export.write_ply import write_ply
from flowtree.model.tree import TreeModel

_WRITERS = {".glb": write_glb, ".obj": write_obj, ".ply": write_ply}
TREE_ENDINGS = tuple(_WRITERS)


def export_tree(tree: TreeModel, path: Path) -> None:
    """Writes a tree as ``.glb``, ``.obj`` (with materials and textures beside it) or ``.ply``.

    Raises:
        InputError: another ending, or a broken tree.
        OutputError: the file could not be written; what stood there is untouched.
    """
    ending = path.suffix.lower()
    rule = f"must end in {', '.join(TREE_ENDINGS)}"
    check.require(ending in _WRITERS, f"tree {path.name}", rule, ending or "no ending", "rename it")
    _WRITERS[ending](tree, path)
