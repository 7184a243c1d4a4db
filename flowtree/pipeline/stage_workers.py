"""The threads that the stages run in."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from typing import Any, Self

from flowtree.pipeline.stage import Stage


@dataclass(frozen=True, eq=False)
class StageTurn:
    """A stage's work on one view, or on all; equal views and twins have it together.

    Attributes:
        stage: what is run.
        order: of the stage in the table and of the turn in the stage.
        key: fingerprint of all that the result hangs on.
        work: makes the result.
    """

    stage: Stage
    order: tuple[int, int]
    key: str
    work: Callable[[], tuple[Any, ...]]


class StageWorkers:
    """Threads that turns run in, and the caller's own.

    Attributes:
        count: turns that run at once, at most.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._pool = ThreadPoolExecutor(count, thread_name_prefix="flowtree-stages")
        self._running: dict[Future[tuple[Any, ...]], StageTurn] = {}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._pool.shutdown(cancel_futures=True)

    @property
    def free(self) -> bool:
        """Whether one more can begin."""
        return len(self._running) < self.count

    @property
    def busy(self) -> tuple[StageTurn, ...]:
        """The turns that are running, or have ended and were not asked for."""
        return tuple(self._running.values())

    def start(self, turn: StageTurn, *, here: bool) -> None:
        """Begins a turn; one that runs here has ended when this returns."""
        if not here:
            self._running[self._pool.submit(turn.work)] = turn
            return
        ended: Future[tuple[Any, ...]] = Future()
        try:
            ended.set_result(turn.work())
        except Exception as error:  # a fault is weighed against those of turns elsewhere
            ended.set_exception(error)
        self._running[ended] = turn

    def finished(self) -> list[tuple[StageTurn, tuple[Any, ...] | Exception]]:
        """Waits for at least one turn to end; those that did, with what they made or raised."""
        ended, _ = wait(self._running, return_when=FIRST_COMPLETED)
        found = []
        for job in ended:
            error = job.exception()
            if error is not None and not isinstance(error, Exception):
                raise error
            found.append((self._running.pop(job), job.result() if error is None else error))
        return sorted(found, key=lambda each: each[0].order)
