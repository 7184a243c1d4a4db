"""The bar at the top: the project, undo and redo, help, light and dark, export."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui

from flowtree.studio.page.choices import icon_button, quiet_tip
from flowtree.studio.page.workbench import Workbench


class TopBar:
    """Name of the project at the left, what concerns all of it at the right."""

    def __init__(
        self, bench: Workbench, *, on_help: Callable[[], object], on_export: Callable[[], object]
    ) -> None:
        self.bench = bench
        self._dark = ui.dark_mode(None)
        with ui.element("header").classes("top-bar"):
            with ui.element("div").classes("brand"):
                ui.icon("park")
                ui.label("flowtree").classes("brand-name")
            self._name = ui.label().classes("project-name")
            self._saved = ui.label().classes("saved")
            ui.element("div").classes("space")
            self._undo = self._step("undo", lambda: bench.call(bench.session.undo))
            self._redo = self._step("redo", lambda: bench.call(bench.session.redo))
            ui.element("div").classes("gap")
            icon_button("help_outline", "Help, and all keys (H)", on_help)
            icon_button("contrast", "Light or dark", self._turn_light)
            icon_button("tune", "Show or hide the panel of shapes", self._fold, classes="fold-shape")
            self._export = ui.button("Export", on_click=on_export, color=None)
            self._export.props("unelevated no-caps dense").classes("primary").mark("export")
        bench.watch(self.show)

    def show(self) -> None:
        """Shows the project's name and what can be undone."""
        state = self.bench.state
        self._name.set_text(state["name"])
        self._export.set_enabled(bool(state["photos"]))
        lost = self.bench.unsaved
        self._saved.set_text("not saved" if lost else "saved" if state["saved"] else "saving …")
        self._saved.classes(add="bad" if lost else "", remove="" if lost else "bad")
        for (button, tip), what, word, key in (
            (self._undo, state["undo"], "Undo", "Ctrl+Z"),
            (self._redo, state["redo"], "Redo", "Ctrl+Y"),
        ):
            button.set_enabled(what is not None)
            tip.set_text(f"{word}: {what} ({key})" if what else f"Nothing to {word.lower()}")

    def _step(self, icon: str, on_click: Callable[[], object]) -> tuple[ui.button, ui.tooltip]:
        button = (
            ui.button(icon=icon, on_click=on_click, color=None)
            .props("flat dense")
            .classes("icon-button")
            .mark(icon)
        )
        button.props["aria-label"] = icon.capitalize()
        with button:
            tip = quiet_tip()
        return button, tip

    def _turn_light(self) -> None:
        # The first turn leaves what the system prefers, which only the browser knows.
        async def turn() -> None:
            dark = await ui.run_javascript("document.body.classList.contains('body--dark')")
            self._dark.set_value(not dark)

        ui.timer(0, turn, once=True)

    def _fold(self) -> None:
        ui.run_javascript("document.querySelector('.studio').classList.toggle('folded')")
