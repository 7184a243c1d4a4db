"""Six trees of the same kind to choose from."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.choices import icon_button
from flowtree.studio.page.workbench import Workbench

_COUNT = 6


class VariantGrid:
    """Pictures of other seeds; one is made the tree by a click."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.seeds: list[int] = []
        self._urls: dict[int, str] = {}
        self._shown: object = None
        with ui.element("div").classes("section-head"):
            ui.label("Variants")
            ui.element("div").classes("space")
            self._seed = ui.input("Seed").props("dense borderless").classes("field")
            self._seed.on("change", self._typed)
            icon_button("casino", "Another tree of the same kind", self.another)
            self._more = icon_button("auto_awesome_mosaic", "Show six others to choose from", self.ask)
        self._grid = ui.element("div").classes("variants")
        bench.watch(self.show)

    def ask(self) -> None:
        """Asks for six seeds beyond those seen."""
        first = max([*self.seeds, int(self.bench.state["seed"])]) + 1
        self.seeds = list(range(first, first + _COUNT))
        seeds = tuple(self.seeds)
        self.bench.call(lambda: self.bench.session.variants(seeds))
        self.show()

    def another(self) -> None:
        """The next seed."""
        self.bench.do("SetSeed", seed=int(self.bench.state["seed"]) + 1)

    def set_picture(self, seed: int, url: str) -> None:
        """Address of a seed's picture: layer ``variant/SEED``."""
        self._urls[seed] = url
        if seed not in self.seeds:
            self.seeds = sorted([*self.seeds, seed])[-_COUNT:]
        self.show()

    def give_up(self) -> None:
        """Nobody makes those any more that have no picture yet."""
        self.seeds = [seed for seed in self.seeds if seed in self._urls]
        self.show()

    def show(self) -> None:
        """Builds the grid anew where something of it changed."""
        seed = int(self.bench.state["seed"])
        self._seed.set_value(str(seed))
        self._more.set_enabled(bool(self.bench.state["photos"]))
        wanted = (tuple(self.seeds), dict(self._urls), seed)
        if wanted == self._shown:
            return
        self._shown = wanted
        self._grid.clear()
        with self._grid:
            if not self.seeds:
                with ui.element("button").classes("variants-empty").on("click", self.ask):
                    ui.label("Six others of its kind")
            for other in self.seeds:
                self._tile(other, other == seed)

    def _tile(self, seed: int, chosen: bool) -> None:
        url = self._urls.get(seed)
        tile = ui.element("button").classes(
            f"variant{' chosen' if chosen else ''}{'' if url else ' waiting'}"
        )
        tile.props(f'aria-label="Seed {seed}"').mark(f"variant-{seed}")
        tile.on("click", lambda: self.bench.do("SetSeed", seed=seed))
        with tile:
            ui.element("div").classes("variant-picture").style(
                f"background-image:url('{url}')" if url else ""
            )
            ui.label(str(seed))

    def _typed(self) -> None:
        text = str(self._seed.value or "").strip()
        if text.isdecimal():
            self.bench.do("SetSeed", seed=int(text))
        else:
            self.show()
