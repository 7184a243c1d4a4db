"""The ordered table of stages, from photographs to a finished tree.

Sources, one entry a view: ``photo_source`` (a file or a `Photo`), ``matte_source``, ``trimap_source``,
``scribbles_source``, ``strokes_source``, ``marks_source``, ``paint_source`` (a file, what reading it gives,
or None), ``mirrored`` (whether the view is its photo's mirror image), ``yaw`` [degrees], ``height`` [m].
One for all: ``bark_source`` and ``leaf_source`` (a picture or None), ``twig_source`` (a drawing or None).
``plain_skeleton`` and ``plain_foliage``, of the tree that nobody painted on, are None; where somebody paints
they are no sources (see `stand_beside_plain`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from flowtree.pipeline import photo_steps
from flowtree.pipeline.import_alone import import_alone
from flowtree.pipeline.stage import Job, Stage


def load_steps() -> None:
    """Imports what the stages behind the mattes need; a stage that begins meanwhile waits for it."""
    import_alone("flowtree.pipeline.steps")


def _late(name: str) -> Callable[..., Any]:
    """A function of `flowtree.pipeline.steps`, looked up when it is called."""

    def run(job: Job, *inputs: Any) -> Any:
        return getattr(import_alone("flowtree.pipeline.steps"), name)(job, *inputs)

    return run


STAGES: tuple[Stage, ...] = (
    Stage(
        name="photos",
        run=photo_steps.run_photos,
        inputs=("photo_source", "matte_source"),
        outputs=("raw_photo",),
        params=("photos",),
        each_view=True,
        share=0.1,
    ),
    Stage(
        name="strokes",
        run=photo_steps.run_strokes,
        inputs=("raw_photo", "strokes_source", "mirrored"),
        outputs=("raw_strokes",),
        each_view=True,
        by_content=True,
        share=0.01,
    ),
    Stage(
        name="marks",
        run=photo_steps.run_marks,
        inputs=("raw_photo", "marks_source", "mirrored"),
        outputs=("raw_marks",),
        each_view=True,
        by_content=True,
        share=0.01,
    ),
    Stage(
        name="picks",
        run=photo_steps.run_picks,
        inputs=("scribbles_source",),
        outputs=("picks",),
        each_view=True,
        by_content=True,
        share=0.01,
    ),
    Stage(
        name="preparing",  # apart from matting: no scribble changes it
        run=photo_steps.run_preparing,
        inputs=("raw_photo", "trimap_source", "picks"),
        outputs=("prepared_photo",),
        params=("matting",),
        each_view=True,
        share=1.5,
    ),
    Stage(
        name="matting",
        run=photo_steps.run_matting,
        inputs=("raw_photo", "prepared_photo", "trimap_source", "scribbles_source", "picks"),
        outputs=("raw_cut",),
        params=("photos", "matting"),
        each_view=True,
        share=1.6,
    ),
    Stage(
        name="coloring",
        run=photo_steps.run_coloring,
        inputs=("raw_photo", "raw_cut"),
        outputs=("raw_matte",),
        each_view=True,
        by_content=True,
        share=0.4,
    ),
    Stage(
        name="painting",
        run=photo_steps.run_painting,
        inputs=("raw_photo", "raw_matte", "paint_source", "mirrored"),
        outputs=("turned_photo", "turned_matte", "raw_edit"),
        params=("photos",),
        each_view=True,
        by_content=True,
        share=0.02,
    ),
    Stage(
        name="placing",
        run=_late("run_placing"),
        inputs=("turned_photo", "turned_matte", "raw_marks", "yaw", "height"),
        outputs=("rough_placements",),
        params=("align",),
        splits=True,
        share=0.1,
    ),
    Stage(
        name="registering",
        run=_late("run_registering"),
        inputs=("turned_matte", "rough_placements", "height"),
        outputs=("placements",),
        splits=True,
        kernels=("fit_sights",),
        share=0.6,
    ),
    Stage(
        name="framing",
        run=_late("run_framing"),
        inputs=("turned_photo", "turned_matte", "raw_edit", "placements"),
        outputs=("photos", "straight_mattes", "edits", "cameras"),
        each_view=True,
        by_content=True,
        share=0.05,
    ),
    Stage(
        name="lines",
        run=_late("run_lines"),
        inputs=("raw_strokes", "raw_marks", "placements"),
        outputs=("strokes", "marks"),
        each_view=True,
        by_content=True,
        share=0.01,
    ),
    Stage(
        name="completing",
        run=_late("run_completing"),
        inputs=("straight_mattes", "placements"),
        outputs=("bare_mattes",),
        splits=True,
        share=0.02,
    ),
    Stage(
        name="retouching",
        run=_late("run_retouching"),
        inputs=("bare_mattes", "edits"),
        outputs=("mattes",),
        each_view=True,
        share=0.01,
    ),
    Stage(
        name="density",
        run=_late("run_density"),
        inputs=("photos", "mattes", "bare_mattes", "cameras", "placements", "height"),
        outputs=("volume",),
        params=("density",),
        kernels=("fit_depths", "fit_sights"),
        share=0.1,
    ),
    Stage(
        name="between",
        run=_late("run_between"),
        inputs=("volume", "cameras", "placements"),
        outputs=("between",),
        share=0.02,
    ),
    Stage(
        name="leafiness",
        run=_late("run_leafiness"),
        inputs=("bare_mattes", "cameras"),
        outputs=("leafy",),
        params=("leaves",),
        by_content=True,
        share=0.02,
    ),
    Stage(
        name="habit",
        run=_late("run_habit"),
        inputs=("bare_mattes", "cameras", "leafy"),
        outputs=("habit",),
        params=("attraction",),
        by_content=True,
        share=0.02,
    ),
    Stage(
        name="attraction",
        run=_late("run_attraction"),
        inputs=("photos", "mattes", "cameras", "strokes", "marks", "leafy", "habit"),
        outputs=("graphs",),
        params=("attraction",),
        each_view=True,
        seeded=True,
        share=0.6,
    ),
    Stage(
        name="leaf",
        run=_late("run_leaf"),
        inputs=("bare_mattes", "cameras", "leafy", "leaf_source"),
        outputs=("leaf",),
        params=("leaves",),
        seeded=True,
        share=0.05,
    ),
    Stage(
        name="limbs",
        run=_late("run_limbs"),
        inputs=("graphs", "cameras", "volume", "edits"),
        outputs=("limbs",),
        share=0.2,
    ),
    Stage(
        name="fields",
        run=_late("run_fields"),
        inputs=("graphs", "cameras", "edits"),
        outputs=("fields",),
        params=("field",),
        each_view=True,
        kernels=("nearest_segment",),
        share=0.05,
    ),
    Stage(
        name="limb_field",
        run=_late("run_limb_field"),
        inputs=("limbs", "volume", "cameras", "edits", "habit"),
        outputs=("limb_field",),
        params=("field",),
        share=0.1,
    ),
    Stage(
        name="flow",
        run=_late("run_flow"),
        inputs=("volume", "fields", "limb_field"),
        outputs=("traces",),
        params=("flow",),
        seeded=True,
        kernels=("time_flow", "run_flow"),  # on CUDA also those of `flow_in_launches`, where it runs
        share=0.3,
    ),
    Stage(
        name="branches",
        run=_late("run_branches"),
        inputs=("traces", "limbs", "mattes", "bare_mattes", "cameras", "edits", "leafy", "between"),
        outputs=("branches",),
        params=("branches", "thickness"),
        share=0.1,
    ),
    Stage(
        name="colors",  # behind the flow's stages, beside which a core has nothing else to do
        run=_late("run_colors"),
        inputs=("mattes", "cameras", "leafy"),
        outputs=("colors",),
        each_view=True,
        share=0.1,
    ),
    Stage(
        name="sketch",
        run=photo_steps.run_sketch,
        inputs=("twig_source",),
        outputs=("sketched_twig",),
        params=("twigs",),
        seeded=True,
        share=0.01,
    ),
    Stage(
        name="twigs",
        run=_late("run_twigs"),
        inputs=(
            "branches",
            "volume",
            "mattes",
            "cameras",
            "between",
            "edits",
            "leafy",
            "sketched_twig",
            "height",
        ),
        outputs=("painted_skeleton",),
        params=("twigs",),
        seeded=True,
        kernels=("choose_cover",),
        share=0.2,
    ),
    Stage(
        name="patching",
        run=_late("run_patching"),
        inputs=("painted_skeleton", "plain_skeleton", "cameras", "edits", "height"),
        outputs=("skeleton", "patch"),
        share=0.01,
    ),
    Stage(
        name="meshing",
        run=_late("run_meshing"),
        inputs=("skeleton",),
        outputs=("wood",),
        params=("meshing",),
        kernels=("sweep_rings",),
        share=0.2,
    ),
    Stage(
        name="bark",
        run=_late("run_bark"),
        inputs=(
            "branches",
            "mattes",
            "cameras",
            "habit",
            "bark_source",
            "photo_source",
            "raw_photo",
            "placements",
            "mirrored",
        ),
        outputs=("bark",),
        params=("meshing", "photos"),
        seeded=True,
        share=0.2,
    ),
    Stage(
        name="foliage",
        run=_late("run_foliage"),
        inputs=("painted_skeleton", "volume", "mattes", "cameras", "between", "leaf", "colors", "height"),
        outputs=("painted_foliage",),
        params=("leaves",),
        seeded=True,
        kernels=("choose_cover",),
        share=0.4,
    ),
    Stage(
        name="leaf_patching",
        run=_late("run_leaf_patching"),
        inputs=("painted_foliage", "plain_foliage", "patch", "cameras", "edits"),
        outputs=("foliage",),
        share=0.01,
    ),
    Stage(
        name="assembly",
        run=_late("run_assembly"),
        inputs=("skeleton", "wood", "bark", "foliage", "height"),
        outputs=("tree",),
        share=0.01,
    ),
    Stage(
        name="closing",
        run=_late("run_closing"),
        inputs=("wood",),
        outputs=("watertight",),
        share=0.05,
    ),
    Stage(
        name="equipping",
        run=_late("run_equipping"),
        inputs=("tree",),
        outputs=("asset",),
        params=("meshing", "asset", "wind", "collision"),
        seeded=True,
        kernels=("sweep_rings",),
        share=0.3,
    ),
    Stage(
        name="fidelity",
        run=_late("run_fidelity"),
        inputs=("asset", "mattes", "cameras"),
        outputs=("soft_ious",),
        each_view=True,
        kernels=("cast_rays",),
        share=0.5,
    ),
)
