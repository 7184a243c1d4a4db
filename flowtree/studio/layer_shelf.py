"""The layers that are there."""

from __future__ import annotations

import threading
from typing import Any, NamedTuple

from flowtree.studio.layers.layer import Layer

_OF_PHOTOS = ("photo", "matte", "cost", "graph")


class ShownLayer(NamedTuple):
    """A layer as a page asks for it.

    Attributes:
        revision: grows with every layer that comes.
        media_type: of the data.
        data: the file.
    """

    revision: int
    media_type: str
    data: bytes


class LayerShelf:
    """Keeps the latest layer of every name, and shows those of the photos that there are.

    Layers of a photo that was removed stay, out of sight: it may come back by undoing.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._layers: dict[str, tuple[int, Layer]] = {}
        self._revision = 0
        self._photos = 0

    def put(self, layer: Layer) -> list[dict[str, Any]]:
        """Takes a layer; returns what is to be told of it."""
        with self._lock:
            self._revision += 1
            self._layers[layer.name] = (self._revision, layer)
            return [self._event(layer.name)] if self._is_shown(layer.name) else []

    def show(self, photos: int) -> list[dict[str, Any]]:
        """Takes the number of photos; returns what is to be told of layers that come and go by it."""
        with self._lock:
            before = {name for name in self._layers if self._is_shown(name)}
            self._photos = photos
            after = {name for name in self._layers if self._is_shown(name)}
            gone = [{"event": "removed", "name": name} for name in sorted(before - after)]
            return gone + [self._event(name) for name in sorted(after - before)]

    def layers(self) -> dict[str, int]:
        """The revision of every layer that is shown, by its name."""
        with self._lock:
            return {name: self._layers[name][0] for name in self._layers if self._is_shown(name)}

    def get(self, name: str) -> ShownLayer | None:
        """A layer; ``matte-part/0`` is the part of ``matte/0`` that changed last."""
        whole = name.replace("matte-part/", "matte/", 1)
        with self._lock:
            found = self._layers.get(whole)
        if found is None:
            return None
        revision, layer = found
        data = layer.data if whole == name else layer.part
        return None if data is None else ShownLayer(revision, layer.media_type, data)

    def _event(self, name: str) -> dict[str, Any]:
        revision, layer = self._layers[name]
        event: dict[str, Any] = {
            "event": "layer",
            "name": name,
            "revision": revision,
            "url": f"/layer/{revision}/{name}",
        }
        if layer.box is not None:
            part = name.replace("matte/", "matte-part/", 1)
            event |= {"box": list(layer.box), "part": f"/layer/{revision}/{part}"}
        return event

    def _is_shown(self, name: str) -> bool:
        kind, _, number = name.partition("/")
        if kind in _OF_PHOTOS:
            return int(number) < self._photos
        if kind == "straight":
            return self._photos > 0 and int(number) < max(2, self._photos)
        return self._photos > 0
