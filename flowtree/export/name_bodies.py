"""A tree's solid bodies as the engines' importers expect them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.capsule_mesh import capsule_mesh
from flowtree.model.collision import Collision

#: Engines that `name_bodies` knows.
ENGINES = ("godot", "unity", "unreal")
Body = tuple[str, NDArray[np.float32], NDArray[np.int32]]


def name_bodies(collision: Collision, engine: str, *, tree: str, mesh: str) -> list[Body]:
    """Every capsule and the hull as a small convex mesh whose name says what it is.

    godot: ``<tree>_trunk_00-convcolonly`` and ``<tree>_crown-convcolonly``: the importer makes a static body
        with a convex shape of each and does not show it.
    unreal: ``UCX_<mesh>_00`` and on, the hull last: convex pieces of that mesh's simple collision. (Not
        ``UCP_``: of a capsule that leans the importer takes another than the mesh shows.)
    unity: ``<tree>_trunk_00_collider`` and ``<tree>_crown_collider``: its importers know no names; add a
        convex mesh collider to each and switch its renderer off.

    Args:
        collision: capsules, and a hull that may be empty.
        engine: one of `ENGINES`.
        tree: the tree's name.
        mesh: name of the wood's mesh, the finest level's.

    Returns: of each body its name, positions (n, 3) [m] and triangles (m, 3), counter-clockwise from outside.

    Raises:
        InputError: an unknown engine.
    """
    check.require(
        engine in ENGINES,
        "collision engine",
        f"must be one of {', '.join(ENGINES)}",
        repr(engine),
        check.nearest_name(engine, ENGINES),
    )
    pieces = [
        (f"trunk_{number:02d}", *capsule_mesh(ends, float(radius)))
        for number, (ends, radius) in enumerate(
            zip(collision.capsule_ends, collision.capsule_radius, strict=True)
        )
    ]
    if len(collision.hull_triangles):
        pieces.append(("crown", collision.hull_positions, collision.hull_triangles))
    return [
        (_name(engine, number, piece, tree, mesh), positions, triangles)
        for number, (piece, positions, triangles) in enumerate(pieces)
    ]


def _name(engine: str, number: int, piece: str, tree: str, mesh: str) -> str:
    if engine == "unreal":
        return f"UCX_{mesh}_{number:02d}"
    return f"{tree}_{piece}-convcolonly" if engine == "godot" else f"{tree}_{piece}_collider"
