"""What a worker does: cuts out, makes trees, writes files, and tells what comes of it."""

from __future__ import annotations

import contextlib
import pickle
import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from threading import Lock
from typing import Any

from flowtree.check import one_line
from flowtree.configuration import params_from_table
from flowtree.device import pick_device
from flowtree.errors import CancelledError, FlowtreeError, InputError
from flowtree.matting.cut_out_tree import CutOut
from flowtree.params import Params
from flowtree.pipeline.run_stages import run_stages
from flowtree.pipeline.stage import Job
from flowtree.pipeline.table import STAGES, load_steps
from flowtree.project.project import Project
from flowtree.project.save_document import lay_out_project
from flowtree.studio.job import Message, StudioJob
from flowtree.studio.layer_book import LayerBook
from flowtree.studio.layers.layer import Layer, json_layer
from flowtree.studio.layers.photo_layers import matte_layer, photo_layer
from flowtree.studio.recording_cache import RecordingCache

_MATTING = tuple(stage for stage in STAGES if stage.name in ("photos", "picks", "preparing", "matting"))


class Bench:
    """Runs jobs; its cache, and what it knows of layers already sent, last from job to job."""

    def __init__(self, connection: Connection, stopped: Any, kept: int) -> None:
        self._connection, self._stopped = connection, stopped
        self._sending = Lock()
        self._cache = RecordingCache(kept)
        self._book = LayerBook()

    def run(self, job: StudioJob) -> None:
        """Does a job and says how it ended."""
        begin = time.perf_counter()
        works: dict[str, Callable[[StudioJob, Project], None]] = {
            "matte": self._cut_out,
            "tree": self._make_tree,
            "variants": self._make_variant,
            "export": self._write_file,
        }
        try:
            if self._is_stopped(job):
                raise CancelledError("stopped before it began")
            for packed in job.kept:  # from a process of ours
                for key, result in pickle.loads(packed).items():
                    self._cache.put(key, result)
            if job.kind != "matte":
                load_steps()  # before anything else of what they import
            works[job.kind](job, lay_out_project(job.state, job.folder, job.scratch))
        except CancelledError:
            self._say(job, "cancelled")
        except FlowtreeError as error:
            self._say(job, "failed", str(error))
        except MemoryError:
            self._say(job, "failed", "out of memory; lower photos.working_height or density.resolution")
        except (BrokenPipeError, ConnectionResetError):
            raise  # nobody is there to be told
        except OSError as error:
            self._say(job, "failed", one_line(f"{error.filename or 'a file'}: {error.strerror or error}"))
        except Exception as error:
            self._say(
                job, "failed", one_line(f"unexpected {type(error).__name__}: {error} (a fault of ours)")
            )
        else:
            self._say(job, "done", time.perf_counter() - begin)
        if job.kind != "matte":  # nobody asks for these
            self._cache.take_new()

    def _cut_out(self, job: StudioJob, project: Project) -> None:
        """The photos, then their mattes; the results go to the other worker."""
        numbers = range(len(project.photos))
        for k in numbers:
            file, params = project.photos[k], project.params.photos
            made_from = (job.state.photos[k].place,)
            make = partial(photo_layer, k, file, params)
            self._draw(job, self._book.draw(f"photo/{k}", made_from, make))
        try:
            mattes = self._mattes(job, project, numbers)
        except InputError:  # of one photo: the others' mattes are shown all the same
            for k in numbers:
                with contextlib.suppress(InputError):
                    self._show_matte(job, k, self._mattes(job, project, range(k, k + 1))[0])
            raise
        for k, matte in enumerate(mattes):
            self._show_matte(job, k, matte)
        self._say(job, "kept", pickle.dumps(self._cache.take_new(), pickle.HIGHEST_PROTOCOL))

    def _mattes(self, job: StudioJob, project: Project, numbers: range) -> tuple[CutOut, ...]:
        sources = {
            "photo_source": tuple(project.photos[k] for k in numbers),
            "matte_source": tuple(project.mattes.get(k) for k in numbers),
            "trimap_source": tuple(project.trimaps.get(k) for k in numbers),
            "scribbles_source": tuple(project.scribbles.get(k) for k in numbers),
        }
        run = run_stages(
            _MATTING,
            sources,
            Job(project.params, project.seed, pick_device()),
            views=len(numbers),
            cache=self._cache,
            progress=lambda stage, share: self._say(job, "progress", (stage, share)),
            cancel=lambda: self._is_stopped(job),
        )
        cuts: tuple[CutOut, ...] = run.values["raw_cut"]
        return cuts

    def _show_matte(self, job: StudioJob, number: int, matte: CutOut) -> None:
        name = f"matte/{number}"
        before = self._book.before(name)
        old = None if before is None else before[0].alpha
        self._draw(job, self._book.draw(name, (matte,), partial(matte_layer, number, matte.alpha, old)))

    def _make_tree(self, job: StudioJob, project: Project) -> None:
        """The tree, with layers as soon as their stages are done."""
        from flowtree.project.reconstruct_project import reconstruct_project
        from flowtree.studio.stage_layers import StageLayers

        layers = StageLayers(self._book, len(project.photos))
        # One thread of its own, so that the next stages need not wait until a picture is packed.
        with ThreadPoolExecutor(1) as painter:
            drawing: list[Future[None]] = []

            def show(stage: str, made: Mapping[str, Any]) -> None:
                drawing.append(painter.submit(self._show, job, layers, stage, dict(made)))

            result = reconstruct_project(
                project,
                progress=lambda stage, share: self._say(job, "progress", (stage, share)),
                cancel=lambda: self._is_stopped(job),
                cache=self._cache,
                made=show,
            )
            for drawn in drawing:
                drawn.result()
        self._draw(job, json_layer("report", result.report))

    def _make_variant(self, job: StudioJob, project: Project) -> None:
        """A picture of another seed's tree; if it is chosen, it is made already."""
        from flowtree.project.reconstruct_project import reconstruct_project
        from flowtree.studio.layers.tree_layers import variant_layer

        seed, (done, asked) = job.options["seed"], job.options["part"]
        result = reconstruct_project(
            replace(project, seed=seed),
            progress=lambda stage, share: self._say(job, "progress", (stage, (done + share) / asked)),
            cancel=lambda: self._is_stopped(job),
            cache=self._cache,
        )
        self._draw(job, variant_layer(seed, result.asset))

    def _write_file(self, job: StudioJob, project: Project) -> None:
        """The tree or its branches in a file, as the command line writes it."""
        from flowtree.export.export_skeleton import export_skeleton
        from flowtree.export.export_tree import check_export, export_tree
        from flowtree.project.reconstruct_project import reconstruct_project

        order = job.options["order"]
        output = order.output
        project = replace(project, params=_with_options(project, order.params))
        if not order.branches:
            check_export(output, project.params.export)
        result = reconstruct_project(
            project,
            progress=lambda stage, share: self._say(job, "progress", (stage, share)),
            cancel=lambda: self._is_stopped(job),
            cache=self._cache,
        )
        output.parent.mkdir(parents=True, exist_ok=True)
        if order.branches:
            export_skeleton(result.skeleton, output)
        else:
            params = project.params
            export_tree(result.asset, output, params=params.export, engine=params.collision.engine)
        self._say(job, "exported")

    def _show(self, job: StudioJob, layers: Any, stage: str, made: dict[str, Any]) -> None:
        for layer in layers.draw(stage, made):
            self._draw(job, layer)

    def _draw(self, job: StudioJob, layer: Layer | None) -> None:
        if layer is not None:
            self._say(job, "layer", layer)

    def _say(self, job: StudioJob, kind: str, content: Any = None) -> None:
        with self._sending:
            self._connection.send(Message(job.number, kind, content))

    def _is_stopped(self, job: StudioJob) -> bool:
        return bool(job.number <= self._stopped.value)


def _with_options(project: Project, options: Mapping[str, Any]) -> Params:
    table = project.params.model_dump()
    for name, value in options.items():
        section, _, key = name.partition(".")
        table.setdefault(section, {})[key] = value
    return params_from_table(table)
