"""Starts the studio's server and serves until it is stopped."""

from __future__ import annotations

import contextlib
import signal
import socket
import webbrowser
from types import FrameType

from nicegui import app, ui

from flowtree import check
from flowtree.studio.page.build_page import build_page
from flowtree.studio.serve import add_routes
from flowtree.studio.session import Session

HOST = "127.0.0.1"  # this machine alone: whoever reaches the page may change the project
_USUAL_PORT = 8571
_LONGEST_SILENCE = 30.0  # [s] that a page may lose its connection before it is taken for closed


def choose_port(wanted: int | None) -> int:
    """A free port of this machine: the wanted one; else the usual one, or any if that is taken.

    Raises:
        InputError: the wanted one is taken, or no port.
    """
    if wanted is not None:
        valid = 0 < wanted < 65536
        check.require(valid, "--port", "must be 1 to 65535", wanted, "choose another")
        free = _is_free(wanted)
        check.require(
            free, "--port", "must be free", f"{wanted}, which is in use", "choose another, or leave it out"
        )
        return wanted
    if _is_free(_USUAL_PORT):
        return _USUAL_PORT
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return int(probe.getsockname()[1])


def run_studio(session: Session, *, port: int, show: bool) -> None:
    """Serves a session's page until Ctrl-C, or until the process is asked to end: then that is raised.

    Args:
        session: what is shown.
        port: a free one.
        show: whether to open the page in a browser.

    Raises:
        KeyboardInterrupt: it was stopped by a signal.
    """
    for name in ("SIGTERM", "SIGHUP"):  # end as in order as by Ctrl-C
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), _interrupt)
    add_routes(app, session)
    build_page(session)
    if show:
        app.on_startup(lambda: _show(f"http://{HOST}:{port}"))
    ui.run(
        host=HOST,
        port=port,
        title="flowtree studio",
        show=False,
        reload=False,
        show_welcome_message=False,
        gzip_middleware_factory=None,  # nothing leaves the machine, and layers are packed already
        reconnect_timeout=_LONGEST_SILENCE,
        dark=None,
    )


def _interrupt(number: int, frame: FrameType | None) -> None:
    del number, frame
    raise KeyboardInterrupt


def _show(address: str) -> None:
    with contextlib.suppress(webbrowser.Error):
        webbrowser.open(address)


def _is_free(port: int) -> bool:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError:
            return False
    return True
