"""A skeleton as JSON: everything the model holds, exactly."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowtree import __version__
from flowtree.export.check_skeleton import check_skeleton
from flowtree.export.format_numbers import format_numbers
from flowtree.files import write_whole
from flowtree.model.skeleton import Skeleton

FORMAT = "flowtree skeleton"


def write_skeleton_json(skeleton: Skeleton, path: Path) -> None:
    """Writes the skeleton's arrays under the model's own names, ``twig`` as 0 and 1.

    Raises:
        InputError: the skeleton is broken (see `check_skeleton`).
        OutputError: the file could not be written; what stood there is untouched.
    """
    check_skeleton(skeleton)
    # Written by hand: `json` would spell a float32 with the 17 digits of a double.
    points = ",".join(f"[{','.join(point)}]" for point in format_numbers(skeleton.points))
    arrays = {"points": points}
    for name in ("parent", "radius", "particles", "level", "twig"):
        arrays[name] = ",".join(format_numbers(np.asarray(getattr(skeleton, name))))
    head = [f'"format": "{FORMAT}"', f'"version": "{__version__}"', '"unit": "metre"', '"up": "y"']
    body = [f'"{name}": [{text}]' for name, text in arrays.items()]
    write_whole(path, ("{\n" + ",\n".join(head + body) + "\n}\n").encode())
