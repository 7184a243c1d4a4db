import json

import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.params import TwigParams
from flowtree.pipeline.sketch_twig import sketch_twig


def test_a_drawing_becomes_twigs_and_none_is_none(tmp_path):
    drawing = tmp_path / "twig.json"
    drawing.write_text(json.dumps([[[0, 100], [0, 0]], [[0, 60], [40, 30]]]))
    made = sketch_twig(drawing, params=TwigParams(curl=0.0))
    assert made is not None
    assert np.allclose(made.points[:, made.shoot[-1]], [0, 1, 0], atol=1e-5)
    again = sketch_twig(drawing, params=TwigParams(curl=0.0))
    assert again is not None
    assert made.points.tobytes() == again.points.tobytes()
    assert sketch_twig(None) is None


def test_a_file_that_is_no_drawing_is_named(tmp_path):
    (tmp_path / "twig.json").write_text("[]")
    with pytest.raises(InputError, match="needs at least one stroke"):
        sketch_twig(tmp_path / "twig.json")
