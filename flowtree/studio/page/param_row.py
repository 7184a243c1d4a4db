"""A row for one parameter, made from what the schema says about it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from nicegui import ui
from nicegui.elements.mixins.value_element import ValueElement

from flowtree.studio.page.choices import quiet_tip
from flowtree.studio.page.entry_field import EntryField
from flowtree.studio.page.workbench import Workbench

_STEPS = 200  # of a slider


class ParamRow:
    """Name, control and a way back to the default.

    A number with bounds has a slider and a field; a choice a menu; a yes or no a switch; all else a field.
    """

    def __init__(self, bench: Workbench, field: dict[str, Any], *, title: str | None = None) -> None:
        self.bench = bench
        self.field = field
        self._showing = False
        self._gesture = bench.next_gesture()
        self._slider: ui.slider | None = None
        with ui.element("div").classes("param").props(f'data-param="{field["name"]}"') as self.row:
            with ui.element("div").classes("param-head"):
                with ui.label(title or title_of(field["name"])).classes("param-name"):
                    quiet_tip(_tip(field)).classes("param-tip")
                self._reset = ui.button(icon="undo", on_click=self._to_default, color=None)
                self._reset.props("flat dense aria-label=Reset").classes("param-reset")
                with self._reset:
                    quiet_tip("Back to the default")
                self._show = self._control()
            if self._slider is not None:
                self._slider.move(self.row)

    def show(self) -> None:
        """Shows the value that the project has."""
        section, name = self.field["name"].split(".")
        value = self.bench.state["params"][section][name]
        self._showing = True
        self._show(value)
        self._showing = False
        changed = value != self.field["default"]
        self.row.classes(add="changed" if changed else "", remove="" if changed else "changed")

    def _set(self, value: Any) -> None:
        if not self._showing:
            self.bench.do("SetParam", name=self.field["name"], value=value, gesture=self._gesture)

    def _end_gesture(self) -> None:
        self._gesture = self.bench.next_gesture()

    def _to_default(self) -> None:
        self._end_gesture()
        self._set(self.field["default"])
        self._end_gesture()

    def _control(self) -> Callable[[Any], None]:
        """Builds the control; returns how it shows a value."""
        field = self.field
        if field["choices"]:
            select = ui.select(field["choices"], on_change=lambda event: self._set(event.value))
            select.props("dense borderless options-dense").classes("param-select")
            return lambda value: set_value(select, value)
        if field["kind"] == "flag":
            switch = (
                ui.switch(on_change=lambda event: self._set(event.value))
                .props("dense")
                .classes("param-switch")
            )
            return lambda value: set_value(switch, value)
        if field["kind"] in ("number", "whole"):
            return self._number()
        entry = EntryField(lambda text: self._set(read_text(text, field)))
        entry.input.classes("param-entry")
        return lambda value: entry.show(write_text(value))

    def _number(self) -> Callable[[Any], None]:
        field = self.field
        entry = EntryField(self._typed)
        entry.input.props(f'inputmode=decimal suffix="{_short(field["unit"])}"').classes("param-entry")
        scale = Scale(field)
        self._slider = slider = ui.slider(min=0, max=_STEPS, step=1, value=0)
        slider.props("dense").classes("param-slider")
        slider.props["aria-label"] = field["name"]
        slider.on_value_change(lambda event: self._set(scale.value(event.value)))
        slider.on("change", self._end_gesture)

        def show(value: Any) -> None:
            entry.show("auto" if value is None else write_number(value))
            slider.set_value(scale.place(field["default"] if value is None else value))

        return show

    def _typed(self, text: str) -> None:
        self._end_gesture()
        if text in ("", "auto") and self.field["optional"]:
            self._set(None)
            return
        try:
            value = float(text.replace(",", "."))
        except ValueError:
            self.show()
            return
        self._set(round(value) if self.field["kind"] == "whole" else value)
        self._end_gesture()


def set_value(element: ValueElement[Any], value: Any) -> None:
    """Shows a value in a control."""
    element.value = value


class Scale:
    """A slider's places for a parameter: evenly where its range is narrow, by ratio where it is wide."""

    def __init__(self, field: dict[str, Any]) -> None:
        self.whole = field["kind"] == "whole"
        default = field["default"]
        low = float(field["minimum"] or 0.0)
        usual = float(default) if isinstance(default, int | float) and default else low + 1.0
        high = float(field["maximum"]) if field["maximum"] is not None else 10.0 * usual
        # Bounds say what is allowed, not what is of use: a slider reaches a few times beyond the default.
        self.low, self.high = low, high
        self.ratio = low >= 0.0 and high > 8.0 * max(usual, 1e-9) and usual > 0.0
        if self.ratio:
            self.low = max(low, usual / 30.0)
            self.high = min(high, usual * 30.0)

    def value(self, place: float) -> float | int:
        """The value at a place, rounded to what one can tell apart."""
        share = place / _STEPS
        value = (
            self.low * (self.high / self.low) ** share
            if self.ratio
            else self.low + share * (self.high - self.low)
        )
        if self.whole:
            return round(value)
        size = abs(value) if self.ratio else self.high - self.low
        return round(value, max(0, 2 - math.floor(math.log10(size)))) if size > 0 else value

    def place(self, value: float | None) -> int:
        """The place of a value; the nearest end beyond them."""
        if value is None:
            return _STEPS // 2
        inside = min(max(float(value), self.low), self.high)
        share = (
            math.log(inside / self.low) / math.log(self.high / self.low)
            if self.ratio
            else (inside - self.low) / max(self.high - self.low, 1e-12)
        )
        return round(share * _STEPS)


def title_of(name: str) -> str:
    """``flow.particle_count`` as people say it."""
    words = name.split(".")[-1].replace("_", " ")
    return words[:1].upper() + words[1:]


def write_number(value: float) -> str:
    """A number without needless digits."""
    return f"{value:.4g}" if abs(value) < 10_000 else f"{value:.0f}"


def write_text(value: Any) -> str:
    """A list as words with commas, nothing as an empty text."""
    if value is None:
        return ""
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def read_text(text: str, field: dict[str, Any]) -> Any:
    """The inverse of `write_text`: a list where the parameter is one."""
    if field["kind"] == "list":
        parts = [part.strip() for part in text.split(",") if part.strip()]
        return [float(part) if _is_number(part) else part for part in parts]
    return text or field["default"]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _short(unit: str) -> str:
    return {
        "degrees": "°",
        "tree heights": "h",
        "trunk radii": "r",
        "lengths": "",
        "1/tree height": "/h",
    }.get(unit, unit)


def _tip(field: dict[str, Any]) -> str:
    said = field["description"]
    text = said[:1].upper() + said[1:]
    unit = f" [{field['unit']}]" if field["unit"] else ""
    low, high = field["minimum"], field["maximum"]
    span = f" · {write_number(low)} to {write_number(high)}" if low is not None and high is not None else ""
    return f"{text}{unit}{span} · {field['name']}"
