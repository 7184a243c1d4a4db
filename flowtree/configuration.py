"""Reads, overrides and prints the parameters: TOML files and ``NAME=VALUE`` texts."""

from __future__ import annotations

import json
import tomllib
import types
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, NoReturn, Union, get_args, get_origin

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from flowtree import check
from flowtree.params import Params, StageParams

_SEE = "`flowtree params` lists every name and range"
# Pydantic's kinds of error, as the rule they are about; {…} is filled from the error's context.
_RULES = {
    "greater_than_equal": "must be at least {ge:g}",
    "greater_than": "must be more than {gt:g}",
    "less_than_equal": "must be at most {le:g}",
    "less_than": "must be less than {lt:g}",
    "literal_error": "must be {expected}",
    "finite_number": "must be finite",
    "value_error": "{error}",  # in the validator's own words
}
_KINDS = {
    "int": "must be a whole number",
    "float": "must be a number",
    "bool": "must be true or false",
    "string": "must be a text",
    "tuple": "must be a list",
    "model": "must be a table of parameters",
}


def parameter_fields() -> Iterator[tuple[str, str, FieldInfo]]:
    """Section, name and declaration of every parameter, in the order they are declared."""
    for section, stage in Params.model_fields.items():
        for name, field in _stage(stage).model_fields.items():
            yield section, name, field


def load_params(path: str | Path) -> Params:
    """The parameters of a TOML file; what it leaves out has its default.

    Raises:
        InputError: no such file, not TOML, an unknown name or a value that breaks its rule.
    """
    file = Path(path)
    try:
        table = tomllib.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        check.fail(str(file), "must be a file that can be read", error.strerror, "check the path")
    except UnicodeDecodeError:
        check.fail(str(file), "must be a text in UTF-8", "other bytes", "save it as UTF-8")
    except tomllib.TOMLDecodeError as error:
        check.fail(str(file), "must be TOML", str(error), "correct that line")
    return params_from_table(table, source=f"{file}: ")


def params_from_table(table: Mapping[str, Any], *, source: str = "") -> Params:
    """The parameters that a nested mapping holds; ``source`` opens an error's text.

    Raises:
        InputError: an unknown name or a value that breaks its rule.
    """
    try:
        return Params.model_validate(dict(table))
    except ValidationError as problem:
        _fail(problem, source)


def override_params(params: Params, assignments: Iterable[str]) -> Params:
    """The parameters with ``section.name=value`` texts applied in order, values written as in TOML.

    Quotes around a text may be left out, a list may be written ``a,b``, and ``none`` empties a parameter
    that may be empty.

    Raises:
        InputError: not of that form, an unknown name or a value that breaks its rule.
    """
    table = params.model_dump()
    fields = {f"{section}.{name}": field for section, name, field in parameter_fields()}
    for assignment in assignments:
        name, equals, text = assignment.partition("=")
        name = name.strip()
        check.require(
            bool(equals), f"--set {assignment}", "must look like NAME=VALUE", "no =", "write flow.step=0.01"
        )
        if name not in fields:
            check.fail(name, "must be a parameter", "an unknown name", _nearest(name))
        section, key = name.split(".")
        table[section][key] = _value(text.strip(), fields[name])
    return params_from_table(table)


def params_to_toml(params: Params) -> str:
    """A TOML text of all parameters, each under a comment with its meaning, range and unit."""
    lines = ["# flowtree's parameters; what is left out has its default."]
    section = ""
    for name, key, field in parameter_fields():
        if name != section:
            section = name
            stage = _stage(Params.model_fields[name])
            lines += ["", f"# {(stage.__doc__ or name).strip().splitlines()[0]}", f"[{name}]"]
        value = getattr(getattr(params, name), key)
        notes = "; ".join(part for part in (parameter_range(field), parameter_unit(field)) if part)
        lines.append(f"# {field.description}" + (f" ({notes})" if notes else ""))
        lines.append(f"# {key} =" if value is None else f"{key} = {_toml(value)}")
    return "\n".join(lines) + "\n"


def parameter_unit(field: FieldInfo) -> str:
    """The parameter's unit, or nothing."""
    extra = field.json_schema_extra
    return str(extra.get("unit", "")) if isinstance(extra, dict) else ""


def parameter_range(field: FieldInfo) -> str:
    """The parameter's range or choices in words, or nothing."""
    choices = get_args(field.annotation)
    if choices and all(isinstance(choice, str) for choice in choices):
        return " | ".join(choices)
    bounds = {
        kind: getattr(rule, kind)
        for rule in field.metadata
        for kind in ("ge", "gt", "le", "lt")
        if getattr(rule, kind, None) is not None
    }
    low = f">= {bounds['ge']:g}" if "ge" in bounds else f"> {bounds['gt']:g}" if "gt" in bounds else ""
    high = f"<= {bounds['le']:g}" if "le" in bounds else f"< {bounds['lt']:g}" if "lt" in bounds else ""
    return ", ".join(part for part in (low, high) if part)


def _stage(field: FieldInfo) -> type[StageParams]:
    stage = field.annotation
    assert isinstance(stage, type)
    assert issubclass(stage, StageParams)
    return stage


def _value(text: str, field: FieldInfo) -> Any:
    """A command line's text as the value it means."""
    union = get_origin(field.annotation) in (Union, types.UnionType)
    if union and type(None) in get_args(field.annotation) and text.lower() == "none":
        return None
    try:
        value = tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        value = text
    if get_origin(field.annotation) is tuple and isinstance(value, str):
        return [part.strip() for part in value.split(",") if part.strip()]
    return value


def _toml(value: Any) -> str:
    if isinstance(value, str):
        # JSON's strings are TOML's, but for one control character.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return repr(value)


def _fail(problem: ValidationError, source: str) -> NoReturn:
    """Words the first thing that is wrong."""
    error = problem.errors(include_url=False)[0]
    name = ".".join(str(part) for part in error["loc"])
    kind, context = error["type"], error.get("ctx", {})
    if kind == "extra_forbidden":
        check.fail(source + name, "must be a parameter", "an unknown name", _nearest(name))
    rule = _RULES.get(kind, _KINDS.get(kind.split("_")[0], "")).format(**context)
    got = repr(error["input"])
    check.fail(source + name, rule or f"must hold ({error['msg']})", got[:80], _SEE)


def _nearest(name: str) -> str:
    """The remedy for an unknown name: the nearest of all, else those of its section, else sections."""
    sections = list(Params.model_fields)
    names = [f"{section}.{key}" for section, key, _ in parameter_fields()]
    remedy = check.nearest_name(name, names if "." in name else sections)
    if remedy.startswith("did you mean"):
        return remedy
    near = [known for known in names if known.split(".")[0] == name.split(".")[0]]
    return check.nearest_name(name, near or sections)
