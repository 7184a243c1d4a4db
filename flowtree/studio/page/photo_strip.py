"""The photos of the project, small, in a row."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.choices import quiet_tip
from flowtree.studio.page.workbench import Workbench

PHOTO_KINDS = "image/*"
_ATTACHED = {"mattes": "matte", "trimaps": "trimap"}  # others are called what their kind is


class PhotoStrip:
    """Click one to work on it; add and remove; how like the tree is to each."""

    def __init__(self, bench: Workbench) -> None:
        self.bench = bench
        self.likeness: dict[int, float] = {}
        self._shown: object = None
        self._pictures: dict[str, str] = {}
        self._strip = ui.element("div").classes("photo-strip")
        bench.watch(self.show)

    def set_picture(self, name: str, url: str) -> None:
        """Address of a photo's picture: layer ``photo/K``."""
        self._pictures[name] = url
        self.show()

    def set_likeness(self, likeness: dict[int, float]) -> None:
        """Soft IoU of the tree with each photo's matte."""
        self.likeness = likeness
        self.show()

    def show(self) -> None:
        """Builds the row anew where something of it changed."""
        photos = self.bench.state["photos"]
        wanted = (
            [(photo["name"], photo["yaw"], photo["attached"]) for photo in photos],
            self.bench.photo,
            dict(self._pictures),
            dict(self.likeness),
        )
        if wanted == self._shown:
            return
        self._shown = wanted
        self._strip.clear()
        with self._strip:
            for number, photo in enumerate(photos):
                self._tile(number, photo["name"], photo["yaw"], photo["attached"])
            with (
                ui.element("div")
                .classes("photo-tile add")
                .props(f'data-choose="{PHOTO_KINDS}" role=button tabindex=0')
            ):
                ui.icon("add_photo_alternate")
                ui.label("Add photo")

    def _attached(self, number: int, kind: str) -> None:
        """A file that came with the photo, in whose place nothing can be drawn."""
        word = _ATTACHED.get(kind, kind)
        tag = ui.element("button").classes("photo-attached").mark(f"attached-{kind}")
        tag.on("click.stop", lambda: self.bench.do("RemoveAttached", photo=number, kind=kind))
        with tag:
            ui.label(word)
            ui.icon("close")
            quiet_tip(f"A file ({word}) came with this photo and counts here. Take it away to draw yourself")

    def _tile(self, number: int, name: str, yaw: float, attached: list[str]) -> None:
        chosen = " chosen" if number == self.bench.photo else ""
        tile = (
            ui.element("div")
            .classes(f"photo-tile{chosen}")
            .mark(f"photo-{number}")
            .props("role=button tabindex=0")
        )
        tile.on("click", lambda: self.bench.choose(photo=number))
        with tile:
            url = self._pictures.get(f"photo/{number}")
            ui.element("div").classes("thumb").style(f"background-image:url('{url}')" if url else "")
            with ui.element("div").classes("photo-words"):
                ui.label(name).classes("photo-name")
                ui.label(f"{number + 1} · {yaw:g}°").classes("photo-yaw")
                if number in self.likeness:
                    with ui.label(f"{100 * self.likeness[number]:.0f} % alike").classes("photo-like"):
                        quiet_tip("How much of the tree's outline is the photo's (soft IoU)")
            for kind in attached:
                self._attached(number, kind)
            remove = (
                ui.button(icon="close", color=None)
                .props('flat dense aria-label="Remove photo"')
                .classes("photo-remove")
            )
            remove.on("click.stop", lambda: self.bench.do("RemovePhoto", photo=number))
