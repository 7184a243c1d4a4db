"""A text field for a value of the project, in which somebody may be typing."""

from __future__ import annotations

from collections.abc import Callable

from nicegui import ui


class EntryField:
    """Shows what the project has, and leaves alone what is half typed.

    The page learns of the project's state at any moment, most of all while a tree is made. A field takes over
    only a text that is another than the one it was last told, and any after what was typed has been sent: so
    a refused value gives way to the old one.

    Attributes:
        input: NiceGUI's, for its looks.
    """

    def __init__(self, on_typed: Callable[[str], object], label: str | None = None) -> None:
        self.input = ui.input(label).props("dense borderless")
        self.input.on("change", self._typed)
        self._on_typed = on_typed
        self._told: str | None = None

    def show(self, text: str) -> None:
        """Shows a text if it is news."""
        if text != self._told:
            self._told = text
            self.input.set_value(text)

    def _typed(self) -> None:
        self._told = None
        self._on_typed(str(self.input.value or "").strip())
