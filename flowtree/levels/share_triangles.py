"""How a budget of triangles is shared between wood and leaves, and how finely wood is then worth showing."""

from __future__ import annotations

from dataclasses import dataclass

# Measured on bare crowns of 4,000 to 27,000 branches: with these the wood was likest to the finest one's.
_TOLERANCE, _FALLS = 0.0145, 0.6  # with one triangle a branch, and with more
_FINEST, _COARSEST = 0.001, 0.08
_THICKENING, _THICKEST = 0.3, 0.003  # of the tolerance; above this a crown becomes a bundle of thorns
_SIDES, _FULL, _FEWER = 12, 60_000, 0.3
_WOOD = 0.18  # of a leafy tree's budget, at most, while leaves want more than the rest


@dataclass(frozen=True)
class Shares:
    """What a level of detail is made with.

    Attributes:
        wood: triangles for the wood, at most.
        tolerance: how far its surface may leave the finest one [tree heights].
        thickening: by which its thinnest branches may make up for lost ones, at most [tree heights].
        sides: of its thickest ring.
    """

    wood: int
    tolerance: float
    thickening: float
    sides: int


def share_triangles(budget: int, *, branches: int, leaves: int = 0, sides: int = _SIDES) -> Shares:
    """What a budget of triangles allows the wood: all that its leaves do not want, and a share in any case.

    Args:
        budget: triangles of the whole tree.
        branches: of the finest wood.
        leaves: triangles of all its leaves in their simplest shape.
        sides: of the thickest ring of the finest wood.
    """
    wood = max(round(_WOOD * budget), budget - leaves)
    tolerance = _TOLERANCE * (max(branches, 1) / max(wood, 1)) ** _FALLS
    tolerance = min(max(tolerance, _FINEST), _COARSEST)
    wanted = 2 * round(0.5 * _SIDES * min(1.0, (wood / _FULL) ** _FEWER))
    return Shares(
        wood=wood,
        tolerance=tolerance,
        thickening=min(_THICKENING * tolerance, _THICKEST),
        sides=min(sides, wanted if wanted > 2 else 3),
    )
