"""A process that works for the studio: spawned, watched, stopped, and spawned again."""

from __future__ import annotations

import contextlib
import multiprocessing
import threading
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from flowtree.studio.job import Message, StudioJob
from flowtree.studio.work import work

_PATIENCE = 0.4  # [s] between asking a job to stop and stopping the process


class Worker:
    """Runs jobs in a process of its own, which lives as long as nothing happens to it.

    Args:
        listen: called with every `Message`, from a thread of this worker; for every job the last one says how
            it ended, whatever happens to the process.
        ahead: a module that a new process imports before the first job.
        kept: results of stages that it keeps; each has some megabytes.
    """

    def __init__(self, listen: Callable[[Message], None], *, ahead: str, kept: int) -> None:
        self._listen, self._ahead, self._kept = listen, ahead, kept
        self._context = multiprocessing.get_context("spawn")
        self._lock = threading.Lock()
        self._open: dict[int, StudioJob] = {}
        self._process: Any = None
        self._connection: Connection | None = None
        self._stopped: Any = self._context.Value("q", -1, lock=False)
        self._closed = False
        self._killed: Any = None

    def start(self) -> None:
        """Spawns the process, if there is none, without anything to do."""
        with self._lock:
            self._ensure()

    def submit(self, job: StudioJob) -> None:
        """Asks for a job; it is done after those before it."""
        with self._lock:
            if self._closed:
                return
            self._open[job.number] = job
            connection = self._ensure()
            with contextlib.suppress(OSError):  # the process has just died: its watcher says so
                connection.send(job)

    def stop(self, number: int, *, kill: bool = False) -> None:
        """Ends all jobs up to a number: each when its stage does.

        Args:
            number: of the last job to end.
            kill: whether a process that does not end them in time is stopped; all that it kept is lost.
        """
        with self._lock:
            self._stopped.value = max(self._stopped.value, number)
            process = self._process
            running = [open_ for open_ in self._open if open_ <= number]
        if kill and running and process is not None:
            timer = threading.Timer(_PATIENCE, self._kill, (process, number))
            timer.daemon = True
            timer.start()

    def close(self) -> None:
        """Ends the process."""
        with self._lock:
            self._closed = True
            process = self._process
        if process is not None:
            process.kill()
            process.join()

    @property
    def pid(self) -> int | None:
        """Of the process, if there is one."""
        return None if self._process is None else self._process.pid

    def _kill(self, process: Any, number: int) -> None:
        with self._lock:
            late = any(open_ <= number for open_ in self._open)
            if late:
                self._killed = process
        if late:
            process.kill()

    def _ensure(self) -> Connection:
        if self._connection is None:
            ours, theirs = self._context.Pipe()
            self._process = self._context.Process(
                target=work,
                args=(theirs, self._stopped, self._ahead, self._kept),
                daemon=True,
                name="flowtree-worker",
            )
            self._process.start()
            theirs.close()
            self._connection = ours
            watcher = threading.Thread(target=self._watch, args=(ours, self._process), daemon=True)
            watcher.start()
        return self._connection

    def _watch(self, connection: Connection, process: Any) -> None:
        try:
            while True:
                message = connection.recv()
                if message.last:
                    with self._lock:
                        self._open.pop(message.number, None)
                self._listen(message)
        except (EOFError, OSError):
            pass
        connection.close()
        process.join()
        with self._lock:
            if self._connection is connection:
                self._connection = self._process = None
            lost, self._open = self._open, {}
            ours = self._closed or self._killed is process
        for number, job in lost.items():
            if number <= self._stopped.value or self._closed:
                self._listen(Message(number, "cancelled"))
            elif ours:  # it had only waited for the job that was stopped
                self.submit(job)
            else:
                self._listen(Message(number, "crashed", process.exitcode))
