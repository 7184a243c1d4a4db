"""The ordered table of stages, from photographs to a finished tree.

Sources, one entry a view: ``photo_source`` (a file or a `Photo`), ``matte_source``, ``trimap_source``,
``scribbles_source``, ``strokes_source``, ``paint_source`` (a file, what reading it gives, or None),
``mirrored`` (whether the view is its photo's mirror image), ``yaw`` [degrees], ``height`` [m].
One for all: ``bark_source`` (a picture or None).
"""

from __future__ import annotations

from flowtree.pipeline import steps
from flowtree.pipeline.stage import Stage

STAGES: tuple[Stage, ...] = (
    Stage(
        name="photos",
        run=steps.run_photos,
        inputs=("photo_source", "matte_source"),
        outputs=("raw_photo",),
        params=("photos",),
        each_view=True,
        share=0.2,
    ),
    Stage(
        name="matting",
        run=steps.run_matting,
        inputs=("raw_photo", "trimap_source", "scribbles_source"),
        outputs=("raw_matte",),
        params=("photos", "matting"),
        each_view=True,
        share=2.0,
    ),
    Stage(
        name="painting",
        run=steps.run_painting,
        inputs=("raw_photo", "raw_matte", "paint_source", "strokes_source", "mirrored"),
        outputs=("photos", "mattes", "edits", "strokes"),
        params=("photos",),
        each_view=True,
        share=0.05,
    ),
    Stage(
        name="framing",
        run=steps.run_framing,
        inputs=("mattes", "yaw", "height"),
        outputs=("cameras",),
        each_view=True,
        share=0.05,
    ),
    Stage(
        name="density",
        run=steps.run_density,
        inputs=("mattes", "cameras"),
        outputs=("volume",),
        params=("density",),
        share=1.0,
    ),
    Stage(
        name="attraction",
        run=steps.run_attraction,
        inputs=("photos", "mattes", "cameras", "strokes"),
        outputs=("graphs",),
        params=("attraction",),
        each_view=True,
        seeded=True,
        share=1.0,
    ),
    Stage(
        name="fields",
        run=steps.run_fields,
        inputs=("graphs", "cameras", "edits"),
        outputs=("fields",),
        params=("field",),
        each_view=True,
        share=0.1,
    ),
    Stage(
        name="flow",
        run=steps.run_flow,
        inputs=("volume", "fields"),
        outputs=("traces",),
        params=("flow",),
        seeded=True,
        share=1.0,
    ),
    Stage(
        name="branches",
        run=steps.run_branches,
        inputs=("traces", "mattes", "cameras"),
        outputs=("branches",),
        params=("branches", "thickness"),
        share=0.2,
    ),
    Stage(
        name="twigs",
        run=steps.run_twigs,
        inputs=("branches", "volume", "mattes", "cameras"),
        outputs=("skeleton",),
        params=("twigs",),
        seeded=True,
        share=0.5,
    ),
    Stage(
        name="meshing",
        run=steps.run_meshing,
        inputs=("skeleton",),
        outputs=("wood",),
        params=("meshing",),
        share=0.5,
    ),
    Stage(
        name="bark",
        run=steps.run_bark,
        inputs=("branches", "mattes", "cameras", "bark_source"),
        outputs=("bark",),
        params=("meshing",),
        seeded=True,
        share=0.3,
    ),
    Stage(
        name="foliage",
        run=steps.run_foliage,
        inputs=("skeleton", "volume", "mattes", "cameras"),
        outputs=("foliage",),
        params=("leaves",),
        seeded=True,
        share=0.5,
    ),
    Stage(
        name="assembly",
        run=steps.run_assembly,
        inputs=("skeleton", "wood", "bark", "foliage", "height"),
        outputs=("tree",),
        share=0.01,
    ),
    Stage(
        name="fidelity",
        run=steps.run_fidelity,
        inputs=("tree", "mattes", "cameras"),
        outputs=("soft_ious",),
        share=0.5,
    ),
)
