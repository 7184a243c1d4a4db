import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.geometry.read_color import read_color


def test_red_green_and_blue():
    assert np.array_equal(read_color("#ff8000", "bark"), [255, 128, 0])
    assert np.array_equal(read_color("#0aB1c2", "bark"), [10, 177, 194])


@pytest.mark.parametrize("text", ["", "brown", "#fff", "#12345g", "123456", "#1234567"])
def test_anything_else_gets_one_clear_line(text):
    with pytest.raises(InputError, match="bark: must be auto or #rrggbb"):
        read_color(text, "bark")
