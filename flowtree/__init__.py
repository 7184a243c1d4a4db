"""flowtree: two loose photographs of a tree in, a 3D tree out (the particle-flow method)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

# Public name -> the module that holds it; loaded when first asked for (PEP 562), so that importing is quick.
_PUBLIC = {
    "AttractorGraph": "flowtree.model.attractor",
    "Camera": "flowtree.model.camera",
    "DensityVolume": "flowtree.model.volume",
    "DirectionField": "flowtree.model.field",
    "FlowTraces": "flowtree.model.traces",
    "FlowtreeError": "flowtree.errors",
    "Foliage": "flowtree.model.foliage",
    "Growth": "flowtree.pipeline.grow_tree",
    "InputError": "flowtree.errors",
    "Matte": "flowtree.model.matte",
    "Params": "flowtree.params",
    "Photo": "flowtree.model.photo",
    "Reconstruction": "flowtree.pipeline.reconstruct",
    "Skeleton": "flowtree.model.skeleton",
    "StageCache": "flowtree.pipeline.cache",
    "TreeAsset": "flowtree.model.asset",
    "TreeMesh": "flowtree.model.mesh",
    "TreeModel": "flowtree.model.tree",
    "ViewMarks": "flowtree.model.marks",
    "equip_tree": "flowtree.pipeline.equip_tree",
    "export_skeleton": "flowtree.export.export_skeleton",
    "export_tree": "flowtree.export.export_tree",
    "grow_tree": "flowtree.pipeline.grow_tree",
    "load_params": "flowtree.configuration",
    "load_project": "flowtree.project.load_project",
    "override_params": "flowtree.configuration",
    "read_skeleton": "flowtree.export.read_skeleton",
    "reconstruct": "flowtree.pipeline.reconstruct",
    "save_project": "flowtree.project.save_project",
}

if TYPE_CHECKING:
    from flowtree.configuration import load_params as load_params
    from flowtree.configuration import override_params as override_params
    from flowtree.errors import FlowtreeError as FlowtreeError
    from flowtree.errors import InputError as InputError
    from flowtree.export.export_skeleton import export_skeleton as export_skeleton
    from flowtree.export.export_tree import export_tree as export_tree
    from flowtree.export.read_skeleton import read_skeleton as read_skeleton
    from flowtree.model.asset import TreeAsset as TreeAsset
    from flowtree.model.attractor import AttractorGraph as AttractorGraph
    from flowtree.model.camera import Camera as Camera
    from flowtree.model.field import DirectionField as DirectionField
    from flowtree.model.foliage import Foliage as Foliage
    from flowtree.model.marks import ViewMarks as ViewMarks
    from flowtree.model.matte import Matte as Matte
    from flowtree.model.mesh import TreeMesh as TreeMesh
    from flowtree.model.photo import Photo as Photo
    from flowtree.model.skeleton import Skeleton as Skeleton
    from flowtree.model.traces import FlowTraces as FlowTraces
    from flowtree.model.tree import TreeModel as TreeModel
    from flowtree.model.volume import DensityVolume as DensityVolume
    from flowtree.params import Params as Params
    from flowtree.pipeline.cache import StageCache as StageCache
    from flowtree.pipeline.equip_tree import equip_tree as equip_tree
    from flowtree.pipeline.grow_tree import Growth as Growth
    from flowtree.pipeline.grow_tree import grow_tree as grow_tree
    from flowtree.pipeline.reconstruct import Reconstruction as Reconstruction
    from flowtree.pipeline.reconstruct import reconstruct as reconstruct
    from flowtree.project.load_project import load_project as load_project
    from flowtree.project.save_project import save_project as save_project

__all__ = sorted(_PUBLIC)


def __getattr__(name: str) -> Any:
    """Loads a public name when it is first asked for."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'flowtree' has no attribute {name!r}")
    from importlib import import_module

    value = getattr(import_module(_PUBLIC[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """The public names, loaded or not."""
    return sorted({*globals(), *_PUBLIC})
