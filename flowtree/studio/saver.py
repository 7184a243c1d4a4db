"""Saves a document after every change, beside all else."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from flowtree.errors import FlowtreeError
from flowtree.project.document import Document
from flowtree.project.save_document import save_document

_AGAIN = 3.0  # [s] until what could not be written is tried again


class Saver:
    """A thread that writes the latest document it was given; those between need not be written.

    What cannot be written is tried again and again, also when nobody asks for it.

    Args:
        folder: of the project.
        tell: called with an event once a document is saved, and once where it could not be.
        files: held while files of the folder are written or removed.
    """

    def __init__(self, folder: Path, tell: Callable[[dict[str, Any]], None], files: threading.Lock) -> None:
        self._folder, self._tell, self._files = folder, tell, files
        self._changed = threading.Condition()
        self._waiting: Document | None = None
        self._writing = self._closed = False
        self.saved_revision: int | None = None
        self._lost_revision: int | None = (
            None  # of the state that could not be saved, and of which that was told
        )
        self._thread = threading.Thread(target=self._work, name="flowtree-saver", daemon=True)
        self._thread.start()

    def save(self, document: Document) -> None:
        """Asks for a document to be written; returns at once.

        Args:
            document: a copy that nobody changes.
        """
        with self._changed:
            self._waiting = document
            self._changed.notify_all()

    def flush(self) -> None:
        """Waits until all that was asked for has been tried."""
        with self._changed:
            self._changed.wait_for(lambda: self._waiting is None and not self._writing)

    def close(self) -> None:
        """Writes what waits, and ends."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.join()

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting is not None or self._closed)
                if self._waiting is None:
                    return
                self._writing = True
            lost, event = self._try()
            with self._changed:
                self._writing = False
                self._changed.notify_all()
            if event is not None:
                self._tell(event)
            with self._changed:  # whoever is told makes room, and need not do anything else
                newer = lost is None or self._changed.wait_for(
                    lambda: self._waiting is not None or self._closed, timeout=_AGAIN
                )
                if not newer:
                    self._waiting = lost

    def _try(self) -> tuple[Document | None, dict[str, Any] | None]:
        """Saves what waits once the files are ours; what could not be saved, and what is to be told of it.

        Not before: an older document does not know of a photo that has come meanwhile, and saving it would
        remove that photo's file.
        """
        with self._files:
            with self._changed:
                document, self._waiting = self._waiting, None
            assert document is not None
            try:
                save_document(document, self._folder)
            except (FlowtreeError, OSError) as error:
                told, self._lost_revision = self._lost_revision == document.revision, document.revision
                return document, None if told else {"event": "unsaved", "message": str(error)}
        self.saved_revision, self._lost_revision = document.revision, None
        return None, {"event": "saved", "revision": document.revision}
