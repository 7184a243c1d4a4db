"""What a worker is asked to do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from flowtree.project.document_state import DocumentState

Kind = Literal["matte", "tree", "variants", "export"]


@dataclass(frozen=True)
class StudioJob:
    """One piece of work on one state of the document.

    Attributes:
        number: later jobs have larger ones.
        kind: "matte" cuts the photos out, "tree" makes the tree, "variants" that of another seed, "export" a
            file.
        state: of the document.
        folder: of the project.
        scratch: where the worker may write.
        revision: of the document's state.
        kept: results of another worker for this one's cache, packed.
        options: "seed" of a variant, and "part", how many of how many are done; the "order" of an export.
    """

    number: int
    kind: Kind
    state: DocumentState
    folder: Path
    scratch: Path
    revision: int
    kept: tuple[bytes, ...] = ()
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Message:
    """What a worker answers.

    Attributes:
        number: of the job.
        kind: "progress", "layer", "kept", "exported", then one of "done", "failed", "cancelled"; "crashed" is
            said for a worker that says nothing any more.
        content: stage and share, a `Layer`, packed results, seconds or a text.
    """

    number: int
    kind: str
    content: Any = None

    @property
    def last(self) -> bool:
        """Whether the job has ended."""
        return self.kind in ("done", "failed", "cancelled", "crashed")
