"""Rows for people."""

from __future__ import annotations

import pytest

from benchmarks.likeness.bench import Row
from benchmarks.likeness.write_table import markdown_table, print_table


@pytest.mark.parametrize(
    ("asked", "reached", "at_most", "passed"),
    [(0.5, 0.5, False, True), (0.5, 0.4, False, False), (0.5, 0.6, True, False), (None, 9.0, True, True)],
)
def test_a_row_knows_whether_its_bound_is_kept(asked, reached, at_most, passed):
    assert Row("a", asked, reached, {}, at_most).passed == passed


def test_both_tables_say_everything(capsys):
    rows = {
        "speed": [Row("the whole", 15.0, 12.34, {"aspen": 12.34}, at_most=True, unit="s")],
        "wood": [Row("recall", 0.8, 0.5, {"maple": 0.5}), Row("for information", None, 0.25, {})],
    }
    text = markdown_table(rows, "this machine")
    assert "| speed | the whole | <= 15 s | 12.340 s | yes | aspen 12.340 s |" in text
    assert "| wood | recall | >= 0.8 | 0.500 | no | maple 0.500 |" in text
    assert "| wood | for information |  | 0.250 |  |  |" in text
    assert "this machine" in text
    print_table(rows)
    said = capsys.readouterr().out
    assert "fidelity.wood.recall.maple 0.500" in said
    assert "12.340 s" in said
