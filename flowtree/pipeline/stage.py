"""What a row of the table of stages says."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from flowtree.params import Params


@dataclass(frozen=True)
class Job:
    """What every stage may ask for besides its inputs.

    Attributes:
        params: of all stages; a stage may read only the sections its row names.
        seed: of all random choices.
        device: to run kernels on; None picks one.
    """

    params: Params
    seed: int
    device: str | None


@dataclass(frozen=True)
class Stage:
    """One row: a function, what it reads and what it makes.

    Attributes:
        name: in progress, report and errors.
        run: called with the job and the inputs in order; returns one value per output (a tuple if several).
        inputs: names of values; a value with one entry a view comes as a tuple of all of them.
        outputs: names of the values it makes.
        params: sections of the parameters it reads; others do not make it run again.
        each_view: it runs once a view: an input with an entry a view is that view's own, others are shared,
            and every output has an entry a view.
        splits: it runs once for all views, and every output is a tuple of one entry a view, which is
            fingerprinted by its content.
        by_content: so is every output: where it comes out as before, nothing behind it runs again.
        same_as: the name of the stage whose results are its own where the inputs are the same; None for none.
        seeded: the seed changes its result.
        kernels: modules of ``flowtree.kernels`` that it launches from, made ready before it runs.
        share: of the time of a usual run, for the progress bar.
    """

    name: str
    run: Callable[..., Any]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    params: tuple[str, ...] = ()
    each_view: bool = False
    splits: bool = False
    by_content: bool = False
    same_as: str | None = None
    seeded: bool = False
    kernels: tuple[str, ...] = ()
    share: float = 1.0
