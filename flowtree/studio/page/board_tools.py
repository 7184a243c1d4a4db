"""The tools of the photo board: what kind of work, which tool, how large."""

from __future__ import annotations

import math

from nicegui import ui

from flowtree.studio.page.choices import Choice, ChoiceRow, quiet_tip
from flowtree.studio.page.components import PhotoBoard
from flowtree.studio.page.entry_field import EntryField
from flowtree.studio.page.swatches import Swatches
from flowtree.studio.page.workbench import Mode, Workbench

_MODES = (
    Choice("arrange", "", "Arrange", "Drag, scale and turn the photos against each other (1)"),
    Choice("matte", "", "Matte", "Say what is tree and what is not (2)"),
    Choice("branches", "", "Branches", "See and draw the branches (3)"),
    Choice("density", "", "Density", "Paint where leaves grow, and where not (4)"),
)
_TOOLS = {
    "matte": (
        Choice("tree", "", "Tree", tip="Scribble where the tree is missing", color="#59c36a"),
        Choice("background", "", "Not tree", tip="Scribble on what is not the tree", color="#f0506e"),
        Choice("unknown", "", "Mixed", tip="Scribble where leaves and sky mix", color="#b9a7e6"),
        Choice("occluder", "", "In front", tip="Scribble on what stands before the tree", color="#4aa3ff"),
        Choice("erase", "sym_o_ink_eraser", "Erase", tip="Take scribbles away (E)"),
        Choice("pick-tree", "colorize", "Tree colour", tip="Click a colour of the tree"),
        Choice(
            "pick-background",
            "format_color_fill",
            "Other colour",
            tip="Click a colour that is not the tree's",
        ),
    ),
    "branches": (
        Choice("pen", "timeline", "Snapping pen", tip="Draw along a branch; the line snaps to it"),
        Choice("free", "edit", "Free pen", tip="Draw a branch freely"),
        Choice("brush", "brush", "Brush", tip="Draw a branch as thick as the brush"),
        Choice("erase", "sym_o_ink_eraser", "Erase", tip="Take drawn branches away (E)"),
        Choice("tips", "scatter_plot", "Tips", tip="Tips of branches: click to set, drag, click to remove"),
        Choice("marks", "place", "Foot, top, fork", tip="Drag the foot, the top and the first fork"),
    ),
    "density": (
        Choice("add", "add", "Leaves", tip="Paint where leaves shall grow", color="#7ddc6f"),
        Choice("erase", "remove", "Thin out", tip="Paint where none shall grow (E)", color="#ff6b57"),
        Choice("direct", "north_east", "Flow", tip="Draw the way branches shall flow", color="#ffd166"),
        Choice("undo", "sym_o_ink_eraser", "Take away", tip="Take painted strokes away again"),
    ),
}
_SIZED = {"tree", "background", "unknown", "occluder", "brush", "add"}
_SHOWS = (
    Choice("photo", "", "Photo", "The photo alone"),
    Choice("overlay", "", "Overlay", "What is not tree lies under colour; so do the holes in the crown"),
    Choice("checker", "", "Cut-out", "The tree alone"),
    Choice("grey", "", "Alpha", "The matte itself"),
    Choice("split", "", "Compare", "Before and after, with a line to drag"),
)
_ARRANGE = "Drag and scale the photos: foot and top of the tree belong on the lines"
_RANGE = 0.05, 25.0  # of the brush's size [% of the photo's height]


class BoardTools:
    """Two rows over the board, and a row within it."""

    def __init__(self, bench: Workbench, board: PhotoBoard) -> None:
        self.bench = bench
        self.board = board
        self.tool: dict[str, str] = {"matte": "tree", "branches": "pen", "density": "add", "arrange": "move"}
        self.size = {"matte": 1.6, "branches": 1.2, "density": 6.0}
        self.shown = {"matte": "overlay", "density": "photo"}

    def build_modes(self) -> None:
        """The row of kinds of work."""
        self._modes = ChoiceRow(_MODES, self.choose_mode, classes="modes")

    def build_tools(self) -> None:
        """The row of tools, of which those of the mode are shown."""
        with ui.element("div").classes("tool-row"):
            self._rows = {
                mode: ChoiceRow(choices, self.choose_tool, classes="tools")
                for mode, choices in _TOOLS.items()
            }
            with ui.element("div").classes("brush-size") as self._brush:
                ui.icon("circle").classes("small-dot")
                self._size = ui.slider(
                    min=0, max=100, value=30, on_change=lambda event: self._resize(event.value)
                )
                self._size.props('dense aria-label="Brush size"').classes("size-slider")
                quiet_tip("Size of the brush ([ and ])")
            with ui.element("div").classes("brush-size") as self._soft:
                ui.icon("blur_on").classes("small-dot")
                self._softness = ui.slider(min=0, max=1, step=0.05, value=0.5, on_change=self.send)
                self._softness.props('dense aria-label="Softness"').classes("size-slider short")
                quiet_tip("Softness of the brush")
            with ui.element("div").classes("brush-size") as self._strong:
                ui.icon("opacity").classes("small-dot")
                self._strength = ui.slider(min=0.05, max=1, step=0.05, value=1, on_change=self.send)
                self._strength.props('dense aria-label="Strength"').classes("size-slider short")
                quiet_tip("Strength of the brush")
            with ui.element("div").classes("arrange-row") as self._arrange:
                self._sides = ChoiceRow(
                    (
                        Choice("side", "view_column", "", "Photos beside each other"),
                        Choice("stacked", "layers", "", "Photos on each other"),
                    ),
                    self._lay,
                    chosen=("side",),
                )
                self._cut = ui.switch("Cut out", on_change=lambda event: self.how(cutout=event.value))
                self._cut.props("dense")
                ui.element("div").classes("space")
                self._yaw = EntryField(self._typed_yaw, "Yaw")
                self._yaw.input.props("suffix=°").classes("field")
                self._height = EntryField(self._typed_height, "Height")
                self._height.input.props("suffix=m").classes("field")
        self.bench.watch(self.show)

    def build_views(self) -> None:
        """The ways to show a matte, and the graph's switch, over the board."""
        self._hint = ui.label().classes("board-hint")
        self._swatches = Swatches(self.bench)
        with ui.element("div").classes("floating bottom"):
            self._shows = ChoiceRow(_SHOWS, self.choose_show, chosen=("overlay",))
            graph = Choice("graph", "account_tree", "Attractor graph", "The branches that were found")
            self._graph = ChoiceRow((graph,), lambda _: self._switch_graph(), chosen=("graph",))
        self._graph_on = True
        self.bench.watch(self._show_views)
        self.bench.watch(self._show_hint)

    def choose_mode(self, mode: str) -> None:
        """Another kind of work."""
        modes: dict[str, Mode] = {
            "arrange": "arrange",
            "matte": "matte",
            "branches": "branches",
            "density": "density",
        }
        self.bench.choose(mode=modes[mode])

    def choose_tool(self, name: str) -> None:
        """Another tool of the mode."""
        self.tool[self.bench.mode] = name
        self.bench.changed()

    def choose_show(self, name: str) -> None:
        """Another way to show the matte."""
        if self.bench.mode in self.shown:
            self.shown[self.bench.mode] = name
            self._show_views()

    def next_show(self) -> None:
        """The way after the one that is shown."""
        names = [choice.name for choice in _SHOWS]
        now = self.shown.get(self.bench.mode)
        if now is not None:
            self.choose_show(names[(names.index(now) + 1) % len(names)])

    def pick(self, name: str, color: str) -> None:
        """A colour picked on the photo, with the tool of that name."""
        self._swatches.pick("tree_colors" if name == "pick-tree" else "background_colors", color)

    def erase(self) -> None:
        """The tool that takes away."""
        if self.bench.mode != "arrange":
            self.choose_tool("erase")

    def grow(self, factor: float) -> None:
        """A larger or smaller brush."""
        if self.bench.mode in self.size:
            least, most = _RANGE
            self.size[self.bench.mode] = min(max(self.size[self.bench.mode] * factor, least), most)
            self.bench.changed()

    def show(self) -> None:
        """Shows the tools of the mode, and sends the tool to the board."""
        mode, name = self.bench.mode, self.tool[self.bench.mode]
        self._modes.show(mode)
        for other, row in self._rows.items():
            row.hide(other != mode)
            row.show(self.tool[other])
        sized = name in _SIZED or (mode, name) == ("density", "erase")
        self._brush.set_visibility(sized)
        for part in (self._soft, self._strong):
            part.set_visibility(mode == "density" and sized)
        if sized:
            self._size.set_value(round(_place(self.size[mode])))
        self._arrange.set_visibility(mode == "arrange" and bool(self.bench.state["photos"]))
        self._show_numbers()
        self.send()

    def send(self) -> None:
        """The tool to the board."""
        mode = self.bench.mode
        self.board.run_method(
            "set_tool",
            {
                "mode": mode,
                "name": self.tool[mode],
                "size": self.size.get(mode, 1.0),
                "softness": self._softness.value,
                "strength": self._strength.value,
            },
        )

    def how(self, **how: object) -> None:
        """How the board shows things."""
        self.board.run_method("set_how", how)

    def _show_views(self) -> None:
        shown = self.shown.get(self.bench.mode)
        self._shows.hide(shown is None or not self.bench.state["photos"])
        if shown is not None:
            self._shows.show(shown)
            self.how(show=shown)
        self._graph.hide(self.bench.mode != "branches")

    def _show_hint(self) -> None:
        """What to do with the tool, for whoever has not used it before."""
        tips = {choice.name: choice.tip for choice in _TOOLS.get(self.bench.mode, ())}
        self._hint.set_text(tips.get(self.tool[self.bench.mode], _ARRANGE).removesuffix(" (E)"))
        self._hint.set_visibility(bool(self.bench.state["photos"]))

    def _switch_graph(self) -> None:
        self._graph_on = not self._graph_on
        self._graph.show(*(("graph",) if self._graph_on else ()))
        self.how(graphShown=self._graph_on)

    def _lay(self, name: str) -> None:
        self._sides.show(name)
        self.how(stacked=name == "stacked")

    def _resize(self, place: float) -> None:
        size = _size(place)
        mode = self.bench.mode
        if mode in self.size and round(_place(self.size[mode])) != round(place):
            self.size[mode] = size
            self.send()

    def _show_numbers(self) -> None:
        state = self.bench.state
        if state["photos"]:
            self._yaw.show(f"{state['photos'][self.bench.photo]['yaw']:g}")
        self._height.show("" if state["height"] is None else f"{state['height']:g}")

    def _typed_yaw(self, text: str) -> None:
        yaw = _number(text)
        if yaw is None:
            self._show_numbers()
        else:
            self.bench.do("SetYaw", photo=self.bench.photo, yaw=yaw)

    def _typed_height(self, text: str) -> None:
        height = _number(text)
        if height is None and text:
            self._show_numbers()
        else:
            self.bench.do("SetHeight", height=height)


def _number(text: str) -> float | None:
    try:
        return float(text.replace(",", "."))
    except ValueError:
        return None


def _size(place: float) -> float:
    least, most = _RANGE
    return float(least * (most / least) ** (place / 100.0))


def _place(size: float) -> float:
    least, most = _RANGE
    return 100.0 * math.log(size / least) / math.log(most / least)
