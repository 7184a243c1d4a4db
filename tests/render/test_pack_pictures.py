from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.render.pack_pictures import pack_pictures

SIZES = st.lists(st.tuples(st.floats(1e-3, 10.0), st.floats(1e-3, 10.0)), min_size=1, max_size=40)


@given(SIZES, st.sampled_from([128, 500, 1024]))
def test_pictures_are_all_there_large_enough_and_do_not_overlap(sizes, size):
    packing = pack_pictures(sizes, size, least=8)
    taken = np.zeros(packing.shape, np.int32)
    frames = zip(sizes, packing.columns, packing.rows, packing.left, packing.upper, strict=True)
    for (wide, tall), columns, rows, left, upper in frames:
        assert columns >= max(8, packing.scale * wide)
        assert rows >= max(8, packing.scale * tall)
        assert columns % 4 == rows % 4 == 0
        taken[upper : upper + rows, left : left + columns] += 1
        assert upper + rows <= packing.shape[0]
        assert left + columns <= packing.shape[1]
    assert taken.max() == 1
    assert max(packing.shape) <= size


def test_much_of_the_texture_is_used():
    rng = np.random.default_rng(0)
    sizes = [(float(wide), float(tall)) for wide, tall in rng.uniform(3.0, 5.0, (33, 2))]
    packing = pack_pictures(sizes, 2048, least=8)
    used = sum(columns * rows for columns, rows in zip(packing.columns, packing.rows, strict=True))
    assert used > 0.75 * 2048**2


def test_too_many_pictures_are_refused():
    with pytest.raises(InputError, match="impostor: needs room for 100 pictures of 8 pixels"):
        pack_pictures([(1.0, 1.0)] * 100, 64, least=8)
