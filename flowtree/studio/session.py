"""One project open in the studio: its document, what runs for it, and what it looks like now."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.project import commands as do
from flowtree.project.command_json import command_from_json
from flowtree.project.document import Document
from flowtree.project.load_document import load_document
from flowtree.project.name_command import name_command
from flowtree.project.state_json import state_to_json
from flowtree.studio.engine import Engine
from flowtree.studio.exports import Exports
from flowtree.studio.hold_folder import HeldFolder
from flowtree.studio.keep_picture import DEMO, DEMO_HEIGHT, keep_picture
from flowtree.studio.layer_shelf import ShownLayer
from flowtree.studio.read_archive import read_archive
from flowtree.studio.saver import Saver

Event = dict[str, Any]


class Session:
    """Everything the page asks for and shows; plain Python, safe to call from any thread.

    Made by `Session.open`.
    """

    def __init__(self, folder: Path, document: Document, held: HeldFolder, notice: str | None) -> None:
        self.folder = folder
        self._held, self._document = held, document
        self._lock = threading.RLock()
        self._files = threading.Lock()
        self._listeners: list[Callable[[Event], None]] = []
        self._tabs = 0
        self.notice = notice
        self._scratch = Path(tempfile.mkdtemp(prefix="flowtree-studio-"))
        self._exports = Exports(self._scratch / "exports", folder)
        self._engine = Engine(folder, self._scratch / "drawn", self._hear)
        self._saver = Saver(folder, self._tell, self._files)
        self._saver.saved_revision = document.revision

    @classmethod
    def open(cls, folder: str | Path) -> Session:
        """Opens a project's folder, or begins a project in a new or empty one; its tree begins to grow.

        Raises:
            InputError: a damaged project, or one that another process has open.
            OutputError: the folder cannot be made or written.
        """
        base = Path(folder)
        try:
            base.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            check.fail(str(base), "must be a folder", str(error.strerror), "name another")
        held = HeldFolder(base)
        try:
            document, notice = Document(), None
            if (base / "project.json").exists():
                document, notice = load_document(base)
        except BaseException:
            held.release()
            raise
        session = cls(base, document, held, notice)
        session._engine.start()
        session._engine.update(document.state, document.revision)
        return session

    def close(self) -> None:
        """Saves what is not yet saved (see `saved`), and ends all processes."""
        if not self.saved:
            self._saver.save(self._document.copy())
        self._saver.close()
        self._engine.close()
        self._held.release()
        shutil.rmtree(self._scratch, ignore_errors=True)

    def apply(self, command: do.Command, gesture: str | None = None) -> None:
        """Does a command.

        Raises:
            InputError: it breaks a rule; nothing has changed.
        """
        self._change(lambda: self._document.apply(command, gesture) is not None)

    def apply_json(self, table: Any) -> None:
        """Does a command that a page sent, with its ``gesture`` if it has one.

        Raises:
            InputError: it is no command, or breaks a rule; nothing has changed.
        """
        held = isinstance(table, dict)
        check.require(held, "command", "must be an object", type(table).__name__, "send one")
        rest = {name: value for name, value in table.items() if name != "gesture"}
        gesture = table.get("gesture")
        text = gesture is None or isinstance(gesture, str)
        check.require(text, "gesture", "must be a text", repr(gesture)[:40], "leave it out")
        self.apply(command_from_json(rest), gesture)

    def undo(self) -> bool:
        """Goes back one step; false if there is none."""
        return self._change(self._document.undo)

    def redo(self) -> bool:
        """Does again what was undone last; false if there is nothing."""
        return self._change(self._document.redo)

    def add_photo(self, name: str, data: bytes) -> int:
        """Takes a photo into the project; returns its number.

        Raises:
            InputError: no picture, or too large a one.
            OutputError: the project's folder cannot be written.
        """
        with self._files:
            picture = keep_picture(self.folder, "photos", name, data, self._document.state.params.photos)
            self.apply(do.AddPhoto(picture.place, picture.width, picture.height))
            return len(self._document.state.photos) - 1

    def use_demo(self) -> None:
        """Takes the bundled pair of pictures.

        Raises:
            OutputError: the project's folder cannot be written.
        """
        for file in DEMO:
            self.add_photo(file.name, file.read_bytes())
        self.apply(do.SetHeight(DEMO_HEIGHT))

    def add_picture(self, parameter: str, name: str, data: bytes) -> None:
        """Takes a picture of bark, a leaf or a twig into the project.

        Raises:
            InputError: no picture, too large a one, or a parameter that names none.
            OutputError: the project's folder cannot be written.
        """
        with self._files:
            kept = keep_picture(self.folder, "pictures", name, data, self._document.state.params.photos)
            self.apply(do.SetPicture(parameter, kept.place))

    def open_archive(self, data: bytes) -> None:
        """Puts the project of an archive in the place of this one; that can be undone.

        Raises:
            InputError: no archive of a project, or one that holds what it should not.
            OutputError: the project's folder cannot be written.
        """
        with self._files:
            state = read_archive(data, self.folder)
            self.apply(do.OpenState(state))

    def run(self) -> None:
        """Begins (again) what is not up to date; every change does so by itself."""
        self._engine.run()
        self._tell({"event": "state", "revision": self._document.revision})

    def cancel(self) -> None:
        """Ends what runs, within half a second; nothing runs until the next change or `run`."""
        self._engine.cancel()

    def variants(self, seeds: Sequence[int]) -> None:
        """Pictures of the trees of other seeds, as layers ``variant/SEED``."""
        valid = 0 < len(seeds) <= 12 and all(isinstance(seed, int) and 0 <= seed < 2**63 for seed in seeds)
        check.require(valid, "seeds", "must be 1 to 12 whole numbers from 0", list(seeds)[:12], "send such")
        some = len(self._document.state.photos) > 0
        check.require(some, "variants", "need a tree", "a project without photos", "add a photo first")
        self._engine.variants(seeds)

    def export(self, kind: str, options: Mapping[str, Any]) -> str:
        """Begins to write a file; the event ``exported`` says where it is.

        Args:
            kind: its ending without the dot, or "project" for an archive of all that the project holds.
            options: parameters that hold for this file alone, ``{"asset.levels": 3}``.

        Returns: the export's id.

        Raises:
            InputError: an unknown kind or option, or no photo yet.
        """
        some = len(self._document.state.photos) > 0
        check.require(some, "export", "needs a tree", "a project without photos", "add a photo first")
        if kind == "project":
            self._saver.flush()
            with self._files:
                event = self._exports.pack_project(self._document.state)
            self._tell(event)
            return str(event["id"])
        order = self._exports.order(kind, options, self._document.state.params)
        self._engine.export(order)
        return order.id

    def exported(self, export: str) -> tuple[str, bytes] | None:
        """Name and content of a file that was exported."""
        return self._exports.get(export)

    def layers(self) -> dict[str, int]:
        """The revision of every layer there is, by its name."""
        return self._engine.shelf.layers()

    def layer(self, name: str) -> ShownLayer | None:
        """A layer as it is now."""
        return self._engine.shelf.get(name)

    @property
    def busy(self) -> bool:
        """Whether anything runs."""
        return self._engine.busy

    @property
    def saved(self) -> bool:
        """Whether the folder holds the latest state."""
        return self._saver.saved_revision == self._document.revision

    @property
    def pids(self) -> tuple[int | None, int | None]:
        """The processes that work: for mattes, and for trees."""
        return self._engine.pids

    def state_json(self) -> dict[str, Any]:
        """What the page shows besides the layers."""
        with self._lock:
            document = self._document
            table = state_to_json(document.state)
            for photo, drawn in zip(table["photos"], document.state.photos, strict=True):
                del photo["place"]
                photo |= {"name": drawn.name, "attached": [kind for kind, _ in drawn.attached]}
            table["pictures"] = {name: Path(place).name for name, place in document.state.pictures}
            undo, redo = document.to_undo, document.to_redo
            return table | {
                "revision": document.revision,
                "name": self.folder.resolve().name,
                "undo": None if undo is None else name_command(undo),
                "redo": None if redo is None else name_command(redo),
                "busy": self.busy,
                "saved": self.saved,
                "problem": self._engine.problem,
                "notice": self.notice,
            }

    def listen(self, callback: Callable[[Event], None]) -> Callable[[], None]:
        """Has every event told, from whatever thread it happens in; returns what ends that."""
        with self._lock:
            self._listeners.append(callback)

        def end() -> None:
            with self._lock, contextlib.suppress(ValueError):
                self._listeners.remove(callback)

        return end

    def enter(self) -> int:
        """A page joins; returns how many others there are."""
        with self._lock:
            self._tabs += 1
            return self._tabs - 1

    def leave(self) -> None:
        """A page has gone."""
        with self._lock:
            self._tabs = max(0, self._tabs - 1)

    def flush(self) -> None:
        """Waits until the latest state is saved, or could not be."""
        self._saver.flush()

    def _change(self, change: Callable[[], bool]) -> bool:
        with self._lock:
            before = self._document.revision
            change()
            revision = self._document.revision
            if revision == before:
                return False
            self._engine.update(self._document.state, revision)
            self._saver.save(self._document.copy())
        self._tell({"event": "state", "revision": revision})
        return True

    def _hear(self, event: Event) -> None:
        if event["event"] == "written":
            event = self._exports.deliver(event["id"])
        self._tell(event)

    def _tell(self, event: Event) -> None:
        with self._lock:
            listeners = list(self._listeners)
        for listener in listeners:
            listener(event)
