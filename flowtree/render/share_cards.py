"""How dense each of several flat cards must be so that all together look as dense as the tree."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack

Floats = NDArray[np.float64]
_ROUNDS = 24
_CORRECTIONS = 2
_DENSEST = 3.5  # optical depth: beyond it nothing is to be seen of what is behind
_EDGE_ON = 0.05  # cosine below which a card is not seen
_LEAST = 1e-6
_SEEN = 0.02  # optical depth: what is seen less than that says little of how to correct it


def share_cards(
    cards: Floats,
    card_yaws: Floats,
    card_places: Floats,
    views: Sequence[Floats],
    yaws: Floats,
    show: Callable[[Floats], Sequence[Floats]],
) -> Floats:
    """Finds what each upright card must cover, by Richardson's and Lucy's multiplicative steps.

    What light passes cards before each other is the product of what passes each, so optical depths add. A
    card seen at an angle is narrower but lets as much light through. From their own pictures' depths on, the
    cards' are changed so that from all yaws the sums come nearest to the tree's depths; where a card's own
    picture shows nothing it stays empty. What such cards look like in truth, cut by an alpha test, then
    corrects them by the same steps.

    Args:
        cards: (c, h, w) of the share of each cell, 0..1, that what a card is to show covers, seen from its
            yaw; columns from -w/2 to w/2 about the y axis.
        card_yaws: (c,) [degrees].
        card_places: (c,) how far each card stands before the y axis, toward its yaw [cells].
        views: m pictures (h, w) in 0..1 of the whole tree's share of the same cells.
        yaws: (m,) from where they are seen [degrees].
        show: of what each card is to cover, as returned, what is seen of all cards from these yaws, like
            ``views``.

    Returns: (c, h, w) in 0..1, the share of each cell that each card is to cover.
    """
    count, height, width = cards.shape
    # Columns first, for sparse products: dense ones round as their threads share the work.
    depth = _depth(cards).transpose(0, 2, 1).reshape(count * width, height)
    wanted = _stack(views)
    seen = vstack([_columns(width, card_yaws, card_places, yaw) for yaw in yaws], format="csr")
    back = seen.T.tocsr()
    weight = np.maximum(back.sum(axis=1), _LEAST)[:, None]

    def change(shown: Floats, least: float) -> Floats:
        times: Floats = back @ ((wanted + least) / (shown + least)) / weight
        return np.minimum(depth * times, _DENSEST)

    def covered() -> Floats:
        return 1.0 - np.exp(-depth.reshape(count, width, height).transpose(0, 2, 1))

    for _ in range(_ROUNDS):
        depth = change(seen @ depth, _LEAST)
    for _ in range(_CORRECTIONS):
        depth = change(_stack(show(covered())), _SEEN)
    return covered()


def _stack(views: Sequence[Floats]) -> Floats:
    """Optical depths (m w, h) of m pictures (h, w)."""
    return np.concatenate([_depth(view).T for view in views])


def _depth(share: Floats) -> Floats:
    depth: Floats = -np.log1p(-np.minimum(share.astype(np.float64), 1.0 - np.exp(-_DENSEST)))
    return depth


def _columns(width: int, card_yaws: Floats, card_places: Floats, yaw: float) -> csr_array:
    """(w, c w): of each column of the view, which columns of all cards it shows, as shares."""
    turn = np.radians(card_yaws - yaw)
    cell = np.arange(width)
    shown = np.zeros((len(turn), width, width))
    for card, cosine, shift in zip(shown, np.cos(turn), card_places * np.sin(turn), strict=True):
        if abs(cosine) >= _EDGE_ON:
            edges = (np.arange(width + 1) - 0.5 * width - shift) / cosine + 0.5 * width
            low, high = np.minimum(edges[:-1], edges[1:]), np.maximum(edges[:-1], edges[1:])
            overlap = np.minimum(high[:, None], cell + 1.0) - np.maximum(low[:, None], cell)
            card += np.maximum(overlap, 0.0) / (high - low)[:, None]
    return csr_array(shown.transpose(1, 0, 2).reshape(width, -1))
