"""Random numbers that belong to a place: what changes elsewhere does not change them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_GOLDEN = 0x9E3779B97F4A7C15
_WORD = 2**64

_Words = NDArray[np.uint64]


def place_words(place: NDArray[np.integer[Any]], seed: int, number: Any = 0) -> _Words:
    """Random 64-bit words (n,) of places (n,), the same for the same place, seed and number.

    A stream of random numbers hands its next one to whoever comes next: one thing more or less, and all after
    it get others. Here the number is a hash (splitmix64's mixing, Steele and others 2014) of the place's own
    whole number, so a change in one place leaves all others as they were.

    Args:
        place: (n,) whole numbers, for example Morton codes of cells.
        seed: of all that is random.
        number: which of the place's words: one for all, or (n,).
    """
    stream = np.atleast_1d(np.asarray(number, np.int64)).astype(np.uint64)
    salt = np.full(1, (seed + 1) * _GOLDEN % _WORD, np.uint64)
    word = _mix(place.astype(np.uint64) + _mix(stream + salt))
    return _mix(word + np.full(1, _GOLDEN, np.uint64))


def place_chance(place: NDArray[np.integer[Any]], seed: int, number: Any = 0) -> NDArray[np.float64]:
    """Random numbers (n,) in 0..1 (1 excluded) of places: see `place_words`."""
    return np.asarray((place_words(place, seed, number) >> np.uint64(11)) * 2.0**-53)


def _mix(word: _Words) -> _Words:
    word = (word ^ (word >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    word = (word ^ (word >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray(word ^ (word >> np.uint64(31)), np.uint64)
