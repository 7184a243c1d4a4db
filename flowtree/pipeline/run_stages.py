"""Runs the table of stages."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from flowtree import check
from flowtree.device import thread_count
from flowtree.errors import CancelledError
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.digest import digest
from flowtree.pipeline.load_kernels import load_kernels
from flowtree.pipeline.stage import Job, Stage
from flowtree.pipeline.stage_workers import StageTurn, StageWorkers


@dataclass(frozen=True)
class Run:
    """What a run of stages left.

    Attributes:
        values: every value by its name; those with one entry a view are tuples.
        seconds: from each stage's begin to its end, in the table's order; close to 0 for what came from the
            cache. Stages run side by side: together they may have more than the run took.
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
    made: Callable[[str, Mapping[str, Any]], None] | None = None,
) -> Run:
    """Runs the stages, each as soon as what it reads is there, on as many threads as there are cores.

    Stages that do not hang on each other run side by side, and so do the views of one that takes each alone;
    of those that could begin, the first of the table does, and on one core they run in the table's order. A
    result is looked up by the fingerprint of the stage, its parameters and its inputs' fingerprints, so one
    changed stroke runs again only what hangs on it.

    Args:
        stages: the table; each stage stands behind those whose values it reads.
        sources: values that no stage makes; one that a stage reads for each view is a tuple of one a view.
        job: parameters, seed and device.
        views: how many.
        cache: results of earlier runs; equal views of one run share theirs even without.
        progress: called in the caller's thread, with a stage's name and the share of the whole work done,
            0..1: when it or one of its views begins, when another ends beside it, and with 1 at the end.
        cancel: asked in the caller's thread before every stage and view; true stops the run.
        until: the last stage to run; None runs all.
        made: called in the caller's thread when all of a stage is done, with its name and what it made, by
            name; the stages that can begin then wait for its return.

    Raises:
        CancelledError: ``cancel`` said so.
        InputError: an input of a stage is at fault, or ``until`` names no stage. Of several faults the one
            that is raised is that which comes first on one core.
    """
    known = [stage.name for stage in stages]
    if until is not None:
        remedy = check.nearest_name(until, known)
        check.require(until in known, "until", "must be a stage", repr(until), remedy)
        stages = stages[: known.index(until) + 1]
    per_view = {name for stage in stages if stage.each_view for name in (*stage.inputs, *stage.outputs)}
    board: dict[str, Any] = {
        name: tuple(_Value(v, digest(v)) for v in data) if name in per_view else _Value(data, digest(data))
        for name, data in sources.items()
    }
    with load_kernels(stages, job.device) as kernels, StageWorkers(thread_count()) as workers:
        table = _Table(stages, board, job, views, StageCache() if cache is None else cache, kernels)
        while table.ready or workers.busy:
            while table.ready and workers.free:
                if cancel is not None and cancel():
                    raise CancelledError(f"stopped before {table.ready[0].stage.name}")
                turn = table.take()
                if progress is not None:
                    progress(turn.stage.name, table.done)
                # What nothing can run beside stays in the caller's thread, where Ctrl-C stops it at once.
                workers.start(turn, here=workers.count == 1 or not (table.ready or workers.busy))
            for turn, result in workers.finished():
                for stage in table.finish(turn, result):
                    if made is not None:
                        made(stage.name, {name: _data(board[name]) for name in stage.outputs})
            if progress is not None and workers.busy:
                progress(min(workers.busy, key=_order).stage.name, table.done)
    if table.fault is not None:
        raise table.fault
    if progress is not None:
        progress(stages[-1].name, 1.0)
    seconds = {stage.name: table.seconds[stage.name] for stage in stages}
    return Run({name: _data(value) for name, value in board.items()}, seconds)


class _Table:
    """How far the stages are.

    Attributes:
        ready: turns that can begin, in the table's order.
        done: share of the whole work, 0..1.
        seconds: of each stage that has ended.
        fault: what the first turn of the table that failed raised; those behind it are not begun any more.
    """

    def __init__(
        self,
        stages: Sequence[Stage],
        board: dict[str, Any],
        job: Job,
        views: int,
        cache: StageCache,
        kernels: Mapping[str, Future[None]],
    ) -> None:
        self._board, self._job, self._views, self._cache, self._kernels = board, job, views, cache, kernels
        self._waiting = dict(enumerate(stages))
        self._whole = sum(stage.share for stage in stages)
        self._keys: dict[int, list[str]] = {}
        self._made: dict[int, dict[str, tuple[Any, ...]]] = {}
        self._wanted: dict[str, dict[int, Stage]] = {}  # results to come, and whose they are
        self._start: dict[int, float] = {}
        self._end = (len(stages), 0)
        self.ready: list[StageTurn] = []
        self.done = 0.0
        self.seconds: dict[str, float] = {}
        self.fault: Exception | None = None
        self._list_ready()

    def take(self) -> StageTurn:
        """The first turn that can begin; the caller begins it."""
        turn = self.ready.pop(0)
        self._start.setdefault(turn.order[0], time.perf_counter())
        return turn

    def finish(self, turn: StageTurn, made: tuple[Any, ...] | Exception) -> list[Stage]:
        """Notes what a turn made or how it failed, and lists what can begin now; returns what has ended."""
        if isinstance(made, Exception):
            if turn.order < self._end:
                self.fault, self._end = made, turn.order
                self.ready = [other for other in self.ready if other.order < self._end]
            return []
        done = []
        self._cache.put(turn.key, made)
        for number, stage in self._wanted.pop(turn.key).items():
            keys = self._keys[number]
            self._made[number][turn.key] = made
            self.done = min(1.0, self.done + stage.share / self._whole * keys.count(turn.key) / len(keys))
            if len(self._made[number]) == len(set(keys)):
                self._publish(stage, [self._made[number][key] for key in keys])
                now = time.perf_counter()
                self.seconds[stage.name] = now - self._start.get(number, now)
                done.append(stage)
        self._list_ready()
        return done

    def _publish(self, stage: Stage, results: Sequence[tuple[Any, ...]]) -> None:
        for k, name in enumerate(stage.outputs):
            values = tuple(made[k] for made in results)
            self._board[name] = values if stage.each_view else values[0]

    def _list_ready(self) -> None:
        for number, stage in list(self._waiting.items()):
            if (number, 0) < self._end and all(name in self._board for name in stage.inputs):
                del self._waiting[number]
                self.ready += self._turns(number, stage)
        self.ready.sort(key=_order)

    def _turns(self, number: int, stage: Stage) -> list[StageTurn]:
        params = {name: getattr(self._job.params, name) for name in stage.params}
        seed = self._job.seed if stage.seeded else None
        self._keys[number], self._made[number] = [], {}
        turns: list[StageTurn] = []
        views: Sequence[int | None] = range(self._views) if stage.each_view else (None,)
        for k, view in enumerate(views):
            inputs = [_input(self._board[name], view) for name in stage.inputs]
            name = stage.same_as or stage.name
            key = digest(name, [_keys(value) for value in inputs], params, seed, self._job.device)
            self._keys[number].append(key)
            if key not in self._wanted:  # else a twin or an equal view is at it
                work = partial(self._run, stage, inputs, key, self._cache.get(key))
                turns.append(StageTurn(stage, (number, k), key, work))
            self._wanted.setdefault(key, {})[number] = stage
        return turns

    def _run(
        self, stage: Stage, inputs: Sequence[Any], key: str, kept: tuple[Any, ...] | None
    ) -> tuple[Any, ...]:
        """The outputs as values: also their fingerprints are taken here, in a thread, and once a result."""
        if kept is not None:
            return kept
        for name in stage.kernels:
            self._kernels[name].result()
        made = stage.run(self._job, *(_data(value) for value in inputs))
        outputs = made if len(stage.outputs) > 1 else (made,)
        if stage.splits:  # a view of which nothing changed is not computed again
            return tuple(tuple(_Value(data, digest(data)) for data in output) for output in outputs)
        if stage.by_content:
            return tuple(_Value(data, digest(data)) for data in outputs)
        return tuple(_Value(data, f"{key}/{k}") for k, data in enumerate(outputs))


def _order(turn: StageTurn) -> tuple[int, int]:
    return turn.order


def _input(value: Any, view: int | None) -> Any:
    """A stage's input in one of its turns: a value that all views share goes to every view."""
    return value if view is None or isinstance(value, _Value) else value[view]


def _data(value: Any) -> Any:
    return value.data if isinstance(value, _Value) else tuple(each.data for each in value)


def _keys(value: Any) -> Any:
    return value.key if isinstance(value, _Value) else tuple(each.key for each in value)
