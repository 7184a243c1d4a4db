"""The tree that the same photographs give where nobody has painted on them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material
from flowtree.model.skeleton import Skeleton
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.run_stages import run_stages
from flowtree.pipeline.stage import Job
from flowtree.pipeline.table import STAGES


@dataclass(frozen=True)
class PlainTree:
    """What of it a painted edit leaves as it is.

    Attributes:
        skeleton: with radii and twigs.
        foliage: None for a bare tree.
        bark: of its wood.
    """

    skeleton: Skeleton
    foliage: Foliage | None
    bark: Material


def make_plain_tree(
    sources: Mapping[str, Any],
    job: Job,
    *,
    views: int,
    cache: StageCache,
    progress: Callable[[str, float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
) -> PlainTree | None:
    """Runs the stages without the paint, as far as leaves and bark; None where nothing is painted.

    Args:
        sources: of all stages, as `run_stages` takes them, but for ``plain`` and ``plain_skeleton``.
        job: parameters, seed and device.
        views: how many.
        cache: takes what both trees share.
        progress: as `run_stages` calls it.
        cancel: as `run_stages` asks it.
    """
    if all(source is None for source in sources["paint_source"]):
        return None
    run = partial(run_stages, STAGES, job=job, views=views, cache=cache, progress=progress, cancel=cancel)
    bare = {**sources, "plain": None, "plain_skeleton": None}
    mattes = run(bare, until="coloring").values["raw_matte"]
    # Where there is no tree without the paint, it is no edit: it makes the matte (see `run_painting`).
    bare["paint_source"] = tuple(
        None if matte.alpha.any() else paint
        for matte, paint in zip(mattes, sources["paint_source"], strict=True)
    )
    values = run(bare, until="leaf_patching").values
    return PlainTree(values["skeleton"], values["foliage"], values["bark"])
