"""What stands in the place of the tree until the first one is there."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.workbench import Workbench


class GrowingCard:
    """How far the first tree is, or why there is none, where a person looks for it."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self._grown = False
        with ui.element("div").classes("growing") as self._card:
            ui.icon("park").classes("growing-icon")
            self._text = ui.label().classes("growing-text")
            with ui.element("div").classes("progress") as self._bar:
                self._share = ui.element("div").classes("progress-share")
        self._card.set_visibility(False)
        bench.watch(self.show)

    def show(self) -> None:
        """There only while there are photos, and no tree."""
        some = bool(self.bench.state["photos"])
        self._grown = self._grown and some
        self._card.set_visibility(some and not self._grown and bool(self._text.text))

    def progress(self, text: str, share: float) -> None:
        """What is done now, and how much of it is behind."""
        self._say(text, failed=False)
        self._share.style(f"width:{100 * share:.0f}%")

    def failed(self, message: str) -> None:
        """Why there is no tree."""
        self._say(message, failed=True)

    def grown(self) -> None:
        """A tree is on the screen."""
        self._grown = True
        self.show()

    def _say(self, text: str, *, failed: bool) -> None:
        self._text.set_text(text)
        self._bar.set_visibility(not failed)
        self._card.classes(add="bad" if failed else "", remove="" if failed else "bad")
        self.show()
