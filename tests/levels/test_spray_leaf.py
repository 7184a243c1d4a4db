from __future__ import annotations

import numpy as np
import pytest

from flowtree.foliage.make_leaf import make_leaf
from flowtree.geometry.srgb import LIGHT_OF_BYTE
from flowtree.levels.seen_area import seen_area
from flowtree.levels.spray_leaf import spray_leaf


def _mean_light(picture):
    weight = picture[:, :, 3:].astype(float)
    return (LIGHT_OF_BYTE[picture[:, :, :3]] * weight).sum(axis=(0, 1)) / weight.sum()


@pytest.mark.parametrize("shape", ["broad", "lanceolate", "needle"])
@pytest.mark.parametrize("count", [2, 3, 7, 12])
def test_a_spray_is_one_card_of_leaves_in_their_own_colour(shape, count):
    _, material = make_leaf(shape)
    rows, columns = material.base_color.shape[:2]
    card, sprayed = spray_leaf(material, columns / rows, count)
    assert len(card.triangles) == 2
    assert np.allclose(np.linalg.norm(card.normals, axis=1), 1.0, atol=1e-6)
    assert sprayed.alpha_cutoff == material.alpha_cutoff
    picture = sprayed.base_color
    assert picture.shape[0] == picture.shape[1] <= 512
    assert np.allclose(_mean_light(picture), _mean_light(material.base_color), atol=0.08)
    assert seen_area(card, sprayed) > 0.05
    # Nothing is cut off at the card's sides.
    assert (picture[:, 0, 3] < 128).all()
    assert (picture[:, -1, 3] < 128).all()


def test_more_leaves_are_smaller_ones():
    _, material = make_leaf("broad")
    few, many = (spray_leaf(material, 0.7, count)[1].base_color[:, :, 3] >= 128 for count in (2, 12))
    outline = [np.abs(np.diff(each.astype(int))).sum() / each.shape[0] for each in (few, many)]
    assert outline[1] > 1.5 * outline[0]


def test_it_is_the_same_every_time():
    _, material = make_leaf("compound")
    one, two = (spray_leaf(material, 0.7, 5)[1].base_color for _ in range(2))
    assert one.tobytes() == two.tobytes()
