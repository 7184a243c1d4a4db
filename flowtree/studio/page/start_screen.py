"""What a new project shows: a place to drop photos on."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.keep_picture import DEMO
from flowtree.studio.page.photo_strip import PHOTO_KINDS
from flowtree.studio.page.workbench import Workbench


class StartScreen:
    """Over the whole page as long as there is no photo."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        with ui.element("div").classes("start") as self._screen, ui.element("div").classes("start-card"):
            ui.icon("park").classes("start-icon")
            ui.label("Two photos of a tree").classes("start-title")
            ui.label(
                "Drop them here: one from the front, one from the side. A rough quarter turn between them is"
                " enough. The tree grows by itself, in some ten seconds; then you shape it."
            ).classes("start-text")
            with ui.element("div").classes("start-buttons"):
                choose = ui.button("Choose photos", color=None).props("unelevated no-caps").classes("primary")
                choose.props["data-choose"] = PHOTO_KINDS
                project = (
                    ui.button("Open a project (.zip)", color=None).props("flat no-caps").classes("quiet")
                )
                project.props["data-choose"] = ".zip,application/zip"
            with ui.element("button").classes("start-demo").mark("demo") as demo:
                for file in DEMO:
                    ui.image(file).classes("start-thumb").props("no-spinner no-transition")
                ui.label("No photos at hand? Take the bundled pair")
            demo.on("click", lambda: bench.call(bench.session.use_demo))
            ui.label("Your photos stay on this machine.").classes("start-foot")
        bench.watch(self.show)

    def show(self) -> None:
        """There only while the project is empty."""
        self._screen.set_visibility(not self.bench.state["photos"])
