"""What a command is called where it can be undone."""

from __future__ import annotations

from flowtree.project.commands import Command

_NAMES = {
    "AddPhoto": "Add photo",
    "RemovePhoto": "Remove photo",
    "SetYaw": "Turn photo",
    "PlacePhoto": "Arrange photo",
    "SetMark": "Set {name} of photo",
    "SetSeeds": "Set seeds of photo",
    "AddScribble": "Scribble on photo",
    "RemoveScribbles": "Erase scribbles of photo",
    "SetColors": "Pick colours on photo",
    "AddStroke": "Draw branch on photo",
    "ReplaceStroke": "Change branch of photo",
    "RemoveStrokes": "Erase branches of photo",
    "AddPaint": "Paint on photo",
    "RemovePaint": "Erase paint of photo",
    "RemoveAttached": "Remove {kind} of photo",
    "SetHeight": "Set height",
    "SetSeed": "Choose seed",
    "SetParam": "Set {name}",
    "SetPicture": "Choose picture for {name}",
    "ResetParams": "Reset parameters",
    "OpenState": "Open project",
}


def name_command(command: Command) -> str:
    """A few words, with the photo's number counted from 1 as people do."""
    words = _NAMES[type(command).__name__].format(
        name=getattr(command, "name", ""), kind=getattr(command, "kind", "")
    )
    number = getattr(command, "photo", None)
    return words if number is None else f"{words} {number + 1}"
