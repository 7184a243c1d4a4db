"""The panel at the right: variants, what matters most, and every parameter."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.param_row import ParamRow
from flowtree.studio.page.param_sections import TITLES, param_sections
from flowtree.studio.page.variant_grid import VariantGrid
from flowtree.studio.page.workbench import Workbench

# What matters most, in the order shown, and what a person calls it.
_KIND = {
    "attraction.habit": "Habit",
    "leaves.bear": "Bears leaves",
    "leaves.shape": "Leaf",
    "meshing.bark_style": "Bark",
}
_SHAPE = {
    "leaves.amount": "Leaves",
    "leaves.size": "Leaf size",
    "leaves.hang": "Hanging leaves",
    "twigs.length": "Twig length",
    "twigs.rigidity": "Stiffness of twigs",
    "field.reach": "Pull to the branches",
    "flow.attraction": "Pull between particles",
    "branches.smoothing": "Smoothness",
    "thickness.trunk_radius": "Trunk radius",
    "thickness.taper": "Taper",
    "meshing.root_flare": "Root flare",
}
# Those of the finished file belong to its export.
_OF_THE_FILE = {"asset", "wind", "collision", "export"}
_PICTURES = (("leaves.picture", "Leaf picture", "image/png"), ("meshing.bark", "Bark picture", "image/*"))


class ShapePanel:
    """Parameters as rows; those of a stage are built when its section is first opened."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self._rows: list[ParamRow] = []
        self._sections = param_sections()
        self._fields = {field["name"]: field for fields in self._sections.values() for field in fields}
        with ui.element("aside").classes("panel shape"), ui.element("div").classes("shape-scroll"):
            self.variants = VariantGrid(bench)
            self._head("Kind")
            for name, title in _KIND.items():
                self._add(name, title)
            self._pictures()
            self._head("Shape")
            for name, title in _SHAPE.items():
                self._add(name, title)
            self._head("All parameters", reset=True)
            for name, title in TITLES.items():
                if name not in _OF_THE_FILE:
                    self._section(name, title)
        bench.watch(self.show)

    def show(self) -> None:
        """Shows the project's values."""
        for row in self._rows:
            row.show()

    def _head(self, text: str, *, reset: bool = False) -> None:
        with ui.element("div").classes("section-head"):
            ui.label(text)
            if reset:
                ui.element("div").classes("space")
                button = ui.button(
                    "Reset all", on_click=lambda: self.bench.do("ResetParams", section=None), color=None
                )
                button.props("flat dense no-caps").classes("quiet")

    def _add(self, name: str, title: str | None = None) -> None:
        self._rows.append(ParamRow(self.bench, self._fields[name], title=title))

    def _pictures(self) -> None:
        """Buttons that ask for a picture of a leaf, of bark."""
        with ui.element("div").classes("picture-row"):
            for name, text, kinds in _PICTURES:
                button = (
                    ui.button(text, icon="upload", color=None).props("flat dense no-caps").classes("quiet")
                )
                button.props["data-choose"] = kinds
                button.props["data-parameter"] = name

    def _section(self, name: str, title: str) -> None:
        with ui.expansion(title).props("dense dense-toggle").classes("stage") as fold:
            body = ui.element("div")
        built = False

        def build(opened: bool) -> None:
            nonlocal built
            if not opened or built:
                return
            built = True
            with body:
                start = len(self._rows)
                for field in self._sections[name]:
                    if field["kind"] != "picture":
                        self._add(field["name"])
                for row in self._rows[start:]:
                    row.show()
                reset = ui.button(f"Reset {title.lower()}", color=None)
                reset.on_click(lambda: self.bench.do("ResetParams", section=name))
                reset.props("flat dense no-caps").classes("quiet")

        fold.on_value_change(lambda event: build(bool(event.value)))
