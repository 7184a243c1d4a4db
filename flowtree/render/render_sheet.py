"""A contact sheet: what came in, what was made of it, and the tree from free sides."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from flowtree import check
from flowtree.geometry.projection import plane_to_pixels
from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.tree import TreeModel
from flowtree.params import RenderParams
from flowtree.render.assemble_scene import assemble_scene
from flowtree.render.fit_camera import fit_camera
from flowtree.render.gather_sky_light import gather_sky_light
from flowtree.render.render_view import render_scene

Picture = NDArray[np.uint8]

_FREE_YAWS = (0.0, 45.0, 90.0)
_GAP, _LABEL = 8, 24  # [pixels] between panels, and above each for its label
_PAPER, _INK = (250, 249, 246), (60, 58, 54)
_HORIZON = np.array([[196, 214, 230], [236, 238, 234]], float)  # a plain sky, from above to below
_PANELS = 5  # of a photo
_ROOM = 0.06  # of the tree's box, left free around it


def render_sheet(
    photos: Sequence[Photo],
    mattes: Sequence[Matte],
    cameras: Sequence[Camera],
    graphs: Sequence[AttractorGraph | None],
    tree: TreeModel,
    *,
    params: RenderParams = RenderParams(),
    device: str | None = None,
) -> Picture:
    """Puts everything worth a look on one sheet.

    A row for each view: the photo, its matte, the attractor graph over the photo, the tree from the same
    camera, and where the two alphas differ (orange: only the photo has tree there; blue: only the model). A
    last row shows the tree at yaw 0, 45 and 90 degrees.

    Args:
        photos: of the views, at the working resolution.
        mattes: of the same size as their photos.
        cameras: of the same views.
        graphs: of the same views; None where there is none.
        tree: the result.
        params: a free view has ``params.size`` pixels a side; five panels of a photo fill the same width.
        device: to render on.

    Returns: (h, w, 3) uint8 sRGB.

    Raises:
        InputError: the lists differ in length, or a matte differs from its photo in size.
    """
    counts = (len(photos), len(mattes), len(cameras), len(graphs))
    check.require(
        len(set(counts)) == 1,
        "sheet",
        "needs a matte, a camera and a graph for each photo",
        counts,
        "pass equally many",
    )
    scene = assemble_scene(tree)
    sky = gather_sky_light(scene)
    rows = []
    for photo, matte, camera, graph in zip(photos, mattes, cameras, graphs, strict=True):
        sizes = (photo.rgb.shape[:2], matte.alpha.shape)
        check.require(sizes[0] == sizes[1], photo.name, "needs a matte of its size", sizes, "make it anew")
        rgb, alpha, near = _crop(photo, matte, camera, params.size)
        drawn = render_scene(scene, sky, near, params=params, device=device)
        rows.append(
            [
                (f"{photo.name}, yaw {camera.yaw:g}", rgb),
                ("matte", np.repeat(np.rint(255 * alpha).astype(np.uint8)[:, :, None], 3, axis=2)),
                ("attractor graph", _draw_graph(rgb, graph, near)),
                ("tree", _over_sky(drawn)),
                (
                    "only photo / only tree",
                    _difference(alpha, drawn[:, :, 3].astype(np.float32) / np.float32(255)),
                ),
            ]
        )
    free = []
    for yaw in _FREE_YAWS:
        drawn = render_scene(scene, sky, fit_camera(tree, yaw, params.size), params=params, device=device)
        free.append((f"yaw {yaw:g}", _over_sky(drawn)))
    return _lay_out([*rows, free])


def _crop(
    photo: Photo, matte: Matte, camera: Camera, most: int
) -> tuple[Picture, NDArray[np.float32], Camera]:
    """The tree's part of photo and matte, scaled to a panel at most ``most`` high, and its camera."""
    rows, columns = (np.flatnonzero((matte.alpha > 0.1).any(axis=axis)) for axis in (1, 0))
    full = matte.alpha.shape
    if not len(rows):
        rows, columns = np.array([0, full[0] - 1]), np.array([0, full[1] - 1])
    room = _ROOM * (rows[-1] - rows[0] + 1)
    top, left = max(0, int(rows[0] - room)), max(0, int(columns[0] - room))
    bottom = min(full[0], int(rows[-1] + room) + 1)
    right = min(full[1], int(columns[-1] + room) + 1)
    panel = (len(_FREE_YAWS) * most - (_PANELS - len(_FREE_YAWS)) * _GAP) / _PANELS
    shrink = max((right - left) / panel, (bottom - top) / most)
    size = max(1, round((right - left) / shrink)), max(1, round((bottom - top) / shrink))
    rgb = cv2.resize(photo.rgb[top:bottom, left:right], size, interpolation=cv2.INTER_AREA)
    alpha = cv2.resize(matte.alpha[top:bottom, left:right], size, interpolation=cv2.INTER_AREA)
    foot = ((camera.foot[0] - left) / shrink, (camera.foot[1] - top) / shrink)
    near = Camera(camera.yaw, camera.metres_per_pixel * shrink, foot, *size)
    return np.asarray(rgb, np.uint8), np.asarray(np.clip(alpha, 0, 1), np.float32), near


def _draw_graph(rgb: Picture, graph: AttractorGraph | None, camera: Camera) -> Picture:
    """The photo, paled, under the graph: thick at the foot, thin at the tips."""
    canvas = np.ascontiguousarray((0.55 * rgb + 0.45 * 255).astype(np.uint8))
    if graph is None:
        return canvas
    at = np.rint(16 * (plane_to_pixels(graph.points, camera) - 0.5)).astype(int)
    tips = np.ones(len(at))
    for node in range(len(at) - 1, 0, -1):
        tips[graph.parent[node]] += tips[node]
    for node in range(1, len(at)):
        wide = 1 + round(2 * (tips[node] / tips[0]) ** 0.5)
        start, end = (tuple(int(n) for n in at[k]) for k in (graph.parent[node], node))
        cv2.line(canvas, start, end, (176, 40, 60), wide, cv2.LINE_AA, shift=4)
    return canvas


def _over_sky(rgba: Picture) -> Picture:
    height, width = rgba.shape[:2]
    share = np.linspace(0, 1, height)[:, None, None]
    sky = np.broadcast_to((1 - share) * _HORIZON[0] + share * _HORIZON[1], (height, width, 3))
    alpha = rgba[:, :, 3:] / 255.0
    return np.asarray(np.rint(rgba[:, :, :3] * alpha + sky * (1 - alpha)), np.uint8)


def _difference(alpha: NDArray[np.float32], drawn: NDArray[np.float32]) -> Picture:
    """Grey where both agree on tree, orange where only the photo has it, blue where only the model has it."""
    both = np.minimum(alpha, drawn)[:, :, None]
    missing, surplus = np.maximum(alpha - drawn, 0)[:, :, None], np.maximum(drawn - alpha, 0)[:, :, None]
    color = 255.0 - both * 130.0 - missing * np.array([15, 120, 225]) - surplus * np.array([215, 130, 20])
    return np.asarray(np.rint(np.clip(color, 0, 255)), np.uint8)


def _lay_out(rows: Sequence[Sequence[tuple[str, Picture]]]) -> Picture:
    """Labelled panels, row under row."""
    width = max(_GAP + sum(panel.shape[1] + _GAP for _, panel in row) for row in rows)
    heights = [max(panel.shape[0] for _, panel in row) + _LABEL + _GAP for row in rows]
    sheet = Image.new("RGB", (width, sum(heights) + _GAP), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(14)
    top = _GAP
    for row, height in zip(rows, heights, strict=True):
        left = _GAP
        for label, panel in row:
            draw.text((left + 2, top + 2), label, fill=_INK, font=font)
            sheet.paste(Image.fromarray(panel), (left, top + _LABEL))
            left += panel.shape[1] + _GAP
        top += height
    return np.asarray(sheet, np.uint8)
