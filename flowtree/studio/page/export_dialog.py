"""Writing the tree as a file, with what an engine wants."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from flowtree.studio.page.choices import Choice, ChoiceRow, quiet_tip
from flowtree.studio.page.param_sections import param_sections
from flowtree.studio.page.workbench import Workbench

_KINDS = (
    Choice("glb", "", "GLB", "Games and the web: one small file"),
    Choice("usdz", "", "USDZ", "Film and phones"),
    Choice("usdc", "", "USDC", "Film, binary"),
    Choice("usda", "", "USDA", "Film, as text"),
    Choice("obj", "", "OBJ", "Every program"),
    Choice("ply", "", "PLY", "Every program, one mesh"),
    Choice("swc", "", "SWC", "The branches as a skeleton"),
    Choice("csv", "", "CSV", "The branches as cylinders"),
    Choice("json", "", "JSON", "The branches as a skeleton with all its values"),
    Choice("project", "", "Project", "Photos, drawings and parameters as one archive"),
)
_OPTIONS = (
    "asset.max_triangles",
    "asset.levels",
    "asset.impostor",
    "asset.texture_size",
    "asset.atlas",
    "wind.channels",
    "wind.sway",
    "collision.engine",
    "export.quantise",
    "export.instanced",
    "export.separate_levels",
)
_MESHES = {"glb", "usdz", "usdc", "usda", "obj", "ply"}
_TITLES = {
    "asset.max_triangles": "Triangles at most",
    "asset.levels": "Levels of detail",
    "asset.impostor": "Cards for far away",
    "asset.texture_size": "Texture size",
    "asset.atlas": "One texture for all",
    "wind.channels": "Wind for shaders",
    "wind.sway": "Swaying joints",
    "collision.engine": "Collision bodies",
    "export.quantise": "Fewer bits",
    "export.instanced": "Instanced leaves",
    "export.separate_levels": "A file for each level",
}


class ExportDialog:
    """A kind of file, its options, and a button."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.kind = "glb"
        self.options: dict[str, Any] = {}
        fields = {field["name"]: field for part in param_sections().values() for field in part}
        with ui.dialog() as self.dialog, ui.element("div").classes("sheet export"):
            ui.label("Export").classes("sheet-title")
            self._kinds = ChoiceRow(_KINDS, self._choose, chosen=(self.kind,), classes="kinds")
            self._said = ui.label().classes("sheet-text")
            with ui.element("div").classes("option-grid") as self._grid:
                for name in _OPTIONS:
                    self._option(fields[name])
            with ui.element("div").classes("sheet-foot"):
                self._wait = ui.label().classes("sheet-text")
                ui.element("div").classes("space")
                ui.button("Close", on_click=self.dialog.close, color=None).props(
                    "flat no-caps dense"
                ).classes("quiet")
                self._go = ui.button("Write the file", on_click=self._write, color=None)
                self._go.props("unelevated no-caps dense").classes("primary").mark("write")
        self._choose(self.kind)

    def open(self) -> None:
        """Shows it."""
        self._wait.set_text("")
        self._go.set_enabled(bool(self.bench.state["photos"]))
        self.dialog.open()

    def done(self, url: str, name: str) -> None:
        """A file is written: the browser takes it."""
        self._go.enable()
        self.dialog.close()
        ui.download.from_url(url, name)

    def failed(self) -> None:
        """It came to nothing; the page says why."""
        self._wait.set_text("")
        self._go.enable()

    def _choose(self, kind: str) -> None:
        self.kind = kind
        self._kinds.show(kind)
        self._said.set_text(next(choice.tip for choice in _KINDS if choice.name == kind))
        self._grid.set_visibility(kind in _MESHES)

    def _option(self, field: dict[str, Any]) -> None:
        name = field["name"]

        def keep(value: Any) -> None:
            self.options[name] = value

        with ui.label(_TITLES[name]):
            quiet_tip(f"{field['description'][:1].upper()}{field['description'][1:]}")
        if field["choices"]:
            ui.select(
                field["choices"], value=field["default"], on_change=lambda event: keep(event.value)
            ).props("dense borderless options-dense").classes("param-select")
        elif field["kind"] == "flag":
            ui.switch(value=field["default"], on_change=lambda event: keep(event.value)).props("dense")
        else:
            entry = ui.number(value=field["default"], min=field["minimum"], max=field["maximum"], precision=0)
            entry.props("dense borderless").classes("param-entry wide")
            entry.on_value_change(
                lambda event: keep(int(field["default"] if event.value is None else event.value))
            )

    def _write(self) -> None:
        kind = self.kind
        options = dict(self.options) if kind in _MESHES else {}
        self._wait.set_text("Writing …")
        self._go.disable()
        self.bench.call(lambda: self.bench.session.export(kind, options))
