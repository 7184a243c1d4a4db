"""From photographs to a tree, all stages in order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from threading import Thread
from typing import Any

from flowtree import check
from flowtree.device import pick_device
from flowtree.model.asset import TreeAsset
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.field import DirectionField
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.skeleton import Skeleton
from flowtree.model.traces import FlowTraces
from flowtree.model.tree import TreeModel
from flowtree.model.volume import DensityVolume
from flowtree.params import Params
from flowtree.pipeline.build_report import build_report
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.choose_yaws import choose_yaws
from flowtree.pipeline.digest import digest
from flowtree.pipeline.run_stages import run_stages
from flowtree.pipeline.stage import Job
from flowtree.pipeline.stand_beside_plain import stand_beside_plain
from flowtree.pipeline.table import STAGES, load_steps

_DEFAULT_HEIGHT = 10.0  # [m]
_HIGHEST = 200.0  # [m]; the highest tree on earth has 116

File = str | PathLike[str]
# What belongs to single photos: by the photo's number, or in the photos' order.
PerPhoto = Mapping[int, Any] | Sequence[Any] | None
Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Reconstruction:
    """Everything a reconstruction made; what has one entry a view is in the views' order.

    Attributes:
        photos: at the working resolution; a lone photo's mirror image is the second.
        mattes: with painted edits applied.
        cameras: one a view.
        volume: the density.
        graphs: the attractor graph of each view.
        fields: the direction field of each view.
        traces: of the particles.
        skeleton: with radii and twigs.
        tree: the result, at full detail.
        asset: the same made ready for an engine: what the commands write.
        report: what ``report.json`` says.
    """

    photos: tuple[Photo, ...]
    mattes: tuple[Matte, ...]
    cameras: tuple[Camera, ...]
    volume: DensityVolume
    graphs: tuple[AttractorGraph, ...]
    fields: tuple[DirectionField, ...]
    traces: FlowTraces
    skeleton: Skeleton
    tree: TreeModel
    asset: TreeAsset
    report: dict[str, Any]


def reconstruct(
    photos: Sequence[File | Photo],
    *,
    yaws: Sequence[float] | None = None,
    height: float | None = None,
    params: Params = Params(),
    seed: int = 0,
    mattes: PerPhoto = None,
    strokes: PerPhoto = None,
    marks: PerPhoto = None,
    trimaps: PerPhoto = None,
    scribbles: PerPhoto = None,
    paint: PerPhoto = None,
    progress: Progress | None = None,
    cancel: Callable[[], bool] | None = None,
    cache: StageCache | None = None,
    device: str | None = None,
    made: Callable[[str, Mapping[str, Any]], None] | None = None,
) -> Reconstruction:
    """Makes a tree from one or more photographs of it (Particle Flows).

    What belongs to single photos is given in their order (None for nothing), or by the photo's number from 0;
    each is a file or what the stage that reads such a file returns.

    Args:
        photos: files, or photos already read. One alone is completed by its mirror image, 90 degrees round.
        yaws: from where each was taken [degrees]; left out, they spread evenly over half a turn.
        height: of the tree [m]; left out, 10 is assumed.
        params: of all stages.
        seed: other seeds give similar, different trees.
        mattes: made elsewhere: pictures or arrays (h, w) in 0..1 of the working size, used as they are.
        strokes: drawn branches, as optional attractors.
        marks: foot, top, first fork and seeds: `ViewMarks`, in working pixels, or a JSON file; left out,
            those that lie beside a photo's strokes where these are a JSON file.
        trimaps: what is tree, background and unknown.
        scribbles: strokes on tree and background.
        paint: painted edits.
        progress: called with a stage's name and the share of the whole work done, 0..1.
        cancel: asked again and again; true stops the work.
        cache: results of earlier calls; pass the same one each time to repeat only what changed.
        device: "cpu" or "cuda"; None picks.
        made: called when a stage is done, with its name and what it made, by name (see `run_stages`).

    Returns: views, volume, traces, skeleton, tree and report.

    Raises:
        InputError: a photo, file, number or parameter that breaks its rule; the message names it.
        CancelledError: ``cancel`` said so.
    """
    check.require(
        not isinstance(photos, str | bytes | PathLike | Photo),
        "photos",
        "must be a list",
        repr(photos)[:60],
        "put it in a list, such as [photo]",
    )
    count = len(photos)
    turns = choose_yaws(count, yaws)
    metres = _DEFAULT_HEIGHT if height is None else height
    check.require(
        isinstance(metres, int | float) and not isinstance(metres, bool) and 0.01 <= metres <= _HIGHEST,
        "height",
        f"must be 0.01 to {_HIGHEST:g} metres",
        repr(metres),
        "give the tree's height in metres",
    )
    whole = isinstance(seed, int) and not isinstance(seed, bool) and 0 <= seed < 2**63
    check.require(whole, "seed", "must be a whole number from 0", repr(seed), "give another")
    views = len(turns)
    drawn = _per_photo(strokes, count, "strokes")
    given = {
        "photo_source": [photo if isinstance(photo, Photo) else Path(photo) for photo in photos],
        "matte_source": _per_photo(mattes, count, "mattes"),
        "trimap_source": _per_photo(trimaps, count, "trimaps"),
        "scribbles_source": _per_photo(scribbles, count, "scribbles"),
        "strokes_source": drawn,
        "marks_source": [
            _same_json(lines) if given_marks is None else given_marks
            for lines, given_marks in zip(drawn, _per_photo(marks, count, "marks"), strict=True)
        ],
        "paint_source": _per_photo(paint, count, "paint"),
    }
    bark, leaf, twig = params.meshing.bark, params.leaves.picture, params.twigs.sketch
    sources = {
        **{name: tuple(values * views if count == 1 else values) for name, values in given.items()},
        "mirrored": tuple(view >= count for view in range(views)),
        "yaw": turns,
        "height": (float(metres),) * views,
        "bark_source": None if bark == "auto" else Path(bark),
        "leaf_source": None if leaf is None else Path(leaf),
        "twig_source": None if twig is None else Path(twig),
    }
    warnings = _warnings(given["photo_source"], height)
    chosen = pick_device(device)
    job = Job(params=params, seed=seed, device=chosen)
    Thread(target=load_steps, name="flowtree-imports").start()
    painted = any(edit is not None for edit in given["paint_source"])
    run = run_stages(
        stand_beside_plain(STAGES) if painted else STAGES,
        sources if painted else {**sources, "plain_skeleton": None, "plain_foliage": None},
        job,
        views=views,
        cache=cache,
        progress=progress,
        cancel=cancel,
        made=made,
    )
    values = run.values
    report = build_report(
        photos=values["photos"],
        mattes=values["mattes"],
        cameras=values["cameras"],
        placements=values["placements"],
        soft_ious=values["soft_ious"],
        tree=values["tree"],
        watertight=values["watertight"],
        seconds=run.seconds,
        seed=seed,
        device=chosen,
        warnings=warnings,
    )
    return Reconstruction(
        photos=values["photos"],
        mattes=values["mattes"],
        cameras=values["cameras"],
        volume=values["volume"],
        graphs=values["graphs"],
        fields=values["fields"],
        traces=values["traces"],
        skeleton=values["skeleton"],
        tree=values["tree"],
        asset=values["asset"],
        report=report,
    )


def _per_photo(values: PerPhoto, count: int, name: str) -> list[Any]:
    """One entry a photo, files as paths."""
    entries: list[Any] = [None] * count
    pairs = values.items() if isinstance(values, Mapping) else enumerate(values or ())
    for photo, value in pairs:
        check.require(
            photo in range(count),
            name,
            f"must belong to a photo, 0 to {count - 1}",
            f"photo {photo}",
            "name one of the photos, counted from 0",
        )
        entries[photo] = Path(value) if isinstance(value, str | PathLike) else value
    return entries


def _same_json(strokes: Any) -> Path | None:
    """The file of strokes, if it is of the kind that may hold marks, too."""
    return strokes if isinstance(strokes, Path) and strokes.suffix.lower() == ".json" else None


def _warnings(photos: Sequence[Path | Photo], height: float | None) -> list[str]:
    """What was assumed because it was not given."""
    warnings = []
    if len(photos) == 1:
        warnings.append("one photo: its mirror image is the second view, from 90 degrees further round")
    if height is None:
        warnings.append(f"no height given: {_DEFAULT_HEIGHT:g} m is assumed")
    if len(photos) > 1 and len({digest(photo) for photo in photos}) < len(photos):
        warnings.append("the same photo is given for several views")
    return warnings
