"""Files that were exported, until the studio closes."""

from __future__ import annotations

import io
import secrets
import shutil
import threading
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flowtree import check
from flowtree.configuration import params_from_table
from flowtree.params import Params
from flowtree.project.document_state import DocumentState

_TREES = ("glb", "usda", "usdc", "usdz", "obj", "ply")
_BRANCHES = ("swc", "csv", "json")
_SECTIONS = ("asset", "wind", "collision", "export", "meshing")
_KEPT = 8  # exports that can still be fetched
_ENTRY_DATE = (1980, 1, 1, 0, 0, 0)  # equal files, equal archives


@dataclass(frozen=True)
class Order:
    """An export that was asked for.

    Attributes:
        id: nobody can guess it.
        output: where the worker writes.
        params: that hold for it alone.
        branches: whether it is the skeleton.
    """

    id: str
    output: Path
    params: Mapping[str, Any]
    branches: bool


class Exports:
    """Names, packs and keeps what was exported.

    Args:
        scratch: where files are written, a folder for each export.
        folder: of the project, whose name they get.
    """

    def __init__(self, scratch: Path, folder: Path) -> None:
        self._scratch, self._folder = scratch, folder
        self._lock = threading.Lock()
        self._ready: dict[str, tuple[str, Path]] = {}

    def order(self, kind: str, options: Mapping[str, Any], params: Params) -> Order:
        """Checks what is asked for.

        Raises:
            InputError: an unknown kind, an option that is no parameter of an export, or breaks its rule.
        """
        known = (*_TREES, *_BRANCHES)
        if kind not in known:
            check.fail(
                "export", "must be of a known kind", repr(kind)[:40], check.nearest_name(str(kind), known)
            )
        table = params.model_dump()
        for name, value in options.items():
            section, _, key = str(name).partition(".")
            about = section in _SECTIONS and name != "meshing.bark"
            check.require(about, "export", f"takes options of {', '.join(_SECTIONS)}", name, "leave it out")
            table[section][key] = value
        params_from_table(table)
        export = secrets.token_urlsafe(12)
        output = self._scratch / export / f"{self._stem()}.{kind}"
        return Order(export, output, dict(options), kind in _BRANCHES)

    def deliver(self, export: str) -> dict[str, Any]:
        """Makes what a worker wrote ready to be fetched, several files as one archive.

        Returns: the event that tells of it.
        """
        folder = self._scratch / export
        files = sorted(file for file in folder.iterdir() if file.is_file())
        if len(files) > 1:
            packed = folder / f"{self._stem()}.zip"
            packed.write_bytes(_pack({file.name: file.read_bytes() for file in files}))
            return self._keep(export, packed, [file.name for file in files])
        return self._keep(export, files[0], [files[0].name])

    def pack_project(self, state: DocumentState) -> dict[str, Any]:
        """The saved project as one archive.

        Returns: the event that tells of it.
        """
        from flowtree.project.load_project import load_project
        from flowtree.project.project import PER_PHOTO

        project = load_project(self._folder)
        base = self._folder.resolve()
        files = {*project.photos, *(file for kind in PER_PHOTO for file in getattr(project, kind).values())}
        files |= {self._folder / place for place in state.places()}
        names = {file.resolve().relative_to(base).as_posix(): file for file in files}
        names |= {name: self._folder / name for name in ("project.json", "params.toml")}
        export = secrets.token_urlsafe(12)
        output = self._scratch / export / f"{self._stem()}.zip"
        output.parent.mkdir(parents=True)
        output.write_bytes(_pack({name: file.read_bytes() for name, file in sorted(names.items())}))
        return self._keep(export, output, sorted(names))

    def get(self, export: str) -> tuple[str, bytes] | None:
        """Name and content of what was exported."""
        with self._lock:
            found = self._ready.get(export)
        return None if found is None else (found[0], found[1].read_bytes())

    def _stem(self) -> str:
        return self._folder.resolve().name or "tree"

    def _keep(self, export: str, file: Path, files: list[str]) -> dict[str, Any]:
        with self._lock:
            self._ready[export] = (file.name, file)
            old = list(self._ready)[:-_KEPT]
            for name in old:
                del self._ready[name]
        for name in old:
            shutil.rmtree(self._scratch / name, ignore_errors=True)
        return {
            "event": "exported",
            "id": export,
            "url": f"/export/{export}",
            "name": file.name,
            "files": files,
        }


def _pack(files: Mapping[str, bytes]) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(zipfile.ZipInfo(name, _ENTRY_DATE), data, zipfile.ZIP_DEFLATED)
    return content.getvalue()
