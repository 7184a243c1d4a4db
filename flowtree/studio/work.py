"""The worker's process: takes jobs off a pipe and runs one after the other."""

from __future__ import annotations

import contextlib
import queue
import signal
from multiprocessing.connection import Connection
from threading import Thread
from typing import Any

from flowtree.pipeline.import_alone import import_alone
from flowtree.studio.job import StudioJob


def work(connection: Connection, stopped: Any, ahead: str, kept: int) -> None:
    """Serves jobs until the other end closes; runs in a spawned process.

    Args:
        connection: jobs come in, `Message` go out.
        stopped: a shared whole number: jobs up to it shall end as soon as they can.
        ahead: a module to import while nothing is asked for; empty for none.
        kept: results of stages that are kept; each has some megabytes.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the process that closes this one in order
    if ahead:
        Thread(target=import_alone, args=(ahead,), daemon=True).start()
    from flowtree.studio.bench import Bench  # heavy, and the process that spawns this one needs none of it

    jobs: queue.Queue[StudioJob | None] = queue.Queue()
    Thread(target=_receive, args=(connection, jobs), daemon=True).start()
    bench = Bench(connection, stopped, kept)
    with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # nobody is there any more
        while (job := jobs.get()) is not None:
            bench.run(job)


def _receive(connection: Connection, jobs: queue.Queue[StudioJob | None]) -> None:
    """Takes jobs off the pipe at once, so that whoever sends one never waits."""
    try:
        while True:
            jobs.put(connection.recv())
    except (EOFError, OSError):
        jobs.put(None)
