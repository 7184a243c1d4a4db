"""What every part of the measure of fidelity starts from, and what it says."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.params import Params
from flowtree.photos.load_photo import load_photo
from flowtree.pipeline.cache import StageCache


@dataclass(frozen=True)
class Row:
    """One line of the table.

    Attributes:
        measure: in words.
        asked: the bound; None where the figure only helps to understand the others.
        reached: what stands against the bound.
        items: what it was computed from, by name.
        at_most: whether the bound is one from above.
        unit: of all of it.
    """

    measure: str
    asked: float | None
    reached: float
    items: dict[str, float]
    at_most: bool = False
    unit: str = ""

    @property
    def passed(self) -> bool:
        """Whether the bound is kept; a figure without one always passes."""
        if self.asked is None:
            return True
        return self.reached <= self.asked if self.at_most else self.reached >= self.asked


@dataclass(frozen=True)
class Bench:
    """What a part measures with.

    Attributes:
        data: the folder that holds ``truth``, ``photos`` and ``cutouts``.
        params: of every reconstruction.
        cache: what several parts make from equal inputs is made once.
        details: what a part has to say beside its rows, by its name.
        folder: where pictures go; None for nowhere.
    """

    data: Path
    params: Params = field(default_factory=Params)
    cache: StageCache = field(default_factory=lambda: StageCache(400))
    details: dict[str, Any] = field(default_factory=dict)
    folder: Path | None = None


@dataclass(frozen=True)
class Part:
    """One part: which pictures it measures, and how.

    Attributes:
        find: the names of what it measures in the data folder.
        measure: its rows, from the bench and the names to look at.
    """

    find: Callable[[Path], list[str]]
    measure: Callable[[Bench, Sequence[str]], list[Row]]


def find_truth(data: Path) -> list[str]:
    """The known trees of a data folder."""
    return _found(data / "truth", "*/truth.json", [f.parent.name for f in data.glob("truth/*/truth.json")])


def find_cutouts(data: Path) -> list[str]:
    """The cut-out trees of a data folder."""
    return _found(data / "cutouts", "*.png", [file.stem for file in data.glob("cutouts/*.png")])


def find_photographs(data: Path) -> list[str]:
    """The photographs of a data folder."""
    return _found(data / "photos", "*.jpg", [file.stem for file in data.glob("photos/*.jpg")])


def _found(folder: Path, form: str, names: list[str]) -> list[str]:
    """The names in order.

    Raises:
        InputError: there are none.
    """
    check.require(
        bool(names), str(folder), f"must hold {form}", "none", "name the data folder with --data, or --part"
    )
    return sorted(names)


def load_grey(file: Path) -> NDArray[np.float32]:
    """A grey picture as alpha (h, w) in 0..1, at the working resolution."""
    return np.asarray(load_photo(file).rgb[:, :, 0], np.float32) / np.float32(255)


def mean(items: dict[str, float]) -> float:
    """Mean of the figures."""
    return float(np.mean(list(items.values())))
