"""A tree in several levels of detail."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.spread_order import spread_order
from flowtree.levels.drop_backs import drop_backs
from flowtree.levels.rank_branches import BranchRank, rank_branches
from flowtree.levels.share_triangles import share_triangles
from flowtree.levels.simplify_leaf import simplify_leaf
from flowtree.levels.spray_leaf import spray_leaf
from flowtree.levels.thin_leaves import thin_leaves
from flowtree.levels.thin_skeleton import thin_skeleton
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.meshing.weld_thin_wood import THIN, weld_thin_wood
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from flowtree.params import MeshingParams
from flowtree.pipeline.show_twigs import CARDS, show_twigs

_MOST_LEVELS = 4
_NEXT = 0.8  # of level 0's triangles, in level 1
_FEWER = 0.9  # of the triangles of the level before, in any level
_FAR, _FAR_SHARE = 4000, 15  # level 2: triangles at most, and how many times fewer than in level 0
_FARTHEST = 4  # times fewer in level 3 than in level 2
_LEAST = 64  # triangles, which may become fewer no more
_COARSEST = {"sides": 3, "tolerance": 0.2}  # of meshing, for a trunk that is too fine for its budget
_NEAR_ENOUGH = 0.94  # of the wood's triangles: more than this are used where there are branches left
_TRIES, _SETTLED = 8, 1
_REFINED, _ROOMY, _EVEN = 5, 1.1, 0.02  # tries at most, room and surface [shares] with which they end
_FEWEST, _USUAL = 1, 3  # triangles of a branch
_SPRAYED, _LARGEST_SPRAY = 2.2, 12  # leaves for each that is kept, from which on a card shows many; at most
_LOST = 1.2  # by which the surface of coarse wood is usually less than it was
_MOST_SHARE = 1.6
# What a file holds of wood, thin wood welded, and how much of it a triangle of the budget stands for: of
# 49,000 the file stays below 4 MB.
_VERTEX_BYTES, _TRIANGLE_BYTES, _BYTES = 45, 12, 71
_CARDED = 2  # the level from which on twigs of bare trees are shown on cards
_CARDS = 3 * 2 * CARDS  # triangles of these, at most
_LIMBS = 3 * _CARDS  # triangles beside them, at least
_LIMB_TOLERANCE = 0.01  # of meshing, with which it is found how many limbs fit beside the cards
_ENOUGH = 0.9  # of the surface: with less of it, fewer branches that are thick enough are likelier


@dataclass(frozen=True)
class _Wood:
    """A level's wood: ``surface`` [m²] counts both sides of its blades, of which the mesh may have one."""

    branches: int
    skeleton: Skeleton
    moved: NDArray[np.int32]
    mesh: TreeMesh
    surface: float
    blades: bool

    @property
    def cost(self) -> int:
        """Triangles of the budget that it takes up: more than it has, where they share few vertices."""
        stored = _VERTEX_BYTES * len(self.mesh.positions) + _TRIANGLE_BYTES * len(self.mesh.triangles)
        return max(len(self.mesh.triangles), -(-stored // _BYTES))


def build_levels(
    tree: TreeModel,
    *,
    max_triangles: int = 49_000,
    count: int = 4,
    meshing: MeshingParams = MeshingParams(),
    seed: int = 0,
    device: str | None = None,
) -> tuple[TreeModel, ...]:
    """Makes levels of detail from the tree's skeleton and leaves, the finest first.

    Level 0 has ``max_triangles`` at most, and is the tree itself where that fits; level 1 has 80 % of them,
    level 2 a fifteenth and 4,000 at most, level 3 a quarter of that; none need have less than 64. Wood whose
    triangles share few vertices gets fewer of them, so that files stay small. The wood is swept anew, with
    fewer sides and rings, the thinnest twigs flat, and where that is not enough, fewer and thicker twigs
    (`thin_skeleton`); there are fewer and larger leaves (`thin_leaves`) of fewer triangles (`simplify_leaf`),
    or where they would be far larger, sprays of small ones (`spray_leaf`). Of trees without leaves levels 2
    and 3 have the same limbs, and cards that show all else (`show_twigs`). Level 0's wood is closed; of flat
    twigs of the others one side is left out, for a material of two sides (`drop_backs`). A branch or leaf of
    a level is in all finer ones, too. Leaves of branches that are gone belong to the node where these began.

    Args:
        tree: with its skeleton.
        max_triangles: of level 0; 0 leaves it as it is.
        count: of levels, 1 to 4.
        meshing: how the tree's wood was made.
        seed: which of many equal twigs and leaves are kept.
        device: to run on.

    Raises:
        InputError: a budget too small for the trunk, a number of levels out of range.
    """
    check.require(
        1 <= count <= _MOST_LEVELS, "levels", f"must be 1 to {_MOST_LEVELS}", count, "ask for fewer levels"
    )
    check.require(max_triangles >= 0, "max_triangles", "must be 0 or more", max_triangles, "give another")
    whole = _triangles(tree)
    finest = min(max_triangles, whole) if max_triangles else whole
    far = min(_FAR, finest // _FAR_SHARE)
    least = min(_LEAST, finest)
    budgets = [max(most, least) for most in (finest, int(_NEXT * finest), far, far // _FARTHEST)[:count]]
    if count == 1 and whole <= finest:
        return (tree,)
    rank = rank_branches(tree.skeleton, seed=seed)
    foliage = tree.foliage
    order = None if foliage is None else spread_order(foliage.position, seed=seed)
    levels: list[TreeModel] = []
    coarsest = far // _FARTHEST
    carded = foliage is None and tree.wood.node is not None and _LIMBS + _CARDS <= coarsest < whole
    limbs, twigs = tree, None
    for number, budget in enumerate(budgets):
        if whole <= budget:
            levels.append(tree)
            continue
        if carded and number == _CARDED:
            limbs, twigs = _share_out(tree, levels[0], coarsest - _CARDS, rank, meshing, device)
        if twigs is not None:
            levels.append(_limbs_and_twigs(limbs, twigs, budget, meshing, device))
            continue
        level = _build_level(tree, budget, rank, order, meshing, bool(levels), device)
        while levels and budget > least and _triangles(level) > _FEWER * _triangles(levels[-1]):
            # Where all branches fit, a smaller budget may have been used better.
            budget = max(int(_FEWER * budget), least)
            level = _build_level(tree, budget, rank, order, meshing, True, device)
        levels.append(level)
    return tuple(levels)


def _triangles(tree: TreeModel) -> int:
    foliage = tree.foliage
    leaves = 0 if foliage is None else len(foliage.position) * len(foliage.leaf.triangles)
    return len(tree.wood.triangles) + leaves


def _build_level(
    tree: TreeModel,
    budget: int,
    rank: BranchRank,
    order: NDArray[np.int64] | None,
    meshing: MeshingParams,
    sheets: bool,
    device: str | None,
) -> TreeModel:
    foliage = tree.foliage if tree.foliage is not None and len(tree.foliage.position) else None
    shapes = [] if foliage is None else _leaf_shapes(foliage)
    fewest = 0 if foliage is None else len(foliage.position) * len(shapes[-1].triangles)
    shares = share_triangles(budget, branches=len(rank.fork), leaves=fewest, sides=meshing.sides)
    params = meshing.model_copy(update={"sides": shares.sides, "tolerance": shares.tolerance})
    thickening = shares.thickening * tree.height
    fitted = _fit_wood(tree, rank, shares.wood, thickening, params, sheets, device)
    wood = fitted.mesh
    check.require(
        len(wood.triangles) <= budget,
        "max_triangles",
        f"must be at least {len(wood.triangles)}, for the trunk alone",
        budget,
        "allow more triangles or fewer levels",
    )
    if foliage is not None and order is not None:
        left = budget - len(wood.triangles)
        fits = (leaf for leaf in shapes if len(leaf.triangles) * len(order) <= left)
        leaf, worn = next(fits, shapes[-1]), foliage.material
        count = min(len(order), left // len(leaf.triangles))
        if count * _SPRAYED <= len(order):
            rows, columns = worn.base_color.shape[:2]
            together = min(_LARGEST_SPRAY, round(len(order) / max(count, 1)))
            leaf, worn = spray_leaf(worn, columns / rows, together)
            count = min(len(order), left // len(leaf.triangles))
        thinned = thin_leaves(foliage, order, count, leaf, worn) if count else None
        foliage = None if thinned is None else replace(thinned, node=fitted.moved[thinned.node])
    bark = replace(tree.bark, double_sided=True) if fitted.blades else tree.bark
    return replace(tree, skeleton=fitted.skeleton, wood=wood, bark=bark, foliage=foliage)


def _share_out(
    tree: TreeModel,
    finest: TreeModel,
    budget: int,
    rank: BranchRank,
    meshing: MeshingParams,
    device: str | None,
) -> tuple[TreeModel, Foliage | None]:
    """The limbs for so many triangles, and on cards what else level 0 has; None where that is nothing."""
    assert tree.wood.node is not None
    fitted = _fit_wood(tree, rank, budget, 0.0, _for_limbs(meshing, budget), True, device)
    gone = rank.branch >= fitted.branches
    stays = ~gone[tree.wood.node[tree.wood.triangles]].any(axis=1)
    # Levels keep branches from the first rank on: so many nodes stand in the finest one.
    nodes = np.cumsum(np.bincount(rank.branch))
    standing = rank.branch <= np.searchsorted(nodes, len(finest.skeleton.parent))
    if not gone[standing].any() or not stays.any():
        return tree, None
    wood = replace(tree.wood, triangles=tree.wood.triangles[stays])
    limbs = replace(tree, skeleton=fitted.skeleton, wood=wood)
    return limbs, show_twigs(finest, gone[standing], device=device)


def _limbs_and_twigs(
    limbs: TreeModel, twigs: Foliage, budget: int, meshing: MeshingParams, device: str | None
) -> TreeModel:
    """A level: the limbs as fine as the budget allows beside the twigs' cards."""
    left, rank = budget - _CARDS, rank_branches(limbs.skeleton)
    fitted = _fit_wood(limbs, rank, left, 0.0, _for_limbs(meshing, left), True, device)
    bark = replace(limbs.bark, double_sided=True) if fitted.blades else limbs.bark
    return replace(limbs, skeleton=fitted.skeleton, wood=fitted.mesh, bark=bark, foliage=twigs)


def _for_limbs(meshing: MeshingParams, budget: int) -> MeshingParams:
    sides = share_triangles(budget, branches=1, sides=meshing.sides).sides
    return meshing.model_copy(update={"sides": sides, "tolerance": _LIMB_TOLERANCE})


def _leaf_shapes(foliage: Foliage) -> list[TreeMesh]:
    """The leaf and simpler ones, the one of most triangles first."""
    simpler = [
        simplify_leaf(foliage.leaf, foliage.material, bands=bands, pieces=pieces)
        for bands, pieces in ((2, 2), (2, 1), (1, 1))
    ]
    found = [foliage.leaf]
    for leaf in simpler:
        if len(leaf.triangles) < len(found[-1].triangles):
            found.append(leaf)
    return found


def _fit_wood(
    tree: TreeModel,
    rank: BranchRank,
    budget: int,
    most: float,
    params: MeshingParams,
    sheets: bool,
    device: str | None,
) -> _Wood:
    """The skeleton with as many branches as the budget allows, its nodes for those of the whole, its wood.

    Where even the trunk alone has more triangles than the budget, it is the trunk, as coarse as can be.
    """
    share = 1.0

    def build(count: int) -> _Wood:
        """Makes up for what the last try's surface lacked."""
        nonlocal share
        thinned, moved = thin_skeleton(tree.skeleton, rank, count, most=most, share=share)
        wood = sweep_rings(thinned, params=params, device=device)
        surface, mesh = _surface(wood), drop_backs(wood) if sheets else wood
        share = float(np.clip(share * whole / surface, 1.0, _MOST_SHARE))
        light = weld_thin_wood(mesh, thinned, radius=THIN * tree.height)
        return _Wood(count, thinned, moved, light, surface, mesh is not wood)

    whole, count = _surface(tree.wood), len(rank.fork)
    high, first = (count, _USUAL * count), _LOST
    if _FEWEST * count <= budget:
        best = build(count)
        high, first = (count, best.cost), share
        if high[1] <= budget:
            fits, finer = params.tolerance, 1.0
            for _ in range(_REFINED):
                room = budget / best.cost
                if room < _ROOMY and abs(best.surface - whole) < _EVEN * whole:
                    break
                if room > _ROOMY:  # triangles grow with about the inverse root of the tolerance
                    params = params.model_copy(update={"tolerance": fits / room**finer})
                again = build(count)
                if again.cost > budget:
                    high, finer = (count, again.cost), 0.5 * finer
                    continue
                fits = params.tolerance
                if again.cost > _ROOMY * best.cost or abs(again.surface - whole) < abs(best.surface - whole):
                    best = again
            if best.surface >= _ENOUGH * whole or high[1] <= budget:
                return best
            params = params.model_copy(update={"tolerance": fits})
    best = build(1)
    low = (1, best.cost)
    if low[1] > budget:
        params = params.model_copy(update=_COARSEST)
        return build(1)
    share = first
    aim = 0.5 * (1.0 + _NEAR_ENOUGH) * budget
    for step in range(_TRIES):
        if low[1] >= _NEAR_ENOUGH * budget or high[0] - low[0] < 2:
            break
        # Triangles grow with a power of the branches.
        rise = np.log(aim / low[1]) / np.log(high[1] / low[1])
        between = low[0] * (high[0] / low[0]) ** np.clip(rise, 0.1, 0.9)
        count = int(np.clip(round(between), low[0] + 1, high[0] - 1))
        before = share
        made = build(count)
        if step >= _SETTLED:  # thicker branches need more triangles: the search would never end
            share = before
        if made.cost <= budget:
            best, low = made, (count, made.cost)
        else:
            high = (count, made.cost)
    return best


def _surface(mesh: TreeMesh) -> float:
    """[m²]; of a slender body a quarter of it is seen, on average over all directions (Cauchy's formula)."""
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()) / 2.0
