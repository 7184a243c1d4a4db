"""Which layers a worker has sent already."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flowtree.studio.layers.layer import Layer


class LayerBook:
    """Makes a layer only where what it shows is another object than before.

    Results come from the cache as the same objects where nothing changed.
    """

    def __init__(self) -> None:
        self._sent: dict[str, tuple[Any, ...]] = {}

    def before(self, name: str) -> tuple[Any, ...] | None:
        """What the layer of that name was made from, if it was sent."""
        return self._sent.get(name)

    def draw(self, name: str, made_from: tuple[Any, ...], make: Callable[[], Layer]) -> Layer | None:
        """The layer, or None if the same was sent before."""
        before = self._sent.get(name)
        same = before is not None and len(before) == len(made_from)
        if same and before is not None and all(_same(a, b) for a, b in zip(before, made_from, strict=True)):
            return None
        layer = make()
        self._sent[name] = made_from
        return layer


def _same(ours: Any, theirs: Any) -> bool:
    return ours is theirs or (isinstance(ours, str | int) and ours == theirs)
