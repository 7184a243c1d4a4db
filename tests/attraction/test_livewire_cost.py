"""What a livewire pays on a photo."""

from __future__ import annotations

import numpy as np

from flowtree.attraction.livewire_cost import livewire_cost
from tests.attraction.scenes import BARE, bare, scene


def test_branches_are_cheap_and_what_is_beside_the_tree_is_dear():
    photo, matte, _ = scene(bare(), color=(60, 50, 40))
    cost = livewire_cost(photo, matte)
    assert cost.dtype == np.uint8
    scale = cost.shape[0] / matte.alpha.shape[0]
    assert cost.shape[1] == round(matte.alpha.shape[1] * scale)
    middles = [np.mean(ends, axis=0) * scale for ends in BARE]
    on = [cost[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2].min() for x, y in middles]
    assert np.median(on) < 100
    assert max(on) < 200  # a twig of three pixels
    assert cost[:, 0].min() == 255
    assert cost[0].min() == 255


def test_a_tree_that_fills_the_photo_has_a_cost_everywhere():
    photo, matte, _ = scene(np.ones((60, 40), np.float32))
    cost = livewire_cost(photo, matte)
    assert cost.shape[0] <= 400
    assert cost.shape[0] / cost.shape[1] == 1.5
