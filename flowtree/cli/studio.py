"""``flowtree studio``: the local page on which trees are made by hand."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from flowtree import check
from flowtree.errors import OutputError


def studio(
    project: Annotated[
        Path, typer.Argument(help="The project's folder; made if there is none.", show_default=True)
    ] = Path("flowtree-project"),
    port: Annotated[
        int | None, typer.Option(help="Of this machine.", show_default="8571, or any if that is in use")
    ] = None,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Do not open the page.")] = False,
) -> None:
    """Make a tree from photos on a local page: arrange, scribble, draw, paint, watch it grow.

    Everything is kept in the project's folder, which `flowtree reconstruct --project` reads, too. Ctrl-C ends
    the studio.
    """
    there = find_spec("nicegui") is not None
    remedy = (
        'install it with `pip install "flowtree-3d[studio]"`, in a checkout with `pip install -e ".[studio]"`'
    )
    check.require(there, "studio", "needs the extra `studio`", "no nicegui", remedy)
    from flowtree.studio.run_studio import HOST, choose_port, run_studio
    from flowtree.studio.session import Session

    chosen = choose_port(port)
    session = Session.open(project)
    try:
        typer.echo(f"flowtree studio: http://{HOST}:{chosen} shows {project}; Ctrl-C ends it")
        run_studio(session, port=chosen, show=not no_browser)
    except KeyboardInterrupt:
        pass
    finally:
        session.close()
    if not session.saved:
        raise OutputError(f"{project}: the latest changes could not be saved; free some space")
    typer.echo(f"{project}: saved")
