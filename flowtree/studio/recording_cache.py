"""A cache that knows what is new in it."""

from __future__ import annotations

from typing import Any

from flowtree.pipeline.cache import StageCache


class RecordingCache(StageCache):
    """Results that one process made, to be handed to another."""

    def __init__(self, capacity: int) -> None:
        super().__init__(capacity)
        self._new: dict[str, tuple[Any, ...]] = {}

    def put(self, key: str, result: tuple[Any, ...]) -> None:
        """Keeps a result, and notes it if it is new."""
        if self.get(key) is None:
            self._new[key] = result
        super().put(key, result)

    def take_new(self) -> dict[str, tuple[Any, ...]]:
        """What was new since the last call."""
        new, self._new = self._new, {}
        return new
