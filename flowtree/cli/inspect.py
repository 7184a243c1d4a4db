"""``flowtree inspect``: what a file of ours holds."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer


def inspect(file: Annotated[Path, typer.Argument(help="A tree, a skeleton or a volume.")]) -> None:
    """Print what a file holds, as JSON."""
    from flowtree.export.inspect_file import inspect_file

    typer.echo(json.dumps(inspect_file(file), indent=2, ensure_ascii=False))
