"""What a person sees when something breaks: it is said, nothing is lost, and the page goes on."""

from __future__ import annotations

import os
import resource
import signal
from pathlib import Path

import pytest

from flowtree.configuration import override_params
from flowtree.params import Params
from flowtree.project.project import Project
from flowtree.project.save_project import save_project
from tests.browser.chromium import open_browser, watch_page
from tests.browser.studios import Studio, free_port, run_studio
from tests.pictures import save_pair

_SMALL = ["density.resolution=20", "flow.particle_count=150", "attraction.seed_count=8"]
_SMALL += ["leaves.most=200", "twigs.most=100"]
_LOST = ("ERR_CONNECTION_REFUSED", "WebSocket", "ERR_EMPTY_RESPONSE", "ERR_INCOMPLETE")


@pytest.fixture(scope="module")
def browser():
    with open_browser() as opened:
        yield opened


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    folder = tmp_path_factory.mktemp("failures")
    save_project(
        Project(photos=tuple(save_pair(folder)), height=6.0, params=override_params(Params(), _SMALL)),
        folder / "oak",
    )
    return folder / "oak"


def _workers(parent: int) -> list[int]:
    """The processes that a studio has spawned to work for it."""
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal():
            try:
                stat, command = (entry / "stat").read_text(), (entry / "cmdline").read_text()
            except OSError:
                continue  # it has just ended
            if int(stat.rsplit(")", 1)[1].split()[1]) == parent and "spawn_main" in command:
                found.append(int(entry.name))
    return found


def test_a_stop_a_crash_a_full_disk_and_a_lost_connection_lose_nothing(browser, project):
    port = free_port()
    with watch_page(browser, expected=_LOST, viewport={"width": 1280, "height": 800}) as page:
        with run_studio(project, port) as (address, process):
            studio = Studio(address, project, page)
            studio.settle()
            _stop(studio, process.pid)
            _crash(studio, process.pid)
            _fill_the_disk(studio, process.pid)
            process.kill()
            page.get_by_text("Connection lost").wait_for()
            page.wait_for_function("getComputedStyle(document.getElementById('popup')).opacity === '1'")
            assert page.evaluate("document.elementFromPoint(300, 400).closest('#popup') !== null"), (
                "what is drawn now would be lost"
            )
            studio.picture("lost")
        with run_studio(project, port):
            page.wait_for_function("document.getElementById('popup').ariaHidden === 'true'")
            page.wait_for_function("document.querySelector('.figures')?.textContent.includes('leaves')")
            state = studio.state()
            assert (len(state["photos"][0]["paint"]), state["seed"]) == (1, 5)
            studio.press("Control+z")
            studio.until(lambda state: not state["photos"][0]["paint"], "what was done before can be undone")
            studio.settle()


def _begin(studio: Studio, pid: int, seed: str) -> list[int]:
    """Has another tree made by workers that are halted: else it might be there before anybody looks."""
    workers = _workers(pid)
    assert len(workers) == 2
    for worker in workers:
        os.kill(worker, signal.SIGSTOP)
    entry = studio.page.locator(".shape .field input")
    entry.fill(seed)
    entry.press("Enter")
    entry.blur()
    studio.until(lambda state: state["seed"] == int(seed) and state["busy"], "not begun")
    return workers


def _stop(studio: Studio, pid: int) -> None:
    """A person stops what runs, and goes on."""
    _begin(studio, pid, "4")
    studio.page.locator(".status").get_by_text("Stop").click()
    studio.page.wait_for_selector(".state-dot.stopped")
    assert not studio.state()["busy"]
    studio.page.locator(".status").get_by_text("Grow").click()
    studio.settle()
    studio.page.wait_for_selector(".state-dot.rest")


def _crash(studio: Studio, pid: int) -> None:
    """Both workers die while they are at work."""
    for worker in _begin(studio, pid, "5"):
        os.kill(worker, signal.SIGKILL)
    studio.page.locator(".q-notification").get_by_text("ended unexpectedly").wait_for()
    assert studio.page.locator(".state-dot.failed").count() == 1
    studio.picture("crash")
    studio.page.locator(".status").get_by_text("Grow").click()
    studio.until(lambda state: not state["busy"] and state["problem"] is None, "it does not go on")
    studio.page.wait_for_selector(".state-dot.rest")


def _fill_the_disk(studio: Studio, pid: int) -> None:
    """No file may grow any more; then there is room again."""
    before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
    resource.prlimit(pid, resource.RLIMIT_FSIZE, (100, before[1]))
    studio.mode("4", "density")
    studio.draw((0.5, 0.4), (0.6, 0.45))
    studio.page.locator(".q-notification").get_by_text("could not be written").wait_for()
    assert studio.page.inner_text(".saved") == "not saved"
    studio.picture("full")
    resource.prlimit(pid, resource.RLIMIT_FSIZE, before)
    studio.until(lambda state: state["saved"], "not saved, though there is room again")
    studio.page.wait_for_function("document.querySelector('.saved').textContent === 'saved'")
    assert len(studio.state()["photos"][0]["paint"]) == 1
