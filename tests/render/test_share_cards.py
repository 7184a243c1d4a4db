from __future__ import annotations

import numpy as np
import pytest

from flowtree.render.keep_coverage import keep_coverage
from flowtree.render.share_cards import share_cards

OWN = np.array([0.0, 60.0, 120.0])
YAWS = np.arange(12) * 15.0


def _round_crown(depth: float) -> np.ndarray:
    """A ball of even density: from all sides the same, (16, 24)."""
    y, x = np.meshgrid((np.arange(16) - 7.5) / 8.0, (np.arange(24) - 11.5) / 8.0, indexing="ij")
    chord = 2.0 * np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
    return 1.0 - np.exp(-depth * chord)


def _shown(covers, yaw):
    """What the cards hide together: their columns nearest to each of the view's."""
    through = np.ones(covers[0].shape)
    for cover, own in zip(covers, OWN, strict=True):
        cosine = np.cos(np.radians(yaw - own))
        if abs(cosine) > 0.05:
            column = np.rint((np.arange(24) - 11.5) / cosine + 11.5).astype(int)
            inside = (column >= 0) & (column < 24)
            through *= 1.0 - np.where(inside, cover[:, np.clip(column, 0, 23)], 0.0)
    return 1.0 - through


@pytest.mark.parametrize("depth", [0.2, 0.8])
def test_cards_together_hide_what_the_tree_hides(depth):
    crown = _round_crown(depth)
    covers = share_cards([crown] * 3, OWN, [crown] * 12, YAWS)
    assert ((covers >= 0) & (covers <= 1)).all()
    assert (covers[:, crown == 0] == 0).all()
    for yaw in YAWS:
        assert _shown(covers, yaw).sum() == pytest.approx(crown.sum(), rel=0.2)
        # Each card with the whole tree would hide twice as much.
        assert _shown(covers, yaw).sum() < 0.9 * _shown([crown] * 3, yaw).sum()


def test_alpha_covers_as_much_as_is_asked():
    alpha = np.random.default_rng(0).random((64, 64)).astype(np.float32)
    for share in (0.1, 0.3, 0.8):
        bent = keep_coverage(alpha, 0.5, np.full(alpha.shape, share, np.float32))
        assert (bent >= 0.5).mean() == pytest.approx(share, abs=0.03)
