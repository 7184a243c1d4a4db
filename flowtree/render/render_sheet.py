"""A contact sheet: what came in, what was made of it, and the tree from where nobody stood."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.device import side_by_side
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.tree import TreeModel
from flowtree.params import RenderParams
from flowtree.render.assemble_scene import assemble_scene
from flowtree.render.draw_panels import crop_view, draw_difference, draw_graph, draw_matte, lay_over_sky
from flowtree.render.fit_camera import fit_camera
from flowtree.render.gather_sky_light import gather_sky_light
from flowtree.render.lay_out_sheet import GAP, lay_out_sheet
from flowtree.render.render_view import render_scene

_PANELS = 5  # of a photo
_FREE_YAW = 45.0
# All in parts of ``params.size``, of which the default is 768: the sheet is then 1600 pixels wide.
_WIDTH = 1600 / 768
_HIGHEST = 0.6  # of a photo's panels
_FREE = 0.75  # of the free view


def render_sheet(
    photos: Sequence[Photo],
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    graphs: Sequence[AttractorGraph | None],
    tree: TreeModel,
    *,
    scores: Sequence[float] | None = None,
    params: RenderParams = RenderParams(),
    device: str | None = None,
) -> NDArray[np.uint8]:
    """Puts everything worth a look on one sheet.

    A row for each view: the photo, its matte (blue where it says nothing), the attractor graph over the
    photo, the tree from the same camera, and where the two alphas differ (orange: only the photo has tree
    there; blue: only the model). A last, larger picture shows the tree from 45 degrees.

    Args:
        photos: of the views, at the working resolution.
        mattes: of the same size as their photos.
        cameras: of the same views.
        graphs: of the same views; None where there is none.
        tree: the result.
        scores: soft IoU with each view's matte, written beside the differences.
        params: the sheet is 25/12 of ``params.size`` wide, the free view 3/4 of it.
        device: to render on.

    Returns: (h, w, 3) uint8 sRGB.

    Raises:
        InputError: the lists differ in length, or a matte differs from its photo in size.
    """
    counts = (len(photos), len(mattes), len(cameras), len(graphs))
    check.require(
        len(set(counts)) == 1 and (scores is None or len(scores) == len(photos)),
        "sheet",
        "needs a matte, a camera and a graph for each photo",
        counts,
        "pass equally many",
    )
    width = round(_WIDTH * params.size)
    slot = max(1, (width - (_PANELS + 1) * GAP) // _PANELS)
    highest = max(1, round(_HIGHEST * params.size))
    scene = assemble_scene(tree)
    sky = gather_sky_light(scene)
    crops = []
    for photo, matte, camera in zip(photos, mattes, cameras, strict=True):
        sizes = (photo.rgb.shape[:2], matte.alpha.shape)
        check.require(sizes[0] == sizes[1], photo.name, "needs a matte of its size", sizes, "make it anew")
        crops.append(crop_view(photo, matte, camera, width=slot, height=highest))
    free = fit_camera(tree, _FREE_YAW, max(1, round(_FREE * params.size)))

    def draw(camera: Camera) -> NDArray[np.uint8]:
        return render_scene(scene, sky, camera, params=params, device=device)

    # The largest picture first, so that it is not waited for alone.
    around, *drawn = side_by_side(draw, [free, *(crop[0] for crop in crops)])
    rows = []
    for view, (photo, matte, camera, graph) in enumerate(zip(photos, mattes, cameras, graphs, strict=True)):
        near, rgb, alpha, unknown = crops[view]
        alike = "" if scores is None else f", soft IoU {scores[view]:.2f}"
        rows.append(
            [
                (f"{photo.name}, yaw {camera.yaw:g}", rgb),
                (f"matte, {matte.method}", draw_matte(alpha, unknown)),
                ("attractor graph", draw_graph(rgb, graph, near)),
                (f"tree{alike}", lay_over_sky(drawn[view])),
                ("orange only photo, blue only tree", draw_difference(alpha, drawn[view][:, :, 3], unknown)),
            ]
        )
    rows.append([(f"tree, yaw {_FREE_YAW:g}", lay_over_sky(around))])
    return lay_out_sheet(rows, width=width, slot=slot)
