"""The tree itself, and pictures of its siblings."""

from __future__ import annotations

import numpy as np

from flowtree.export.write_glb import encode_glb
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.model.asset import TreeAsset
from flowtree.model.mesh import Material
from flowtree.model.skeleton import Skeleton
from flowtree.model.tree import TreeModel
from flowtree.params import MeshingParams, RenderParams
from flowtree.render.fit_camera import fit_camera
from flowtree.render.render_view import render_view
from flowtree.render.write_picture import encode_picture
from flowtree.studio.layers.layer import GLB, PNG, Layer

_COARSE = MeshingParams(sides=6, tolerance=0.001)
_BROWN = (112, 98, 82)  # sRGB
_SIZE, _YAW = 320, 30.0  # pixels of a variant's picture, and from where it is taken [degrees]


def coarse_layer(branches: Skeleton) -> Layer:
    """Branches without twigs and leaves, of few triangles: what can be shown first."""
    plain = Material("bark", np.full((4, 4, 3), _BROWN, np.uint8))
    height = float(branches.points[:, 1].max())
    wood = sweep_rings(branches, params=_COARSE)
    return Layer("coarse.glb", GLB, encode_glb(TreeModel("tree", height, branches, wood, plain, None)))


def tree_layer(asset: TreeAsset) -> Layer:
    """The finest level, as the file holds it."""
    return Layer("tree.glb", GLB, encode_glb(TreeAsset(asset.levels[:1])))


def variant_layer(seed: int, asset: TreeAsset) -> Layer:
    """A picture of the tree of another seed."""
    tree = asset.levels[0]
    picture = render_view(tree, fit_camera(tree, _YAW, _SIZE), params=RenderParams(size=_SIZE, samples=1))
    return Layer(f"variant/{seed}", PNG, encode_picture(picture, "PNG"))
