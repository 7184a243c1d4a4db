"""The ``flowtree`` command: every subcommand, and how each of them ends."""

from __future__ import annotations

import atexit
import gc
import os
import sys

import typer

from flowtree import __version__
from flowtree.check import one_line
from flowtree.cli.demo import demo
from flowtree.cli.grow import grow
from flowtree.cli.inspect import inspect
from flowtree.cli.keep_memory import keep_memory
from flowtree.cli.matte import matte
from flowtree.cli.params import params
from flowtree.cli.reconstruct import reconstruct
from flowtree.cli.render import render
from flowtree.cli.studio import studio
from flowtree.cli.warmup import warmup
from flowtree.errors import FlowtreeError

app = typer.Typer(
    name="flowtree",
    help="Two loose photographs of a tree in, a 3D tree for games, films and city models out.",
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,  # Rich costs half of the start, and takes [m] for markup
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (demo, reconstruct, grow, studio, render, matte, params, inspect, warmup):
    app.command()(command)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"flowtree {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: bool = typer.Option(
        False, "--version", callback=_print_version, is_eager=True, help="Print the version and exit."
    ),
) -> None:
    """Options that stand before the command; what `version` asks for its callback has done."""


# Importing makes 250,000 objects that live to the end of the process.
_COLLECT_AFTER = 100_000


def main() -> None:
    """Runs a command; ends with 0 done, 1 bad input or data, 2 wrong usage, 130 stopped by Ctrl-C."""
    # To look for garbage among those after every 700 new ones costs a tenth of a second, and to do so once
    # more when the process ends 0.4 s: there is none. Frozen objects are left out; all that ends in order
    # (open files, threads, what others registered) has ended by then.
    gc.set_threshold(_COLLECT_AFTER)
    keep_memory()
    atexit.register(gc.freeze)
    try:
        app()
    except FlowtreeError as error:
        _end(str(error))
    except MemoryError:
        _end("out of memory; lower photos.working_height, density.resolution or flow.particle_count")
    except Exception as error:
        if os.environ.get("FLOWTREE_DEBUG"):
            raise
        _end(f"unexpected {type(error).__name__}: {error} (a fault of ours; FLOWTREE_DEBUG=1 shows where)")


def _end(message: str) -> None:
    typer.echo(f"flowtree: {one_line(message)}", err=True)
    sys.exit(1)
