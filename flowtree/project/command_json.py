"""Commands as JSON and back."""

from __future__ import annotations

from dataclasses import MISSING, Field, fields
from typing import Any, get_args

from flowtree import check
from flowtree.project.commands import AddPhoto, Command, OpenState, SetPicture
from flowtree.project.read_fields import read_fields
from flowtree.project.state_json import state_from_json, state_to_json

_COMMANDS: dict[str, type[Any]] = {kind.__name__: kind for kind in get_args(Command)}
_FILES = tuple(kind.__name__ for kind in (AddPhoto, SetPicture, OpenState))


def command_to_json(command: Command) -> dict[str, Any]:
    """The command's name under ``command`` and its fields; JSON has lists where it has tuples."""
    table: dict[str, Any] = {"command": type(command).__name__}
    if isinstance(command, OpenState):
        return table | {"state": state_to_json(command.state)}
    return table | {field.name: getattr(command, field.name) for field in fields(command)}


def command_from_json(table: Any, *, files: bool = False) -> Command:
    """The command that a JSON object says.

    Args:
        table: ``{"command": "SetYaw", "photo": 0, "yaw": 90}``.
        files: whether it may name a file of the project's folder; what comes from a page may not.

    Raises:
        InputError: an unknown command, a missing or unknown field, a value of another kind.
    """
    held = isinstance(table, dict) and isinstance(table.get("command"), str)
    check.require(held, "command", 'must be an object with a "command"', repr(table)[:60], "name one")
    name, known = table["command"], [kind for kind in _COMMANDS if files or kind not in _FILES]
    if name not in known:
        check.fail("command", "must be a known one", repr(name)[:40], check.nearest_name(name, known))
    if name == OpenState.__name__:
        return OpenState(state_from_json(table.get("state")))
    kind = _COMMANDS[name]
    given = {key: value for key, value in table.items() if key != "command"}
    required = tuple(field.name for field in fields(kind) if not _has_default(field))
    optional = tuple(field.name for field in fields(kind) if _has_default(field))
    values = read_fields(given, name, required=required, optional=optional)
    for field in fields(kind):
        empty = field.name in values and values[field.name] is None
        may_be = "None" in str(field.type) or field.type == "Any"
        check.require(may_be or not empty, f"{name}, {field.name}", "must be given", "null", "send it")
    if kind is AddPhoto:  # whole pixels
        values |= {side: int(values[side]) for side in ("width", "height")}
    command: Command = kind(**values)
    return command


def _has_default(field: Field[Any]) -> bool:
    return field.default is not MISSING
