"""``python -m benchmarks``: every program is found, and a wrong name gets the nearest one."""

from __future__ import annotations

from benchmarks.__main__ import find_programs, run


def test_lists_every_program_with_its_purpose(capsys):
    assert run([]) == 2
    assert run(["--help"]) == 0
    listed = capsys.readouterr().out
    for name, purpose in find_programs().items():
        assert name in listed
        assert purpose.endswith(".")


def test_an_unknown_name_gets_the_nearest(capsys):
    assert run(["galery"]) == 1
    assert "did you mean 'gallery'?" in capsys.readouterr().err
