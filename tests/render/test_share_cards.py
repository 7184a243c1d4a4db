from __future__ import annotations

import numpy as np
import pytest

from flowtree.render.share_cards import share_cards

OWN = np.array([0.0, 60.0, 120.0])
PLACES = np.zeros(3)
YAWS = np.arange(12) * 15.0


def _round_crown(depth: float) -> np.ndarray:
    """A ball of even density: from all sides the same, (16, 24)."""
    y, x = np.meshgrid((np.arange(16) - 7.5) / 8.0, (np.arange(24) - 11.5) / 8.0, indexing="ij")
    chord = 2.0 * np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    return 1.0 - np.exp(-depth * chord)


def _shown(covers, yaw, places=PLACES, own_yaws=OWN):
    """What the cards hide together: their columns nearest to each of the view's."""
    through = np.ones(covers[0].shape)
    for cover, own, place in zip(covers, own_yaws, places, strict=True):
        cosine = np.cos(np.radians(yaw - own))
        if abs(cosine) > 0.05:
            shift = place * np.sin(np.radians(own - yaw))
            column = np.rint((np.arange(24) - 11.5 - shift) / cosine + 11.5).astype(int)
            inside = (column >= 0) & (column < 24)
            through *= 1.0 - np.where(inside, cover[:, np.clip(column, 0, 23)], 0.0)
    return 1.0 - through


@pytest.mark.parametrize("depth", [0.2, 0.8])
def test_cards_together_hide_what_the_tree_hides(depth):
    crown = _round_crown(depth)
    covers = share_cards(
        np.stack([crown] * 3), OWN, PLACES, [crown] * 12, YAWS, lambda at: [_shown(at, yaw) for yaw in YAWS]
    )
    assert ((covers >= 0) & (covers <= 1)).all()
    assert (covers[:, crown == 0] == 0).all()
    for yaw in YAWS:
        assert _shown(covers, yaw).sum() == pytest.approx(crown.sum(), rel=0.2)
        # Each card with the whole tree would hide twice as much.
        assert _shown(covers, yaw).sum() < 0.9 * _shown([crown] * 3, yaw).sum()


def test_a_card_is_seen_where_it_stands():
    """A stem before the axis: on its card it stays whole, on a card behind the axis hardly any of it."""
    stem = np.zeros((1, 16, 24))
    stem[:, :, 11:13] = 0.9
    yaws = np.array([20.0, 40.0])

    def shares(place):
        def show(covers):
            return [_shown(covers, yaw, [place], [0.0]) for yaw in yaws]

        views = [_shown(stem, yaw, [4.0], [0.0]) for yaw in yaws]
        return share_cards(stem, np.zeros(1), np.array([place]), views, yaws, show).sum()

    assert shares(4.0) == pytest.approx(stem.sum(), rel=0.2)
    assert shares(-4.0) < 0.2 * stem.sum()


def test_what_cards_look_like_in_truth_corrects_them():
    """Cards that hide half as deep as they are asked to are asked for more."""
    crown = _round_crown(0.4)

    def show(covers):
        return [_shown(1 - np.sqrt(1 - covers), yaw) for yaw in YAWS]

    true = share_cards(
        np.stack([crown] * 3), OWN, PLACES, [crown] * 12, YAWS, lambda at: [_shown(at, yaw) for yaw in YAWS]
    )
    corrected = share_cards(np.stack([crown] * 3), OWN, PLACES, [crown] * 12, YAWS, show)
    assert corrected.sum() > 1.3 * true.sum()
