"""Makes the tree of a project."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.reconstruct import Reconstruction, reconstruct
from flowtree.project.project import Project


def reconstruct_project(
    project: Project,
    *,
    progress: Callable[[str, float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
    cache: StageCache | None = None,
    device: str | None = None,
    made: Callable[[str, Mapping[str, Any]], None] | None = None,
) -> Reconstruction:
    """The same tree as `reconstruct` makes from the same photos, files, parameters and seed.

    Raises:
        InputError: a photo, file or parameter of the project breaks its rule.
        CancelledError: ``cancel`` said so.
    """
    return reconstruct(
        project.photos,
        yaws=project.yaws,
        height=project.height,
        params=project.params,
        seed=project.seed,
        mattes=project.mattes,
        strokes=project.strokes,
        trimaps=project.trimaps,
        scribbles=project.scribbles,
        paint=project.paint,
        progress=progress,
        cancel=cancel,
        cache=cache,
        device=device,
        made=made,
    )
