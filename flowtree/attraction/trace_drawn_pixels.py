"""Drawn pixels as polylines."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from skimage.morphology import skeletonize

from flowtree.geometry.polylines import arc_lengths, smooth_polyline

_Cell = tuple[int, int]
_AROUND = ((-1, 0), (0, -1), (0, 1), (1, 0), (-1, -1), (-1, 1), (1, -1), (1, 1))
_SMOOTH = 1.5  # pixels: sigma that turns the staircase of the skeleton into a line


def trace_drawn_pixels(drawn: NDArray[np.bool_]) -> list[NDArray[np.float64]]:
    """Thins drawn lines to their middle and follows it from fork to fork and end to end.

    Short spurs, which thinning leaves on thick lines, are dropped; what is left meets exactly at the forks.

    Args:
        drawn: (h, w).

    Returns: polylines (k, 2) as (x, y) [pixels], centres at +0.5; dots give none.
    """
    skeleton = np.asarray(skeletonize(drawn), np.bool_)  # type: ignore[no-untyped-call]
    cells = [(int(row), int(column)) for row, column in np.argwhere(skeleton)]
    known = set(cells)
    links = {cell: _links(cell, known) for cell in cells}
    thickness = drawn.sum() / max(1, len(cells))
    chains = _chains(cells, links)
    kept = []
    for chain in chains:
        ends = [len(links[end]) for end in (chain[0], chain[-1])]
        spur = min(ends) == 1 and max(ends) > 2 and len(chain) <= 1.0 * thickness + 2
        line = np.array([(column + 0.5, row + 0.5) for row, column in chain])
        if not spur and len(chain) > 1 and arc_lengths(line)[-1] >= 2.0:
            kept.append(smooth_polyline(line, _SMOOTH))
    return kept


def _links(cell: _Cell, known: set[_Cell]) -> list[_Cell]:
    """Neighbours in the skeleton; a diagonal one only where no straight step leads there too."""
    row, column = cell
    result = []
    for down, right in _AROUND:
        if (row + down, column + right) not in known:
            continue
        if down and right and ((row + down, column) in known or (row, column + right) in known):
            continue
        result.append((row + down, column + right))
    return result


def _chains(cells: list[_Cell], links: dict[_Cell, list[_Cell]]) -> list[list[_Cell]]:
    """Every link of the skeleton in one chain each; chains end at ends and forks, or are closed."""
    used: set[tuple[_Cell, _Cell]] = set()
    chains = []
    stops = [cell for cell in cells if len(links[cell]) != 2]
    for start in [*stops, *cells]:  # what the stops leave are closed loops
        for onward in links[start]:
            if (start, onward) in used:
                continue
            chain = [start, onward]
            used |= {(start, onward), (onward, start)}
            while len(links[chain[-1]]) == 2 and chain[-1] != start:
                following = next(cell for cell in links[chain[-1]] if cell != chain[-2])
                used |= {(chain[-1], following), (following, chain[-1])}
                chain.append(following)
            chains.append(chain)
    return chains
