"""Pages in headless Chromium, served from this machine alone, with three.js and our files at hand."""

from __future__ import annotations

import contextlib
import functools
import http.server
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

from tests.clients.node import modules

_HERE = Path(__file__).parent
_NAMES = ("chromium", "chromium-browser", "google-chrome")
# What a browser without a screen and without a graphics card needs, run as root in a container.
_FLAGS = (
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--enable-unsafe-swiftshader",
    "--use-gl=angle",
    "--use-angle=swiftshader-webgl",
)
_WAIT = 120_000  # [ms]


@contextlib.contextmanager
def open_browser() -> Iterator[Any]:
    """Starts Chromium; skips the test where there is none.

    Yields: playwright's browser.
    """
    playwright = _import_playwright()
    browser_file = next(filter(None, map(shutil.which, _NAMES)), None)
    if browser_file is None:
        pytest.skip("Chromium is not installed")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=browser_file, args=list(_FLAGS))
        try:
            yield browser
        finally:
            browser.close()


@contextlib.contextmanager
def watch_page(browser: Any, *, expected: tuple[str, ...] = (), **options: Any) -> Iterator[Any]:
    """A page whose errors fail the test, also those that it only writes to the console.

    Args:
        browser: from `open_browser`.
        expected: words of errors that are no failure.
        options: of playwright's ``new_context``.

    Yields: playwright's page.
    """
    context = browser.new_context(**options)
    shown = context.new_page()
    shown.set_default_timeout(_WAIT)
    errors: list[str] = []

    def note(message: Any) -> None:
        if message.type == "error" and not any(word in message.text for word in expected):
            errors.append(f"{message.text} {message.location}")

    shown.on("pageerror", lambda error: errors.append(str(error)))
    shown.on("console", note)
    try:
        yield shown
        assert not errors, errors[:3]
    finally:
        context.close()


@contextlib.contextmanager
def open_page(page: str, files: Path, **roots: Path) -> Iterator[Any]:
    """Opens a page of this folder; skips the test where there is no Chromium.

    On the page's own origin lie this folder, ``/files/`` with the given one, and ``/node_modules/`` unless
    other folders are given.

    Args:
        page: name of the HTML file.
        files: folder that the page may read.
        roots: more folders, by the first part of their address.

    Yields: playwright's page; an error in it fails the test.
    """
    if not roots:
        roots = {"node_modules": modules() / "node_modules"}
    with (
        open_browser() as browser,
        _serve({**roots, "files": files}) as address,
        watch_page(browser, viewport={"width": 640, "height": 800}) as shown,
    ):
        shown.goto(f"{address}/{page}")
        shown.wait_for_function("window.ready === true")
        yield shown


def _import_playwright() -> Any:
    try:
        from playwright import sync_api
    except ImportError:
        pytest.skip("playwright is not installed")
    return sync_api


@contextlib.contextmanager
def _serve(roots: dict[str, Path]) -> Iterator[str]:
    handler = functools.partial(_Handler, roots)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            thread.join()


class _Handler(http.server.SimpleHTTPRequestHandler):
    """Serves each first part of a path from its own folder, all else from this one."""

    def guess_type(self, path: Any) -> str:
        kinds = {".js": "text/javascript", ".mjs": "text/javascript", ".html": "text/html"}
        return kinds.get(Path(path).suffix, "application/octet-stream")

    def __init__(self, roots: dict[str, Path], *args: Any) -> None:
        self._roots = roots
        super().__init__(*args)

    def translate_path(self, path: str) -> str:
        first, *rest = unquote(urlsplit(path).path).lstrip("/").split("/")
        assert ".." not in rest
        root = self._roots.get(first)
        return str(root.joinpath(*rest) if root else _HERE.joinpath(first, *rest))

    def log_message(self, *_: Any) -> None:
        pass
