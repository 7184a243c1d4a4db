"""Known trees, made again from two of their pictures: a leafy and a bare one keep what has been reached."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.measure_truth import HELD_OUT, INPUTS, load_truth, mean_over, measure_truth

_TRUTH = Path(__file__).parents[2] / ".." / "shared" / "data" / "truth"


@pytest.mark.skipif(not _TRUTH.is_dir(), reason="the test data beside the project is not there")
@pytest.mark.parametrize(
    ("name", "leafy", "inputs", "held_out"), [("birch", True, 0.76, 0.56), ("maple_bare", False, 0.76, 0.65)]
)
def test_a_known_tree_is_made_again(name, leafy, inputs, held_out):
    made = measure_truth(load_truth(_TRUTH / name))
    assert made.faults == ()
    assert (made.tree.foliage is not None) == leafy
    assert mean_over(made.of_tree, INPUTS) > inputs
    assert mean_over(made.of_tree, HELD_OUT) > held_out
    # Two views of an exact matte say most about themselves.
    assert mean_over(made.of_volume, INPUTS) > mean_over(made.of_volume, HELD_OUT) > held_out
