"""Results of stages, kept between runs."""

from __future__ import annotations

from collections import OrderedDict
from typing import Any


class StageCache:
    """Keeps the latest results by the fingerprint of everything they were made from.

    Whoever runs the pipeline again and again passes the same cache each time: what did not change is not
    computed again. Results are handed out as they are and must not be written to.

    Attributes:
        capacity: how many results are kept; the one not used for longest goes first.
    """

    def __init__(self, capacity: int = 128) -> None:
        self.capacity = capacity
        self._kept: OrderedDict[str, tuple[Any, ...]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._kept)

    def get(self, key: str) -> tuple[Any, ...] | None:
        """The result, or None."""
        if key in self._kept:
            self._kept.move_to_end(key)
        return self._kept.get(key)

    def put(self, key: str, result: tuple[Any, ...]) -> None:
        """Keeps a result."""
        self._kept[key] = result
        self._kept.move_to_end(key)
        while len(self._kept) > self.capacity:
            self._kept.popitem(last=False)
