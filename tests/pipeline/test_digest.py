"""Fingerprints: equal for equal content, different for different content."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.model.photo import Photo
from flowtree.params import DensityParams
from flowtree.pipeline.digest import digest

_VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False)
    | st.text(max_size=5)
    | st.binary(max_size=5),
    lambda inner: (
        st.lists(inner, max_size=3).map(tuple) | st.dictionaries(st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=6,
)


@settings(max_examples=25, deadline=None)
@given(a=_VALUES, b=_VALUES)
def test_differs_exactly_where_values_differ(a, b):
    # Their representations tell True from 1 and 0.0 from -0.0, as the fingerprint does.
    assert (digest(a) == digest(b)) == (repr(a) == repr(b))


def test_nothing_runs_together():
    assert digest("ab", "c") != digest("a", "bc")
    assert digest((1, 2), 3) != digest(1, (2, 3))
    assert digest(np.zeros((2, 3))) != digest(np.zeros((3, 2)))
    assert digest(np.zeros(2, np.float32)) != digest(np.zeros(1, np.float64))


def test_looks_into_arrays_dataclasses_and_parameters():
    photo = Photo("a.jpg", np.zeros((4, 4, 3), np.uint8))
    assert digest(photo) == digest(replace(photo, rgb=photo.rgb.copy()))
    assert digest(photo) != digest(replace(photo, rgb=photo.rgb + np.uint8(1)))
    assert digest(DensityParams()) == digest(DensityParams())
    assert digest(DensityParams()) != digest(DensityParams(resolution=32))
    view = np.arange(12).reshape(3, 4).T
    assert digest(view) == digest(view.copy())


def test_a_path_counts_with_its_content(tmp_path):
    file = tmp_path / "a.txt"
    file.write_text("one")
    before = digest(file)
    assert digest(file) == before
    file.write_text("two")
    assert digest(file) != before


def test_a_missing_file_is_an_input_error(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.jpg"):
        digest(tmp_path / "nothing.jpg")
