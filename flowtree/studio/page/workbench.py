"""What the parts of the page share: the session, its state as last shown, and what is chosen on this page."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any, Literal

from nicegui import run

from flowtree.errors import FlowtreeError
from flowtree.studio.session import Session

Mode = Literal["arrange", "matte", "branches", "density"]
Job = Callable[[], Any]


class Workbench:
    """One page's hold on the session.

    Everything that is asked of the session waits in one queue and is done in a thread, in order: no click
    waits for a disk.

    Attributes:
        session: the project.
        state: of the project as this page last saw it (`Session.state_json`).
        acknowledged: number of the last command of the board that the session took or refused.
        mode: which kind of work the board is for.
        photo: number of the photo that is worked on.
        unsaved: whether the last attempt to save came to nothing.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.state = session.state_json()
        self.acknowledged = 0
        self.mode: Mode = "arrange"
        self.photo = 0
        self.unsaved = False
        self._jobs: asyncio.Queue[tuple[Job, int | None]] = asyncio.Queue()
        self._gesture = 0
        self._watchers: list[Callable[[], None]] = []
        self._tell: Callable[[str], None] = lambda message: None

    def watch(self, watcher: Callable[[], None]) -> None:
        """Has a function called when the state, the mode or the photo has changed; and at once."""
        self._watchers.append(watcher)
        watcher()

    def on_problem(self, tell: Callable[[str], None]) -> None:
        """Who is told when the session refuses something."""
        self._tell = tell

    def do(self, command: str, *, gesture: str | None = None, **fields: Any) -> None:
        """Sends a command; its fields are those of ``flowtree.project.commands``."""
        table = {"command": command, **fields}
        self.send(table if gesture is None else {**table, "gesture": gesture})

    def send(self, table: dict[str, Any], number: int | None = None) -> None:
        """Sends a command as JSON; ``number`` is acknowledged when it is done or refused."""
        self.call(lambda: self.session.apply_json(table), number)

    def call(self, job: Job, number: int | None = None) -> None:
        """Has something done by the session, after all that was asked for before."""
        self._jobs.put_nowait((job, number))

    def next_gesture(self) -> str:
        """A name for what a person does in one go: it can be undone in one step."""
        self._gesture += 1
        return f"page {id(self)} {self._gesture}"

    def choose(self, *, mode: Mode | None = None, photo: int | None = None) -> None:
        """Another kind of work, or another photo."""
        self.mode = self.mode if mode is None else mode
        self.photo = self.photo if photo is None else photo
        self.changed()

    def refresh(self) -> None:
        """Takes the session's state over, unless something is yet to be asked of it: a control shows that."""
        if not self._jobs.empty():
            return
        self.state = self.session.state_json()
        self.photo = min(self.photo, max(len(self.state["photos"]) - 1, 0))
        self.changed()

    def changed(self) -> None:
        """Tells all who watch."""
        for watcher in self._watchers:
            watcher()

    async def work(self) -> None:
        """Does what was asked for, until the page goes."""
        while True:
            job, number = await self._jobs.get()
            try:
                await run.io_bound(job)
            except FlowtreeError as error:
                self._tell(str(error))
            if number is not None:
                self.acknowledged = number
            self.refresh()
