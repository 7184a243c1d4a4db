"""The parameters as the page shows them, made from their one declaration."""

from __future__ import annotations

from typing import Any

from flowtree.params import Params

#: Sections in their order, and what a person calls them.
TITLES = {
    "photos": "Photos",
    "align": "Alignment",
    "matting": "Matte",
    "attraction": "Attractor graph",
    "density": "Density",
    "field": "Direction field",
    "flow": "Particle flow",
    "branches": "Branches",
    "thickness": "Thickness",
    "twigs": "Twigs",
    "meshing": "Wood and bark",
    "leaves": "Leaves",
    "asset": "Levels and cards",
    "wind": "Wind",
    "collision": "Solid bodies",
    "export": "File",
}
_PICTURES = ("meshing.bark", "leaves.picture", "twigs.sketch")
_KINDS = {"number": "number", "integer": "whole", "boolean": "flag", "array": "list"}


def param_sections() -> dict[str, list[dict[str, Any]]]:
    """The fields of every stage, by the stage's name.

    Returns: a field is ``{"name": "flow.step", "kind", "description", "unit", "minimum", "maximum",
        "choices", "default", "optional"}``; its kind is number, whole, flag, choice, text, list or picture.
    """
    schema = Params.model_json_schema()
    defaults = Params().model_dump(mode="json")
    return {
        section: [
            _field(f"{section}.{key}", entry, defaults[section][key])
            for key, entry in _stage(schema, section)["properties"].items()
        ]
        for section in TITLES
    }


def _stage(schema: dict[str, Any], section: str) -> dict[str, Any]:
    stage: dict[str, Any] = schema["$defs"][schema["properties"][section]["$ref"].rsplit("/", 1)[-1]]
    return stage


def _field(name: str, schema: dict[str, Any], default: Any) -> dict[str, Any]:
    options = schema.get("anyOf", [schema])
    rules = {**schema, **next(option for option in options if option.get("type") != "null")}
    kind = "picture" if name in _PICTURES else _KINDS.get(rules.get("type", ""), "text")
    return {
        "name": name,
        "kind": "choice" if "enum" in rules else kind,
        "description": schema["description"],
        "unit": schema.get("unit", ""),
        "minimum": rules.get("minimum", rules.get("exclusiveMinimum")),
        "maximum": rules.get("maximum"),
        "choices": rules.get("enum"),
        "default": default,
        "optional": len(options) > 1,
    }
