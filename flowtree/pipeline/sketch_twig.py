"""From a drawing to the twigs of a tree (Particle Flows, section 8)."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree.attraction.read_sketch import read_sketch
from flowtree.branches.copy_twig import copy_twig
from flowtree.branches.shape_twigs import TwigShapes
from flowtree.params import TwigParams

_COPIES = 16  # more would not be told apart


def sketch_twig(path: Path | None, *, params: TwigParams = TwigParams(), seed: int = 0) -> TwigShapes | None:
    """Copies of a drawn twig, for `grow_twigs` and `sprout_twigs`; None without a drawing.

    Args:
        path: of the drawing.
        params: the copies' curl.
        seed: of their variation.

    Raises:
        InputError: a file that holds no drawing.
    """
    if path is None:
        return None
    return copy_twig(read_sketch(path), _COPIES, curl=params.curl, random=np.random.default_rng(seed))
