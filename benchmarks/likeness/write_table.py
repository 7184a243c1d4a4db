"""The measure's rows for people: a table in a terminal, and one in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rich.console import Console
from rich.table import Table

from benchmarks.likeness.bench import Row

_HEAD = ("part", "measure", "asked", "reached", "kept")


def print_table(rows: Mapping[str, Sequence[Row]]) -> None:
    """Prints every row, and under it what it was computed from."""
    table = Table(title="Fidelity", show_lines=False)
    for name in _HEAD:
        table.add_column(name, justify="right" if name in {"asked", "reached"} else "left")
    for cells in _lines(rows):
        table.add_row(*cells)
    for part, measured in rows.items():
        for row in measured:
            for item, value in row.items.items():
                print(f"fidelity.{part}.{row.measure}.{item} {_figure(value, row)}")
    Console(width=120, markup=False, emoji=False).print(table)


def markdown_table(rows: Mapping[str, Sequence[Row]], machine: str) -> str:
    """The same as Markdown, the single figures behind each row."""
    lines = [
        "# Fidelity",
        "",
        f"Default parameters, measured with `python -m benchmarks fidelity`. {machine}",
        "",
        "| " + " | ".join((*_HEAD, "each")) + " |",
        "|---|---|---:|---:|---|---|",
    ]
    each = [row for measured in rows.values() for row in measured]
    for cells, row in zip(_lines(rows), each, strict=True):
        single = ", ".join(f"{name} {_figure(value, row)}" for name, value in row.items.items())
        lines.append("| " + " | ".join((*cells, single)) + " |")
    return "\n".join(lines) + "\n"


def _lines(rows: Mapping[str, Sequence[Row]]) -> Iterable[tuple[str, ...]]:
    for part, measured in rows.items():
        for row in measured:
            sign = "<=" if row.at_most else ">="
            asked = "" if row.asked is None else f"{sign} {row.asked:g}{_unit(row)}"
            kept = "" if row.asked is None else "yes" if row.passed else "no"
            yield part, row.measure, asked, _figure(row.reached, row), kept


def _figure(value: float, row: Row) -> str:
    return f"{value:.3f}{_unit(row)}"


def _unit(row: Row) -> str:
    return f" {row.unit}" if row.unit else ""
