"""Progress on stderr: a bar on a terminal, a line a stage elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer

_INTERRUPTED = 130  # what shells give a command that Ctrl-C stopped


@contextmanager
def show_progress() -> Iterator[Callable[[str, float], None]]:
    """A callback for stages; Ctrl-C inside the block ends the command with one line and exit code 130."""
    try:
        if sys.stderr.isatty():
            with _bar() as show:
                yield show
        else:
            yield _lines()
    except KeyboardInterrupt:
        typer.echo("flowtree: stopped; every file is whole", err=True)
        raise typer.Exit(_INTERRUPTED) from None


@contextmanager
def _bar() -> Iterator[Callable[[str, float], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description:<12}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=1.0)

        def show(stage: str, fraction: float) -> None:
            bar.update(task, description=stage, completed=fraction)

        yield show


def _lines() -> Callable[[str, float], None]:
    shown: set[str] = set()

    def show(stage: str, fraction: float) -> None:
        if stage not in shown:
            shown.add(stage)
            typer.echo(f"{fraction:4.0%} {stage}", err=True)

    return show
