"""Any skeleton gets wood, twigs and leaves; the same one always the same."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from flowtree.configuration import override_params
from flowtree.errors import CancelledError, InputError
from flowtree.export.write_glb import encode_glb
from flowtree.params import Params
from flowtree.pipeline.grow_tree import grow_tree
from tests.trees import hand_made_skeleton

SMALL = override_params(Params(), ["twigs.most=60", "leaves.most=300"])


@pytest.fixture(scope="module")
def limbs():
    drawn = hand_made_skeleton()
    return dataclasses.replace(drawn, twig=np.zeros(len(drawn.parent), np.bool_))


def test_limbs_become_a_tree(limbs):
    seen = []
    grown = grow_tree(limbs, height=8.0, params=SMALL, progress=lambda stage, share: seen.append(stage))
    tree, report = grown.tree, grown.report
    assert tree.height == pytest.approx(8.0)
    assert tree.skeleton.twig.sum() > 10
    assert tree.foliage is not None
    assert 100 < len(tree.foliage.position) <= 300
    assert report["mesh"]["watertight"]
    assert report["leaves"] == len(tree.foliage.position)
    assert report["warnings"] == []
    assert "twigs" in seen
    assert encode_glb(tree) == encode_glb(grow_tree(limbs, height=8.0, params=SMALL).tree)
    other = grow_tree(limbs, height=8.0, params=SMALL, seed=1).tree
    assert encode_glb(tree) != encode_glb(other)


def test_twigs_and_leaves_can_be_left_out(limbs):
    bare = override_params(SMALL, ["leaves.bear=never"])
    tree = grow_tree(limbs, twigs=False, params=bare).tree
    assert tree.foliage is None
    np.testing.assert_array_equal(tree.skeleton.points, limbs.points)
    with_twigs = dataclasses.replace(limbs, twig=np.arange(len(limbs.parent)) > 12)
    assert len(grow_tree(with_twigs, params=bare).tree.skeleton.parent) == len(limbs.parent)
    assert len(grow_tree(with_twigs, twigs=True, params=bare).tree.skeleton.parent) > len(limbs.parent)


def test_wrong_numbers_and_a_stop(limbs):
    for wrong in ({"height": 0}, {"height": float("nan")}, {"seed": -1}, {"up": "x"}):
        with pytest.raises(InputError):
            grow_tree(limbs, params=SMALL, **wrong)
    with pytest.raises(CancelledError):
        grow_tree(limbs, params=SMALL, cancel=lambda: True)
