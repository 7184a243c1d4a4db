"""Small flat controls: a button with an icon, and a row of which one or several are chosen."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from nicegui import ui


def quiet_tip(text: str = "") -> ui.tooltip:
    """A tip that waits until somebody looks for it."""
    return ui.tooltip(text).props("delay=600")


def icon_button(icon: str, tip: str, on_click: Callable[[], object], *, classes: str = "") -> ui.button:
    """A button that shows only an icon; its tip says what it does and by which key."""
    button = (
        ui.button(icon=icon, on_click=on_click, color=None)
        .props("flat dense")
        .classes(f"icon-button {classes}")
    )
    button.props["aria-label"] = tip
    with button:
        quiet_tip(tip)
    return button


@dataclass(frozen=True)
class Choice:
    """One of a row.

    Attributes:
        name: what is chosen by it.
        icon: shown; none for ''.
        text: shown; none for ''.
        tip: says more.
        color: of its icon, or of a dot in its place; none for ''.
    """

    name: str
    icon: str = ""
    text: str = ""
    tip: str = ""
    color: str = ""


class ChoiceRow:
    """Buttons in a row of which one is chosen, or any number of them."""

    def __init__(
        self,
        choices: Iterable[Choice],
        on_choose: Callable[[str], object],
        *,
        chosen: Iterable[str] = (),
        classes: str = "",
    ) -> None:
        self.buttons: dict[str, ui.button] = {}
        with ui.element("div").classes(f"choices {classes}") as self.row:
            for choice in choices:
                button = ui.button(on_click=lambda name=choice.name: on_choose(name), color=None)
                button.props("flat dense no-caps").classes("choice").mark(f"choice-{choice.name}")
                button.props["aria-label"] = choice.tip or choice.text or choice.name
                button.props["data-choice"] = choice.name
                with button:
                    if choice.icon:
                        ui.icon(choice.icon).style(f"color:{choice.color}" if choice.color else "")
                    elif choice.color:
                        ui.element("span").classes("dot").style(f"background:{choice.color}")
                    if choice.text:
                        ui.label(choice.text)
                    if choice.tip:
                        quiet_tip(choice.tip)
                self.buttons[choice.name] = button
        self.show(*chosen)

    def show(self, *chosen: str) -> None:
        """Marks those that are chosen."""
        for name, button in self.buttons.items():
            on = name in chosen
            button.classes(add="chosen" if on else "", remove="" if on else "chosen")
            button.props["aria-pressed"] = "true" if on else "false"

    def hide(self, hidden: bool) -> None:
        """Takes the row away, or shows it."""
        self.row.set_visibility(not hidden)
