"""Materials and their pictures in a GLB."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flowtree.device import side_by_side
from flowtree.export.encode_texture import encode_texture
from flowtree.export.glb_builder import GlbBuilder
from flowtree.model.mesh import Material

_LINEAR, _LINEAR_MIPMAP_LINEAR, _CLAMP, _REPEAT = 9729, 9987, 33071, 10497


class GlbMaterials:
    """Adds materials to a file; what two of them share is written once.

    All pictures are packed at the beginning, side by side: that takes half of the time.
    """

    def __init__(self, builder: GlbBuilder, materials: Iterable[Material]) -> None:
        self._builder = builder
        # By identity: levels of one tree share their pictures. The pictures live as long as this does.
        self._pictures = {
            (id(pixels), masked): (pixels, masked) for each in materials for pixels, masked in _pictures(each)
        }
        packed = side_by_side(_pack, self._pictures.values())
        self._packed = dict(zip(self._pictures, packed, strict=True))
        self._images: dict[bytes, int] = {}

    def add(self, material: Material, factor: NDArray[np.float64]) -> int:
        """A material whose colour is multiplied by the factor (3,), linear; returns its index."""
        masked = material.alpha_cutoff is not None
        # A cut-out picture is used once, edge to edge: repeating it would let the far edge shine through.
        wrap = _CLAMP if masked and not material.repeats else _REPEAT
        smaller = _LINEAR_MIPMAP_LINEAR if material.mipmaps else _LINEAR
        color = self._texture(material.base_color, material.name, wrap, smaller, masked)
        surface = {
            "baseColorTexture": {"index": color},
            "baseColorFactor": [*factor.tolist(), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": float(material.roughness),
        }
        entry: dict[str, Any] = {"name": material.name, "pbrMetallicRoughness": surface}
        if material.normal is not None:
            name = f"{material.name}_normal"
            index = self._texture(material.normal, name, wrap, _LINEAR_MIPMAP_LINEAR, masked=False)
            entry["normalTexture"] = {"index": index}
        if masked:
            entry |= {"alphaMode": "MASK", "alphaCutoff": material.alpha_cutoff}
        if material.double_sided:
            entry["doubleSided"] = True
        if material.translucency > 0.0:
            self._builder.use("KHR_materials_diffuse_transmission")
            through = {
                "diffuseTransmissionFactor": float(material.translucency),
                # Light that comes through has the leaf's own colour, as far as one factor can say it.
                "diffuseTransmissionColorFactor": factor.tolist(),
            }
            entry["extensions"] = {"KHR_materials_diffuse_transmission": through}
        return self._builder.share("materials", entry)

    def _texture(self, pixels: NDArray[np.uint8], name: str, wrap: int, smaller: int, masked: bool) -> int:
        data, media = self._packed[id(pixels), masked]
        if data not in self._images:
            image = {"name": name, "mimeType": media, "bufferView": self._builder.view(data)}
            self._images[data] = self._builder.add("images", image)
        sampler = {"magFilter": _LINEAR, "minFilter": smaller, "wrapS": wrap, "wrapT": wrap}
        entry = {"sampler": self._builder.share("samplers", sampler), "source": self._images[data]}
        return self._builder.share("textures", entry)


def _pictures(material: Material) -> list[tuple[NDArray[np.uint8], bool]]:
    """A material's pictures, and of each whether its alpha counts: the colours, then the normals."""
    colors = (material.base_color, material.alpha_cutoff is not None)
    return [colors] if material.normal is None else [colors, (material.normal, False)]


def _pack(picture: tuple[NDArray[np.uint8], bool]) -> tuple[bytes, str]:
    pixels, masked = picture
    return encode_texture(pixels if masked else pixels[:, :, :3], lossy=not masked)
