"""A whole process in its parts: its beginning, its stages, its end."""

from __future__ import annotations

import pytest

from benchmarks.watch_command import watch_command
from flowtree.errors import InputError
from tests.pictures import save_pair


def test_the_parts_lie_inside_the_whole(tmp_path):
    photos = [str(file) for file in save_pair(tmp_path)]
    watched = watch_command(["reconstruct", *photos, "--height", "6", "-o", str(tmp_path / "tree.glb")])
    assert watched.begin > 0.0
    assert watched.end > 0.0
    assert watched.begin + watched.end < watched.whole < 120.0


@pytest.mark.parametrize(
    ("command", "said"),
    [(("inspect", "nothing.glb"), r"must succeed.*nothing\.glb"), (("--version",), "must make a tree")],
)
def test_what_makes_no_tree_is_refused(command, said):
    with pytest.raises(InputError, match=said):
        watch_command(command)
