"""Which layers follow from which stage."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from flowtree.attraction.livewire_cost import livewire_cost
from flowtree.pipeline.digest import digest
from flowtree.studio.layer_book import LayerBook
from flowtree.studio.layers.layer import Layer
from flowtree.studio.layers.photo_layers import cost_layer, straight_layer
from flowtree.studio.layers.space_layers import field_layer, flow_layer, skeleton_layer, voxels_layer
from flowtree.studio.layers.tree_layers import coarse_layer, tree_layer
from flowtree.studio.layers.view_layers import cameras_layer, graph_layer


class StageLayers:
    """Gathers what the stages of one run made, and turns it into layers as soon as it can be shown.

    Args:
        book: of what was sent in earlier runs.
        photos: how many there are; further views are mirror images.
    """

    def __init__(self, book: LayerBook, photos: int) -> None:
        self._book, self._photos = book, photos
        self._values: dict[str, Any] = {}

    def draw(self, stage: str, made: dict[str, Any]) -> Iterator[Layer]:
        """The layers that can be drawn once a stage is done, without those that are as before."""
        self._values |= made
        for layer in self._draw(stage):
            if layer is not None:
                yield layer

    def _draw(self, stage: str) -> Iterator[Layer | None]:
        draw, values = self._book.draw, self._values
        if stage == "framing":
            photos, placements = values["raw_photo"], values["placements"]
            mirrored = [view >= self._photos for view in range(len(photos))]
            make = partial(cameras_layer, photos, placements, mirrored)
            yield draw("cameras", (*photos, digest(placements), self._photos), make)
            for k, photo in enumerate(values["photos"]):
                yield draw(f"straight/{k}", (photo,), partial(straight_layer, k, photo.rgb))
        elif stage == "density":
            yield draw("voxels", (values["volume"],), partial(voxels_layer, values["volume"]))
        elif stage == "attraction":
            views = zip(values["graphs"], values["raw_photo"], values["placements"], strict=True)
            for k, (graph, photo, placement) in enumerate(views):
                if k < self._photos:
                    make = partial(graph_layer, k, graph, photo, placement)
                    yield draw(f"graph/{k}", (graph, photo, digest(placement)), make)
        elif stage == "limb_field":
            yield draw("field", (values["limb_field"],), partial(field_layer, values["limb_field"]))
        elif stage == "flow":
            yield draw("flow", (values["traces"],), partial(flow_layer, values["traces"]))
        elif stage == "branches":
            branches = values["branches"]
            coarse = draw("coarse.glb", (branches,), partial(coarse_layer, branches))
            if coarse is not None:  # else the twigs that are shown belong to these branches
                yield draw("skeleton", (branches,), partial(skeleton_layer, branches))
            yield coarse
        elif stage == "patching":
            yield draw("skeleton", (values["skeleton"],), partial(skeleton_layer, values["skeleton"]))
        elif stage == "equipping":
            yield draw("tree.glb", (values["asset"],), partial(tree_layer, values["asset"]))
            for k in range(self._photos):  # nobody waits for it
                photo, matte = values["raw_photo"][k], values["raw_matte"][k]
                yield draw(f"cost/{k}", (photo, matte), partial(_cost, k, photo, matte))


def _cost(number: int, photo: Any, matte: Any) -> Layer:
    return cost_layer(number, livewire_cost(photo, matte))
