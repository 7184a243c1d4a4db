"""What runs for a document: mattes first, then the tree, newer states before older ones."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from flowtree.project.document_state import DocumentState
from flowtree.studio.exports import Order
from flowtree.studio.job import Kind, Message, StudioJob
from flowtree.studio.layer_shelf import LayerShelf
from flowtree.studio.worker import Worker

_CUTS = 40  # photos, and their mattes after some scribbles
_RESULTS = 300  # six variants of a tree, and some steps of undoing
Tell = Callable[[dict[str, Any]], None]
_CRASHED = "A process of the studio ended unexpectedly. The project is safe: go on, or grow the tree again."


class Engine:
    """Two workers: one cuts photos out and answers at once, the other makes trees.

    Args:
        folder: of the project.
        scratch: where workers may write.
        tell: called with events, from any thread.
    """

    def __init__(self, folder: Path, scratch: Path, tell: Tell) -> None:
        self._folder, self._scratch, self._tell = folder, scratch, tell
        self._lock = threading.RLock()
        self.shelf = LayerShelf()
        self._cutter = Worker(self._hear, ahead="flowtree.matting.cut_out_tree", kept=_CUTS)
        self._grower = Worker(self._hear, ahead="flowtree.pipeline.steps", kept=_RESULTS)
        self._jobs: dict[int, StudioJob] = {}
        self._next = 0
        self._stopped = -1  # the last job that somebody stopped
        self._state, self._revision = DocumentState(), 0
        self._cut: Any = None  # what the mattes hang on, of those that are there
        self._kept: list[bytes] = []  # results that the grower was not given yet
        self._seeds: list[int] = []  # of variants that are to come
        self._asked = 0  # variants that were asked for together with them
        self.problem: str | None = None

    @property
    def busy(self) -> bool:
        """Whether anything runs that somebody waits for."""
        with self._lock:
            return bool(self._jobs)

    @property
    def pids(self) -> tuple[int | None, int | None]:
        """The processes: of the one that cuts out and the one that grows."""
        return self._cutter.pid, self._grower.pid

    def start(self) -> None:
        """Spawns the processes ahead of the first work."""
        self._cutter.start()
        self._grower.start()

    def update(self, state: DocumentState, revision: int) -> None:
        """Takes a new state: what runs for an older one ends, and the new one's work begins."""
        with self._lock:
            self._state, self._revision = state, revision
            changes = self.shelf.show(len(state.photos))
        for event in changes:
            self._tell(event)
        self.run()

    def run(self) -> None:
        """Begins the work for the latest state (again)."""
        with self._lock:
            self._drop()
            self.problem = None
            if not self._state.photos:
                return
            if _hangs_on(self._state) == self._cut:
                self._submit("tree", self._grower)
            else:
                self._cut = None  # another's mattes may come yet, also where this job is overtaken
                self._submit("matte", self._cutter)

    def cancel(self) -> None:
        """Ends all that runs, within half a second."""
        with self._lock:
            last = self._stopped = self._next - 1
            self._seeds = []
        self._cutter.stop(last, kill=True)
        self._grower.stop(last, kill=True)

    def variants(self, seeds: Sequence[int]) -> None:
        """Pictures of other seeds' trees, one by one, behind all else; an edit does not end them."""
        with self._lock:
            self._seeds, self._asked = list(seeds), len(seeds)
            self._go_on()

    def export(self, order: Order) -> None:
        """Writes a file behind what runs."""
        with self._lock:
            self._submit("export", self._grower, {"order": order})

    def close(self) -> None:
        """Ends both processes."""
        self._cutter.close()
        self._grower.close()

    def _drop(self) -> None:
        """Lets go of everything that runs: it ends when its stages do; only of exports the end is told."""
        self._jobs = {number: job for number, job in self._jobs.items() if job.kind == "export"}
        self._cutter.stop(self._next - 1)
        self._grower.stop(self._next - 1)

    def _go_on(self) -> None:
        """The next variant that somebody waits for, where nothing else is to be done."""
        if self._seeds and not self._jobs:
            done = self._asked - len(self._seeds)
            self._submit("variants", self._grower, {"seed": self._seeds[0], "part": (done, self._asked)})

    def _submit(self, kind: Kind, worker: Worker, options: Mapping[str, Any] | None = None) -> int:
        kept: tuple[bytes, ...] = ()
        if worker is self._grower:
            kept, self._kept = tuple(self._kept), []
        job = StudioJob(
            self._next, kind, self._state, self._folder, self._scratch, self._revision, kept, options or {}
        )
        self._next += 1
        self._jobs[job.number] = job
        worker.submit(job)
        return job.number

    def _hear(self, message: Message) -> None:
        for event in self._heed(message):
            self._tell(event)

    def _heed(self, message: Message) -> list[dict[str, Any]]:
        """What a message changes, and what is told of it."""
        with self._lock:
            if message.kind == "layer":  # also of a job that was dropped: it is newer than what is there
                kind, _, seed = message.content.name.partition("/")
                if kind == "variant" and int(seed) in self._seeds:
                    self._seeds.remove(int(seed))
                return self.shelf.put(message.content)
            if message.kind == "kept":
                self._kept.append(message.content)
                return []
            job = self._jobs.get(message.number)
            if job is None:
                return []
            about = {"job": job.kind}
            if message.kind == "progress":
                stage, share = message.content
                return [{"event": "progress", **about, "stage": stage, "share": share}]
            if message.kind == "exported":
                return [{"event": "written", "id": job.options["order"].id}]
            del self._jobs[message.number]
            if message.kind in ("done", "cancelled"):
                # What was nearly done when it was stopped is there, and what was to follow does not come.
                stopped = message.number <= self._stopped and job.kind != "export"
                done = message.kind == "done"
                if done and job.kind == "matte":
                    self._cut = _hangs_on(job.state)
                    if not stopped:
                        self._submit("tree", self._grower)
                self._go_on()
                if stopped or not done:
                    return [{"event": "cancelled", **about}]
                if job.kind == "variants" and self._seeds:
                    return []
                return [{"event": "done", **about, "seconds": message.content}]
            self.problem = _CRASHED if message.kind == "crashed" else str(message.content)
            self._seeds = []
            return [{"event": "failed", **about, "message": self.problem}]


def _hangs_on(state: DocumentState) -> Any:
    """What the mattes hang on; without scribbles and parameters of other stages nothing of them changes."""
    drawn = tuple(
        (photo.place, photo.scribbles, photo.tree_colors, photo.background_colors, photo.attached)
        for photo in state.photos
    )
    return drawn, state.params.photos, state.params.matting
