"""Keys, and five sentences on how to make a good tree."""

from __future__ import annotations

from nicegui import ui

_STEPS = (
    (
        "Arrange",
        "Drag and scale the photos until foot and top lie on the lines; turn their cameras on the compass.",
    ),
    ("Matte", "One stroke on the tree or beside it is enough where colours do not tell."),
    ("Branches", "Draw along a branch: the line snaps to it. What is drawn becomes a branch."),
    ("Density", "Paint leaves in or out on any photo; the tree changes there."),
    ("Shape", "Pick a variant, then move the sliders. Everything can be undone."),
)
_KEYS = (
    ("1 2 3 4", "Arrange, matte, branches, density"),
    ("[  ]", "Smaller, larger brush"),
    ("E", "Erase"),
    ("V", "Next way to show the matte"),
    ("Space", "Hold and drag to pan"),
    ("Wheel", "Zoom"),
    ("Arrows", "Nudge the photo"),
    ("F", "Show all of it"),
    ("P", "Play the particle flow"),
    ("M", "Measure"),
    ("W", "Wireframe"),
    ("Ctrl Z, Y", "Undo, redo"),
    ("Ctrl E", "Export"),
    ("Ctrl Enter", "Grow again"),
    ("H", "This help"),
)


class HelpOverlay:
    """A sheet over the page."""

    def __init__(self) -> None:
        with ui.dialog() as self.dialog, ui.element("div").classes("sheet help"):
            ui.label("From two photos to a tree").classes("sheet-title")
            with ui.element("div").classes("help-columns"):
                with ui.element("ol").classes("help-steps"):
                    for title, text in _STEPS:
                        with ui.element("li"):
                            ui.label(title).classes("help-step")
                            ui.label(text)
                with ui.element("div").classes("help-keys"):
                    for keys, text in _KEYS:
                        ui.label(keys).classes("key")
                        ui.label(text)

    def toggle(self) -> None:
        """Shows or hides it."""
        self.dialog.set_value(not self.dialog.value)
