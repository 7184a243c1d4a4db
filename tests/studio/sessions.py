"""Sessions on small pictures, and what they tell."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from flowtree.project import commands as do
from flowtree.studio.session import Session
from tests.pictures import save_pair

PATIENCE = 60.0  # [s]; a session that says nothing for so long hangs
_SMALL = {"density.resolution": 20, "flow.particle_count": 150, "attraction.grid_height": 64}
_SMALL |= {"attraction.seed_count": 8, "leaves.most": 200, "twigs.most": 100}


class Ear:
    """Hears a session, and waits for what it tells."""

    def __init__(self, session: Session) -> None:
        self.events: list[dict[str, Any]] = []
        self._heard = threading.Condition()
        session.listen(self._hear)

    def _hear(self, event: dict[str, Any]) -> None:
        with self._heard:
            self.events.append(event)
            self._heard.notify_all()

    def names(self) -> list[str]:
        return [event["event"] for event in self.events]

    def wait(self, fits: Callable[[dict[str, Any]], bool], since: int = 0) -> dict[str, Any]:
        """The first event from a place in the list on that fits; a failure meanwhile fails the test."""
        place = since
        with self._heard:
            while True:
                while place < len(self.events):
                    event = self.events[place]
                    if fits(event):
                        return event
                    assert event["event"] != "failed", event
                    place += 1
                assert self._heard.wait(PATIENCE), f"nothing more after {self.events[-3:]}"

    def end(self, job: str = "tree", since: int = 0) -> dict[str, Any]:
        return self.wait(lambda event: event["event"] == "done" and event["job"] == job, since)

    def word(self, name: str, since: int = 0) -> dict[str, Any]:
        return self.wait(lambda event: event["event"] == name, since)


@contextlib.contextmanager
def small_session(folder: Path) -> Iterator[tuple[Session, Ear]]:
    """A session with two small photos and parameters that make their tree quickly."""
    pictures = folder.parent / "pictures"
    pictures.mkdir(exist_ok=True)
    session = Session.open(folder)
    try:
        ear = Ear(session)
        for name, value in _SMALL.items():
            session.apply(do.SetParam(name, value))
        session.apply(do.SetHeight(6.0))
        for file in save_pair(pictures):
            session.add_photo(file.name, file.read_bytes())
        yield session, ear
    finally:
        session.close()
