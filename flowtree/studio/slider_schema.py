"""The parameters as a page offers them, from their one declaration."""

from __future__ import annotations

from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from flowtree.configuration import parameter_fields, parameter_unit
from flowtree.params import Params, StageParams

_TITLES = {
    "photos": "Photos",
    "align": "Alignment",
    "matting": "Matte",
    "attraction": "Attractor graph",
    "density": "Density",
    "field": "Direction field",
    "flow": "Particles",
    "branches": "Branches",
    "thickness": "Thickness",
    "twigs": "Twigs",
    "meshing": "Wood and bark",
    "leaves": "Leaves",
    "asset": "Levels and cards",
    "wind": "Wind",
    "collision": "Solid bodies",
    "export": "File",
    "render": "Pictures",
}
#: What a person reaches for first, in this order.
_IMPORTANT = (
    "leaves.amount",
    "leaves.size",
    "leaves.shape",
    "leaves.bear",
    "attraction.habit",
    "thickness.trunk_radius",
    "twigs.length",
    "twigs.frequency",
    "meshing.bark_style",
    "flow.particle_count",
)


def slider_schema() -> dict[str, Any]:
    """Sections in the order of the stages, each with its fields.

    Returns: ``{"important": ["leaves.amount", …], "sections": [{"name", "title", "description", "fields":
        [{"name", "description", "unit", "kind", "default", "optional", "minimum", "maximum", "choices",
        "important"}, …]}, …]}``; a kind is number, whole, flag, choice, text, list or picture.
    """
    sections: dict[str, dict[str, Any]] = {}
    for section, name, field in parameter_fields():
        stage = Params.model_fields[section].annotation
        about = (stage.__doc__ or "").strip().splitlines()[0] if stage is not None else ""
        title = _TITLES.get(section, section.capitalize())
        entry = sections.setdefault(
            section, {"name": section, "title": title, "description": about, "fields": []}
        )
        entry["fields"].append(_field(section, name, field))
    return {"important": list(_IMPORTANT), "sections": list(sections.values())}


def _field(section: str, name: str, field: FieldInfo) -> dict[str, Any]:
    full = f"{section}.{name}"
    choices, kind, optional = _kind(full, field)
    bounds = {
        rule: getattr(entry, rule)
        for entry in field.metadata
        for rule in ("ge", "gt", "le", "lt")
        if getattr(entry, rule, None) is not None
    }
    default = field.default.model_dump() if isinstance(field.default, StageParams) else field.default
    return {
        "name": full,
        "description": field.description,
        "unit": parameter_unit(field),
        "kind": kind,
        "default": list(default) if isinstance(default, tuple) else default,
        "optional": optional,
        "minimum": bounds.get("ge", bounds.get("gt")),
        "maximum": bounds.get("le", bounds.get("lt")),
        "choices": choices,
        "important": full in _IMPORTANT,
    }


def _kind(full: str, field: FieldInfo) -> tuple[list[str] | None, str, bool]:
    if full in ("meshing.bark", "leaves.picture", "twigs.sketch"):
        return None, "picture", True
    annotation: Any = field.annotation
    optional = get_origin(annotation) in (Union, UnionType) and NoneType in get_args(annotation)
    if optional:
        annotation = next(kind for kind in get_args(annotation) if kind is not NoneType)
    if get_origin(annotation) is Literal:
        return list(get_args(annotation)), "choice", optional
    if get_origin(annotation) is tuple:
        return None, "list", optional
    kinds = {bool: "flag", int: "whole", float: "number"}
    return None, kinds.get(annotation, "text"), optional
