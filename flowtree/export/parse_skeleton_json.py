"""Our JSON to a skeleton."""

from __future__ import annotations

import json

from flowtree import check
from flowtree.export.assemble_skeleton import assemble_skeleton
from flowtree.export.write_skeleton_json import FORMAT
from flowtree.model.skeleton import Skeleton


def parse_skeleton_json(name: str, text: str) -> Skeleton:
    """Reads what `write_skeleton_json` wrote, exactly.

    Args:
        name: the file's, for the error.
        text: its content.

    Raises:
        InputError: it is not JSON, not ours, a list is missing, or it is no single tree.
    """
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as error:
        check.fail(name, "must be JSON", str(error), "write it with flowtree")
    ours = isinstance(document, dict) and document.get("format") == FORMAT
    check.require(ours, name, f'must have "format": "{FORMAT}"', "another document", "write it with flowtree")
    needed = ["parent", "points", "radius", "particles", "level", "twig"]
    missing = [word for word in needed if not isinstance(document.get(word), list)]
    check.require(
        not missing, name, f"needs the lists {', '.join(needed)}", f"no {', '.join(missing)}", "add them"
    )
    parent, points, radius, particles, level, twig = (document[word] for word in needed)
    return assemble_skeleton(name, parent, points, radius, particles=particles, level=level, twig=twig)
