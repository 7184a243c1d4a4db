"""Runs the table of stages."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, Self

from flowtree import check
from flowtree.device import thread_count
from flowtree.errors import CancelledError
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.digest import digest
from flowtree.pipeline.load_kernels import load_kernels
from flowtree.pipeline.stage import Job, Stage


@dataclass(frozen=True)
class Run:
    """What a run of stages left.

    Attributes:
        values: every value by its name; those with one entry a view are tuples.
        seconds: that each stage took; close to 0 for what came from the cache.
    """

    values: dict[str, Any]
    seconds: dict[str, float]


class _Value(NamedTuple):
    """A value and the fingerprint of all it was made from (not of the value itself: that would cost time)."""

    data: Any
    key: str


def run_stages(
    stages: Sequence[Stage],
    sources: Mapping[str, Any],
    job: Job,
    *,
    views: int,
    cache: StageCache | None = None,
    progress: Callable[[str, float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
    until: str | None = None,
) -> Run:
    """Runs the stages in order, each on what those before it made.

    A result is looked up by the fingerprint of the stage, its parameters and its inputs' fingerprints, so one
    changed stroke runs again only what hangs on it. The views of a stage that takes each alone run side by
    side, on as many threads as there are cores.

    Args:
        stages: the table.
        sources: values that no stage makes; one that a stage reads for each view is a tuple of one a view.
        job: parameters, seed and device.
        views: how many.
        cache: results of earlier runs; equal views of one run share theirs even without.
        progress: called with the stage's name and the share of the whole work done, 0..1, when a stage or one
            of its views begins, and with 1 at the end.
        cancel: asked before every stage and view; true stops the run.
        until: the last stage to run; None runs all.

    Raises:
        CancelledError: ``cancel`` said so.
        InputError: an input of a stage is at fault, or ``until`` names no stage.
    """
    known = [stage.name for stage in stages]
    if until is not None:
        remedy = check.nearest_name(until, known)
        check.require(until in known, "until", "must be a stage", repr(until), remedy)
        stages = stages[: known.index(until) + 1]
    kept = StageCache() if cache is None else cache
    per_view = {name for stage in stages if stage.each_view for name in (*stage.inputs, *stage.outputs)}
    board: dict[str, Any] = {
        name: tuple(_Value(v, digest(v)) for v in data) if name in per_view else _Value(data, digest(data))
        for name, data in sources.items()
    }
    work, done = sum(stage.share for stage in stages), 0.0
    seconds: dict[str, float] = {}
    with load_kernels(stages, job.device) as kernels:
        for stage in stages:
            start = time.perf_counter()
            for name in stage.kernels:
                kernels[name].result()
            turns: Sequence[int | None] = range(views) if stage.each_view else (None,)
            inputs = [[_input(board[name], turn) for name in stage.inputs] for turn in turns]
            results = []
            with _Turns(stage, inputs, job, kept) as running:
                for k in range(len(turns)):
                    if cancel is not None and cancel():
                        raise CancelledError(f"stopped before {stage.name}")
                    if progress is not None:
                        progress(stage.name, done / work)
                    results.append(running.result(k))
                    done += stage.share / len(turns)
            for k, name in enumerate(stage.outputs):
                board[name] = tuple(result[k] for result in results) if stage.each_view else results[0][k]
                if stage.splits:  # by content: a view of which nothing changed is not computed again
                    board[name] = tuple(_Value(data, digest(data)) for data in results[0][k].data)
            seconds[stage.name] = time.perf_counter() - start
    if progress is not None:
        progress(stages[-1].name, 1.0)
    return Run({name: _data(value) for name, value in board.items()}, seconds)


def _input(value: Any, turn: int | None) -> Any:
    """A stage's input in one of its turns: a value that all views share goes to every view."""
    return value if turn is None or isinstance(value, _Value) else value[turn]


class _Turns:
    """A stage's turns, one a view or one for all: from the cache, or computed, each fingerprint once."""

    def __init__(self, stage: Stage, inputs: Sequence[Sequence[Any]], job: Job, cache: StageCache) -> None:
        self._stage, self._cache = stage, cache
        params = {name: getattr(job.params, name) for name in stage.params}
        seed = job.seed if stage.seeded else None
        self._keys = [
            digest(stage.name, [_keys(v) for v in each], params, seed, job.device) for each in inputs
        ]
        self._made = {key: cache.get(key) for key in self._keys}
        self._work = {
            key: partial(stage.run, job, *(_data(v) for v in each))
            for key, each in zip(self._keys, inputs, strict=True)
            if self._made[key] is None
        }
        self._pool = ThreadPoolExecutor(min(len(self._work), thread_count())) if len(self._work) > 1 else None

    def __enter__(self) -> Self:
        self._jobs = {key: self._pool.submit(work) for key, work in self._work.items()} if self._pool else {}
        return self

    def __exit__(self, *_: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(cancel_futures=True)

    def result(self, turn: int) -> tuple[_Value, ...]:
        """What the stage made of this turn's inputs; waits for it."""
        key = self._keys[turn]
        made = self._made[key]
        if made is None:
            made = self._jobs[key].result() if key in self._jobs else self._work[key]()
            made = made if len(self._stage.outputs) > 1 else (made,)
            self._made[key] = made
            self._cache.put(key, made)
        return tuple(
            _Value(data, f"{key}/{name}") for name, data in zip(self._stage.outputs, made, strict=True)
        )


def _data(value: Any) -> Any:
    return value.data if isinstance(value, _Value) else tuple(each.data for each in value)


def _keys(value: Any) -> Any:
    return value.key if isinstance(value, _Value) else tuple(each.key for each in value)
