"""The colours that were picked on the photo."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.choices import quiet_tip
from flowtree.studio.page.workbench import Workbench

_KINDS = {"tree_colors": "the tree's", "background_colors": "not the tree's"}


class Swatches:
    """Small squares over the board; a click takes a colour away again."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self._shown: object = None
        self._row = ui.element("div").classes("floating swatches")
        bench.watch(self.show)

    def show(self) -> None:
        """Those of the photo that is worked on, where mattes are worked on."""
        photos = self.bench.state["photos"]
        photo = photos[self.bench.photo] if photos else {name: [] for name in _KINDS}
        colors = [(name, color) for name in _KINDS for color in photo[name]]
        self._row.set_visibility(bool(colors) and self.bench.mode == "matte")
        if colors == self._shown:
            return
        self._shown = colors
        self._row.clear()
        with self._row:
            for place, (name, color) in enumerate(colors):
                first = place if name == "tree_colors" else place - len(photo["tree_colors"])
                self._swatch(name, color, first)

    def pick(self, name: str, color: str) -> None:
        """Adds a colour: ``tree_colors`` or ``background_colors``."""
        photo = self.bench.state["photos"][self.bench.photo]
        if color not in photo[name]:
            self._set(name, [*photo[name], color])

    def _swatch(self, name: str, color: str, place: int) -> None:
        def remove() -> None:
            colors = list(self.bench.state["photos"][self.bench.photo][name])
            del colors[place]
            self._set(name, colors)

        button = ui.element("button").classes(f"swatch {name}").style(f"background:{color}")
        button.props(f'aria-label="Take {color} away"').mark("swatch")
        button.on("click", remove)
        with button:
            quiet_tip(f"{color} is {_KINDS[name]}, on this photo. Click to take it away")

    def _set(self, name: str, colors: list[str]) -> None:
        photo = self.bench.state["photos"][self.bench.photo]
        both = {"tree_colors": photo["tree_colors"], "background_colors": photo["background_colors"]}
        both[name] = colors
        self.bench.do(
            "SetColors",
            photo=self.bench.photo,
            tree=both["tree_colors"],
            background=both["background_colors"],
        )
