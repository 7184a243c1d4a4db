"""``flowtree params``: every parameter, as a file to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def params(
    file: Annotated[Path | None, typer.Option("--params", help="Start from this file.")] = None,
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="Change one; may be repeated.")
    ] = None,
) -> None:
    """Print all parameters as TOML, each with its meaning, range and unit.

    Put them in a file with `flowtree params > params.toml` and use it with --params.
    """
    from flowtree.configuration import load_params, override_params, params_to_toml
    from flowtree.params import Params

    chosen = Params() if file is None else load_params(file)
    typer.echo(params_to_toml(override_params(chosen, assignments or ())), nl=False)
