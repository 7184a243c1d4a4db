"""Labelled pictures on paper."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.render.lay_out_sheet import GAP, lay_out_sheet


@settings(deadline=None, max_examples=25)
@given(
    columns=st.integers(1, 5),
    slot=st.integers(1, 120),
    label=st.text(st.characters(codec="latin-1", categories=["L", "N", "Zs"]), max_size=200),
)
def test_every_picture_is_there_whole_and_no_label_leaves_its_place(columns, slot, label):
    width = GAP + columns * (slot + GAP)
    black = np.zeros((7, slot, 3), np.uint8)
    sheet = lay_out_sheet([[(label, black)] * columns, [("", black)]], width=width, slot=slot)
    assert sheet.shape[1] == width
    count = (sheet == 0).all(axis=2)
    lowest = count[-GAP - 7 : -GAP]
    assert lowest.sum() == 7 * slot, "the last row holds one picture"
    assert (sheet[:, -GAP:] == sheet[0, 0]).all(), "the edge stays free"
