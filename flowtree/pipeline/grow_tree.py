"""From a skeleton of any origin to a tree, without photographs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from flowtree import check
from flowtree.branches.mend_skeleton import mend_skeleton
from flowtree.branches.shape_twigs import TwigShapes
from flowtree.branches.sprout_twigs import sprout_twigs
from flowtree.device import pick_device
from flowtree.foliage.make_leaf import make_leaf
from flowtree.foliage.scatter_leaves import scatter_leaves
from flowtree.geometry.read_color import read_color
from flowtree.meshing.load_bark import load_bark
from flowtree.meshing.paint_bark import paint_bark
from flowtree.model.asset import TreeAsset
from flowtree.model.attractor import Habit
from flowtree.model.foliage import Foliage
from flowtree.model.mesh import Material, TreeMesh
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from flowtree.params import Params
from flowtree.pipeline.build_report import growth_report
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.run_stages import run_stages
from flowtree.pipeline.stage import Job, Stage
from flowtree.pipeline.table import STAGES

_GROWTH: dict[str, Habit] = {"needle": "conifer", "frond": "palm"}  # what leaves tell of the bark
_LEAF = (0.8, 0.8, 0.8)  # linear; leaves take their own colour from the foliage


@dataclass(frozen=True)
class Growth:
    """A tree and what it was grown from.

    Attributes:
        tree: the result, at full detail.
        asset: the same made ready for an engine: what the commands write.
        report: what ``report.json`` says.
    """

    tree: TreeModel
    asset: TreeAsset
    report: dict[str, Any]


def grow_tree(
    skeleton: Skeleton,
    *,
    height: float | None = None,
    up: Literal["y", "z"] = "y",
    twigs: bool | None = None,
    params: Params = Params(),
    seed: int = 0,
    progress: Callable[[str, float], None] | None = None,
    cancel: Callable[[], bool] | None = None,
    cache: StageCache | None = None,
    device: str | None = None,
) -> Growth:
    """Gives a skeleton radii where it has none, twigs, leaves, bark and a surface (Particle Flows, 8).

    Args:
        skeleton: as `read_skeleton` gives it; what is wrong with it is repaired or refused, see
            `mend_skeleton`.
        height: to which it is scaled [m]; None takes its coordinates as metres.
        up: the axis that points to the sky in the skeleton.
        twigs: whether twigs are added; None adds them where the skeleton holds none.
        params: of all stages; ``leaves.bear`` "auto" bears leaves.
        seed: other seeds give other twigs and leaves.
        progress: called with a stage's name and the share of the whole work done, 0..1.
        cancel: asked again and again; true stops the work.
        cache: results of earlier calls.
        device: "cpu" or "cuda"; None picks.

    Raises:
        InputError: the skeleton, a number or a parameter breaks its rule.
        CancelledError: ``cancel`` said so.
    """
    tall = height is None or (isinstance(height, int | float) and not isinstance(height, bool) and height > 0)
    check.require(tall, "height", "must be more than 0 metres", repr(height), "give the tree's height")
    whole = isinstance(seed, int) and not isinstance(seed, bool) and 0 <= seed < 2**63
    check.require(whole, "seed", "must be a whole number from 0", repr(seed), "give another")
    check.require(up in ("y", "z"), "up", "must be y or z", repr(up), "name one of them")
    bark, leaf, twig = params.meshing.bark, params.leaves.picture, params.twigs.sketch
    sources = {
        "drawn": skeleton,
        "wanted_height": height,
        "up": up,
        "wants_twigs": twigs,
        "bark_source": None if bark == "auto" else Path(bark),
        "leaf_source": None if leaf is None else Path(leaf),
        "twig_source": None if twig is None else Path(twig),
    }
    chosen = pick_device(device)
    job = Job(params=params, seed=seed, device=chosen)
    run = run_stages(GROWING, sources, job, views=1, cache=cache, progress=progress, cancel=cancel)
    made = run.values
    report = growth_report(
        tree=made["tree"],
        watertight=made["watertight"],
        seconds=run.seconds,
        seed=seed,
        device=chosen,
        warnings=made["notes"],
    )
    return Growth(made["tree"], made["asset"], report)


def _mend(
    job: Job, drawn: Skeleton, height: float | None, up: Literal["y", "z"]
) -> tuple[Skeleton, tuple[str, ...], tuple[float, ...]]:
    """The skeleton repaired, what was done to it, and its height."""
    mended, notes = mend_skeleton(drawn, height=height, up=up, params=job.params.thickness)
    return mended, notes, (float(mended.points[:, 1].max()),)


def _sprout(
    job: Job,
    branches: Skeleton,
    heights: tuple[float, ...],
    twigs: bool | None,
    sketched: TwigShapes | None,
) -> Skeleton:
    if twigs is False or (twigs is None and bool(branches.twig.any())):
        return branches
    leafy = job.params.leaves.bear != "never"
    params, seed = job.params.twigs, job.seed
    return sprout_twigs(branches, height=heights[0], leafy=leafy, shapes=sketched, params=params, seed=seed)


def _bark(job: Job, picture: Path | None) -> Material:
    if picture is not None:
        return load_bark(picture)
    params = job.params.meshing
    color = None if params.bark_color == "auto" else read_color(params.bark_color, "bark color")
    return paint_bark(
        color, style=params.bark_style, growth=_GROWTH.get(job.params.leaves.shape), seed=job.seed
    )


def _leaf(job: Job, picture: Path | None) -> tuple[TreeMesh, Material] | None:
    """One leaf, if the tree shall have any; its picture is an input so that a new one makes a new leaf."""
    del picture
    params = job.params.leaves
    if params.bear == "never":
        return None
    shape = "broad" if params.shape == "auto" else params.shape
    return make_leaf(shape, color=_LEAF, seed=job.seed, picture=params.picture)


def _foliage(
    job: Job, skeleton: Skeleton, leaf: tuple[TreeMesh, Material] | None, heights: tuple[float, ...]
) -> Foliage | None:
    if leaf is None:
        return None
    return scatter_leaves(skeleton, leaf, height=heights[0], params=job.params.leaves, seed=job.seed)


# Stages that do the same as with photographs.
_SHARED = {stage.name: stage for stage in STAGES}
GROWING: tuple[Stage, ...] = (
    Stage(
        name="mending",
        run=_mend,
        inputs=("drawn", "wanted_height", "up"),
        outputs=("branches", "notes", "height"),
        params=("thickness",),
        share=0.1,
    ),
    _SHARED["sketch"],
    Stage(
        name="twigs",
        run=_sprout,
        inputs=("branches", "height", "wants_twigs", "sketched_twig"),
        outputs=("skeleton",),
        params=("twigs", "leaves"),
        seeded=True,
        share=0.3,
    ),
    _SHARED["meshing"],
    Stage(
        name="bark",
        run=_bark,
        inputs=("bark_source",),
        outputs=("bark",),
        params=("meshing", "leaves"),
        seeded=True,
        share=0.3,
    ),
    Stage(
        name="leaf",
        run=_leaf,
        inputs=("leaf_source",),
        outputs=("leaf",),
        params=("leaves",),
        seeded=True,
        share=0.2,
    ),
    Stage(
        name="foliage",
        run=_foliage,
        inputs=("skeleton", "leaf", "height"),
        outputs=("foliage",),
        params=("leaves",),
        seeded=True,
        share=0.4,
    ),
    _SHARED["assembly"],
    _SHARED["equipping"],
    _SHARED["closing"],
)
