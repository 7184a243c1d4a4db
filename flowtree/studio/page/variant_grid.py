"""Six trees of the same kind to choose from."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.choices import icon_button
from flowtree.studio.page.entry_field import EntryField
from flowtree.studio.page.workbench import Workbench

_COUNT = 6


class VariantGrid:
    """Pictures of other seeds; one is made the tree by a click."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.seeds: list[int] = []
        self._urls: dict[int, str] = {}
        self._tiles: dict[int, tuple[ui.element, ui.element]] = {}
        with ui.element("div").classes("section-head"):
            ui.label("Variants")
            ui.element("div").classes("space")
            self._seed = EntryField(self._typed, "Seed")
            self._seed.input.classes("field")
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
        """Builds the grid anew only where its seeds are others: a click must not fall between two tiles."""
        seed = int(self.bench.state["seed"])
        self._seed.show(str(seed))
        self._more.set_enabled(bool(self.bench.state["photos"]))
        if list(self._tiles) != self.seeds or not self.seeds:
            self._build()
        for other, (tile, picture) in self._tiles.items():
            url = self._urls.get(other)
            words = ("chosen" if other == seed else "", "" if url else "waiting")
            tile.classes(replace=" ".join(("variant", *words)))
            picture.style(replace=f"background-image:url('{url}')" if url else "")

    def _build(self) -> None:
        self._grid.clear()
        with self._grid:
            if not self.seeds:
                with ui.element("button").classes("variants-empty").on("click", self.ask):
                    ui.label("Six others of its kind")
            self._tiles = {seed: self._tile(seed) for seed in self.seeds}

    def _tile(self, seed: int) -> tuple[ui.element, ui.element]:
        with ui.element("button") as tile:
            picture = ui.element("div").classes("variant-picture")
            ui.label(str(seed))
        tile.props(f'aria-label="Seed {seed}"').mark(f"variant-{seed}")
        tile.on("click", lambda: self.bench.do("SetSeed", seed=seed))
        return tile, picture

    def _typed(self, text: str) -> None:
        if text.isdecimal():
            self.bench.do("SetSeed", seed=int(text))
        else:
            self.show()
