"""Saves a document after every change, beside all else."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from flowtree.errors import FlowtreeError
from flowtree.project.document import Document
from flowtree.project.save_document import save_document


class Saver:
    """A thread that writes the latest document it was given; those between need not be written.

    Args:
        folder: of the project.
        tell: called with an event after every attempt.
        files: held while files of the folder are written or removed.
    """

    def __init__(self, folder: Path, tell: Callable[[dict[str, Any]], None], files: threading.Lock) -> None:
        self._folder, self._tell, self._files = folder, tell, files
        self._changed = threading.Condition()
        self._waiting: Document | None = None
        self._writing = self._closed = False
        self.saved_revision: int | None = None
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
            try:
                document = self._save_latest()
            except (FlowtreeError, OSError) as error:
                event: dict[str, Any] = {"event": "unsaved", "message": str(error)}
            else:
                self.saved_revision = document.revision
                event = {"event": "saved", "revision": document.revision}
            with self._changed:
                self._writing = False
                self._changed.notify_all()
            self._tell(event)

    def _save_latest(self) -> Document:
        """Saves what waits once the files are ours.

        Not before: an older document does not know of a photo that has come meanwhile, and saving it would
        remove that photo's file.
        """
        with self._files:
            with self._changed:
                document, self._waiting = self._waiting, None
            assert document is not None
            save_document(document, self._folder)
            return document
