"""What a new project shows: a place to drop photos on."""

from __future__ import annotations

from nicegui import ui

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
                "Drop them here: one from the front, one from the side."
                " A rough quarter turn between them is enough."
            ).classes("start-text")
            with ui.element("div").classes("start-buttons"):
                choose = ui.button("Choose photos", color=None).props("unelevated no-caps").classes("primary")
                choose.props["data-choose"] = PHOTO_KINDS
                demo = (
                    ui.button("Take the bundled pair", color=None)
                    .props("flat no-caps")
                    .classes("quiet")
                    .mark("demo")
                )
                demo.on_click(lambda: bench.call(bench.session.use_demo))
                project = (
                    ui.button("Open a project (.zip)", color=None).props("flat no-caps").classes("quiet")
                )
                project.props["data-choose"] = ".zip,application/zip"
        bench.watch(self.show)

    def show(self) -> None:
        """There only while the project is empty."""
        self._screen.set_visibility(not self.bench.state["photos"])
