"""Two reports side by side: ratios, spreads, what is missing, and one clear line for a bad file."""

from __future__ import annotations

import json
import math

import pytest

from benchmarks.__main__ import run
from benchmarks.cases import Case, write_report


def _case(program: str, seconds: float, spread: float = 0.01, size: int = 1000) -> Case:
    return Case("trace", size, program, seconds, seconds - spread, seconds + spread, 5, None, True)


def _compare(tmp_path, capsys, before: list[Case], after: list[Case]) -> dict[str, list[str]]:
    files = tmp_path / "a.json", tmp_path / "b.json"
    for cases, file in zip((before, after), files, strict=True):
        write_report(cases, file)
    assert run(["compare", *map(str, files)]) == 0
    rows = [line for line in capsys.readouterr().out.splitlines() if "trace" in line]
    cells = [[cell.strip() for cell in row.strip("│ ").split("│")] for row in rows]
    return {f"{row[2]}.{row[1]}": row[3:] for row in cells}


def test_prints_medians_ratio_and_spreads(tmp_path, capsys):
    wrong = Case("trace", 1000, "wrong", *[math.nan] * 3, 0, None, False)
    found = _compare(
        tmp_path,
        capsys,
        [_case("slower", 1.0), _case("faster", 1.0), _case("same", 1.0, 0.3), _case("old", 1.0), wrong],
        [_case("slower", 1.5), _case("faster", 0.5), _case("same", 1.2, 0.3), _case("new", 2.0), wrong],
    )
    assert found == {
        "slower.1000": ["1", "1.5", "1.50", "B is slower"],
        "faster.1000": ["1", "0.5", "0.50", "B is faster"],
        "same.1000": ["1", "1.2", "1.20", "overlap"],
        "old.1000": ["1", "-", "-", "only in A"],
        "new.1000": ["-", "2", "-", "only in B"],
        "wrong.1000": ["wrong", "wrong", "-", "not timed"],
    }


def test_says_where_the_machines_differ(tmp_path, capsys):
    files = [tmp_path / "a.json", tmp_path / "b.json"]
    for file in files:
        write_report([_case("numba", 1.0)], file)
    report = json.loads(files[1].read_text())
    report["machine"]["cores_used"] = 64
    report["machine"]["date"] = "2001-01-01"
    files[1].write_text(json.dumps(report))
    assert run(["compare", *map(str, files)]) == 0
    said = capsys.readouterr().out
    assert "not the same cores_used" in said
    assert "date" not in said


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "must be a file that can be read"),
        (b"{", "must be JSON"),
        (b"\xff\xfe", "must be JSON"),
        (b"[]", 'must hold {"machine"'),
        (b'{"cases": []}', 'must hold {"machine"'),
        (b'{"machine": {}, "cases": [3]}', "case 0: must be an object"),
        (b'{"machine": {}, "cases": [{}]}', "'case' must be str"),
    ],
)
@pytest.mark.parametrize("bad", [0, 1])
def test_a_bad_report_gets_one_line(tmp_path, capsys, content, words, bad):
    files = [tmp_path / "a.json", tmp_path / "b.json"]
    write_report([_case("numba", 1.0)], files[1 - bad])
    if content is not None:
        files[bad].write_bytes(content)
    assert run(["compare", *map(str, files)]) == 1
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert words in said
    assert files[bad].name in said


def test_one_report_alone_is_wrong_usage(tmp_path, capsys):
    with pytest.raises(SystemExit) as end:
        run(["compare", str(tmp_path / "a.json")])
    assert end.value.code == 2
    assert "usage" in capsys.readouterr().err
