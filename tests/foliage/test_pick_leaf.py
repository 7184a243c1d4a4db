"""The leaf that a tree bears: what is asked for, else what suits it, always the same."""

from __future__ import annotations

import numpy as np
import pytest

from flowtree.foliage.choose_leaf import choose_leaf
from flowtree.foliage.make_leaf import make_leaf
from flowtree.foliage.pick_leaf import pick_leaf
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.params import LeafParams

CAMERA = Camera(yaw=0.0, metres_per_pixel=0.1, foot=(20.0, 60.0), width=40, height=60)


def matte():
    alpha = np.zeros((60, 40), np.float32)
    alpha[5:45, 5:35] = 1.0
    alpha[45:60, 19:21] = 1.0
    green = np.broadcast_to(np.array([60, 120, 40], np.uint8), (60, 40, 3)).copy()
    return Matte(alpha=alpha, foreground=green, unknown=np.zeros((60, 40), bool), method="given")


@pytest.mark.parametrize("shape", ["auto", "needle", "broad"])
def test_the_shape_is_the_asked_one_or_suits_the_tree(shape):
    mesh, material = pick_leaf([matte()], [CAMERA], params=LeafParams(shape=shape), seed=3)
    wanted = choose_leaf([matte()], [CAMERA]) if shape == "auto" else shape
    same, texture = make_leaf(wanted, color=(0.8, 0.8, 0.8), seed=3)
    assert np.array_equal(mesh.positions, same.positions)
    assert np.array_equal(material.base_color, texture.base_color)
