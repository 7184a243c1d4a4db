"""How dense each of several crossed cards must be so that all together look as dense as the tree."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

Floats = NDArray[np.float64]
_ROUNDS = 24
_DENSEST = 3.5  # optical depth: beyond it nothing is to be seen of what is behind
_EDGE_ON = 0.05  # cosine below which a card is not seen
_LEAST = 1e-6


def share_cards(cards: Sequence[Floats], card_yaws: Floats, views: Sequence[Floats], yaws: Floats) -> Floats:
    """Finds what each card must cover, by Richardson's and Lucy's multiplicative steps.

    Cards through the y axis lie before each other: what light passes all of them is the product of what
    passes each, so optical depths add. Each card, seen at an angle, is narrower but lets as much light
    through. From their own pictures' depths on, the cards' are changed so that from all yaws the sums come
    nearest to the tree's depths; where a card's own picture shows nothing it stays empty.

    Args:
        cards: c pictures (h, w) of the tree's share of each cell, 0..1, as each card's own yaw shows it;
            columns from -w/2 to w/2 about the y axis.
        card_yaws: (c,) [degrees].
        views: m pictures (h, w) in 0..1 of the same cells from other yaws.
        yaws: (m,) [degrees].

    Returns: (c, h, w) in 0..1, the share of each cell that each card is to cover.
    """
    # Columns first, for sparse products: dense ones round as their threads share the work.
    wanted = [_depth(view).T for view in views]
    depth = [_depth(card).T for card in cards]
    width = len(depth[0])
    seen = [[_columns(width, float(np.cos(np.radians(yaw - own)))) for own in card_yaws] for yaw in yaws]
    weight = [np.maximum(sum(row[c].sum(axis=0) for row in seen), _LEAST)[:, None] for c in range(len(depth))]
    for _ in range(_ROUNDS):
        ratio = []
        for view, row in zip(wanted, seen, strict=True):
            shown = sum(across @ one for one, across in zip(depth, row, strict=True))
            ratio.append((view + _LEAST) / (shown + _LEAST))
        for c, one in enumerate(depth):
            change = sum(row[c].T @ each for each, row in zip(ratio, seen, strict=True)) / weight[c]
            depth[c] = np.minimum(one * change, _DENSEST)
    return 1.0 - np.exp(-np.stack([one.T for one in depth]))


def _depth(share: Floats) -> Floats:
    depth: Floats = -np.log1p(-np.minimum(share.astype(np.float64), 1.0 - np.exp(-_DENSEST)))
    return depth


def _columns(width: int, cosine: float) -> csr_array:
    """(w, w): of each column of the view, which columns of a card at that angle it shows, as shares."""
    shown = np.zeros((width, width))
    if abs(cosine) < _EDGE_ON:
        return csr_array(shown)
    edges = (np.arange(width + 1) - 0.5 * width) / cosine + 0.5 * width
    low, high = np.minimum(edges[:-1], edges[1:]), np.maximum(edges[:-1], edges[1:])
    cell = np.arange(width)
    overlap = np.minimum(high[:, None], cell + 1.0) - np.maximum(low[:, None], cell)
    shown += np.maximum(overlap, 0.0) / (high - low)[:, None]
    return csr_array(shown)
