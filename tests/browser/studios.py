"""A studio that runs as a person starts it, and a page that shows it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.browser.chromium import open_browser, watch_page

PATIENCE = 120.0  # [s]; what takes longer hangs, on a busy machine too
_START = "from flowtree.cli.main import main; main()"


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextlib.contextmanager
def run_studio(project: Path, port: int | None = None) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Starts ``flowtree studio`` on a folder; yields its address and its process, which may be killed."""
    port = free_port() if port is None else port
    command = [sys.executable, "-c", _START, "studio", str(project), "--no-browser", "--port", str(port)]
    # NiceGUI behaves otherwise where it finds itself in a test.
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        try:
            address = f"http://127.0.0.1:{port}"
            _wait_for(f"{address}/state", process)
            yield address, process
        finally:
            process.send_signal(signal.SIGINT)
            said, _ = process.communicate(timeout=PATIENCE)
    assert process.returncode in (0, -signal.SIGKILL), said
    assert "Traceback" not in said, said


def _wait_for(url: str, process: subprocess.Popen[str]) -> None:
    until = time.monotonic() + PATIENCE
    while True:
        assert process.poll() is None, process.communicate()[0]
        with contextlib.suppress(OSError), urllib.request.urlopen(url, timeout=5):
            return
        assert time.monotonic() < until, "the studio does not answer"
        time.sleep(0.1)


def show(page: Any, address: str) -> None:
    """Opens a studio's page."""
    page.goto(address)
    page.wait_for_selector(".photo-board canvas", state="attached")
    page.wait_for_selector(".tree-viewer canvas", state="attached")
    page.wait_for_function("document.querySelector('.project-name').textContent !== ''")


class Studio:
    """A page on a running studio, and what a person does on it."""

    def __init__(self, address: str, project: Path, page: Any) -> None:
        self.address = address
        self.project = project
        self.page = page
        self.requests: list[str] = []
        folder = os.environ.get("FLOWTREE_PICTURES")
        self.pictures = Path(folder) if folder else None
        page.set_default_timeout(1000 * PATIENCE)
        page.on("request", lambda request: self.requests.append(request.url))
        self.open()

    def open(self) -> None:
        """Opens the page, or opens it again."""
        show(self.page, self.address)

    def state(self) -> dict[str, Any]:
        """What the project holds."""
        with urllib.request.urlopen(f"{self.address}/state", timeout=30) as answer:
            state: dict[str, Any] = json.loads(answer.read())
        return state

    def layer(self, name: str) -> bytes | None:
        """A layer as it is now."""
        try:
            with urllib.request.urlopen(f"{self.address}/layer/0/{name}", timeout=30) as answer:
                return bytes(answer.read())
        except urllib.error.HTTPError:
            return None

    def until(self, fits: Any, what: str) -> dict[str, Any]:
        """Waits for a state; keeps the page going meanwhile."""
        until = time.monotonic() + PATIENCE
        while not fits(state := self.state()):
            about = {key: state[key] for key in ("revision", "undo", "redo", "busy", "problem")}
            assert time.monotonic() < until, f"{what}: {about}"
            self.page.wait_for_timeout(50)
        return state

    def settle(self) -> dict[str, Any]:
        """Waits until all is done and saved."""
        return self.until(lambda state: state["saved"] and not state["busy"], "never done")

    def changed(self, name: str, before: bytes | None) -> bytes:
        """Waits until a layer is another one."""
        self.until(lambda _: self.layer(name) not in (None, before), f"{name} stays as it was")
        return self.layer(name) or b""

    def press(self, keys: str) -> None:
        self.page.keyboard.press(keys)

    def choose(self, name: str) -> None:
        """A tool of the board, or what is chosen over it."""
        self.page.locator(f'.photos [data-choice="{name}"]:visible').click()
        self._take(name)

    def mode(self, key: str, name: str) -> None:
        """A kind of work, by its key."""
        self.press(key)
        self._take(name)

    def _take(self, name: str) -> None:
        """Waits until the board has a tool: people look before they draw."""
        self.page.wait_for_selector(f'.photos [data-choice="{name}"].chosen:visible')
        self.page.wait_for_selector(f'.photo-board canvas[data-tool~="{name}"]')

    def show(self, name: str) -> None:
        """Shows or hides a layer of the viewer, or chooses how it is shown."""
        self.page.locator(f'.tree [data-choice="{name}"]:visible').click()

    def draw(self, *points: tuple[float, float]) -> None:
        """Draws with the mouse over the board, by shares of its width and height."""
        box = self.page.locator(".photo-board canvas").last.bounding_box()
        places = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in points]
        self.page.mouse.move(*places[0])
        self.page.mouse.down()
        for place in places[1:]:
            self.page.mouse.move(*place, steps=8)
        self.page.mouse.up()

    def picture(self, name: str) -> None:
        """Keeps a picture of the page to be looked at, where somebody wants to."""
        if self.pictures is None:
            return
        self.page.mouse.move(5, 5)
        self.page.evaluate("document.querySelector('.shape-scroll').scrollTop = 0")
        self.page.wait_for_timeout(1000)  # tips fade, the viewer draws
        self.page.screenshot(path=self.pictures / f"{name}.png")
        self.page.screenshot(path=self.pictures / f"{name}.jpg", type="jpeg", quality=88)


@contextlib.contextmanager
def open_studio(project: Path, **options: Any) -> Iterator[Studio]:
    """A studio with a page; errors on it, and requests to elsewhere, fail the test.

    Pictures of the page are kept in the folder that ``FLOWTREE_PICTURES`` names.
    """
    # Without a graphics card every pixel costs: where nobody looks, coarse ones do.
    ratio = 1.0 if os.environ.get("FLOWTREE_PICTURES") else 0.5
    page = {"viewport": {"width": 1280, "height": 800}, "color_scheme": "dark", "device_scale_factor": ratio}
    options = {**page, **options}
    with (
        open_browser() as browser,
        run_studio(project) as (address, _),
        watch_page(browser, expected=("422",), **options) as page,  # a refused photo
    ):
        studio = Studio(address, project, page)
        yield studio
        own = (address, address.replace("http", "ws"), "blob:", "data:")
        foreign = [url for url in studio.requests if not url.startswith(own)]
        assert not foreign, foreign[:3]
