"""What the viewer shows, and from where."""

from __future__ import annotations

from nicegui import ui

from flowtree.studio.page.choices import Choice, ChoiceRow, icon_button
from flowtree.studio.page.components import TreeViewer
from flowtree.studio.page.workbench import Workbench

_LAYERS = (
    Choice("photos", "", "Photos", "The photos on their planes"),
    Choice("density", "", "Density", "Voxels: how dense the crown is"),
    Choice("field", "", "Field", "The way down, everywhere in the crown"),
    Choice("flow", "", "Flow", "The particles on their way to the foot (P plays)"),
    Choice("skeleton", "", "Skeleton", "The branches as lines"),
    Choice("wood", "", "Wood", "Trunk, branches, twigs"),
    Choice("leaves", "", "Leaves", "The leaves"),
)


class ViewerTools:
    """A row over the viewer, icons at its side, cameras at its foot."""

    def __init__(self, bench: Workbench, viewer: TreeViewer) -> None:
        self.bench = bench
        self.viewer = viewer
        self.shown = {"wood", "leaves"}
        self.views: list[tuple[int, str]] = []
        self.view: int | None = None
        self._measuring = self._wireframe = False
        viewer.on("view", lambda event: self.show_view(event.args))

    def build_layers(self) -> None:
        """The row of layers."""
        self._layers = ChoiceRow(_LAYERS, self.switch, chosen=self.shown, classes="layers")
        self._by = ChoiceRow(
            (
                Choice("thickness", "line_weight", "", "Colour the skeleton by thickness"),
                Choice("order", "device_hub", "", "Colour the skeleton by order of branching"),
            ),
            self._color_by,
            chosen=("thickness",),
        )
        self._by.hide(True)

    def build_icons(self) -> None:
        """Icons at the side of the viewer."""
        with ui.element("div").classes("floating side"):
            icon_button("center_focus_strong", "Show the whole tree (F)", self.frame)
            self._measure = icon_button("straighten", "Measure: click the tree (M)", self.measure)
            self._wire = icon_button("grid_4x4", "Wireframe (W)", self.wireframe)
            icon_button("photo_camera", "Save a picture of this view", self.screenshot)

    def build_cameras(self) -> None:
        """Cameras at the foot of the viewer."""
        with ui.element("div").classes("floating bottom") as self._cameras:
            self._camera_row = ui.element("div").classes("camera-row")
            with ui.element("div").classes("blend") as self._blend:
                ui.label("Photo")
                blend = ui.slider(min=0, max=1, step=0.02, value=0.5)
                blend.on_value_change(lambda event: self.viewer.run_method("set_blend", event.value))
                blend.props('dense aria-label="How much of the photo lies over the tree"').classes(
                    "size-slider"
                )
        self._blend.set_visibility(False)
        self._row: ChoiceRow | None = None
        self.bench.watch(self._show_views)

    def switch(self, name: str) -> None:
        """Shows or hides a layer."""
        self.shown ^= {name}
        self._layers.show(*self.shown)
        self._by.hide("skeleton" not in self.shown)
        self.viewer.run_method("set_shown", {name: name in self.shown})

    def frame(self) -> None:
        """The whole tree."""
        self.show_view(None)
        self.viewer.run_method("frame")

    def measure(self) -> None:
        """Measuring on or off."""
        self._measuring = not self._measuring
        _mark(self._measure, self._measuring)
        self.viewer.run_method("set_measuring", self._measuring)

    def wireframe(self) -> None:
        """Edges alone, or surfaces."""
        self._wireframe = not self._wireframe
        _mark(self._wire, self._wireframe)
        self.viewer.run_method("set_look", {"wireframe": self._wireframe})

    def screenshot(self) -> None:
        """Saves what the viewer shows."""
        self.viewer.run_method("screenshot", f"{self.bench.state['name']}.png")

    def play(self) -> None:
        """Plays or stops the flow."""
        if "flow" not in self.shown:
            self.switch("flow")
            for name in {"leaves", "wood"} & self.shown:
                self.switch(name)
        self.viewer.run_method("play")

    def escape(self) -> None:
        """Ends measuring and leaves a photo's camera."""
        if self._measuring:
            self.measure()
        elif self.view is not None:
            self.choose_view("free")

    def choose_view(self, name: str) -> None:
        """Another camera: a photo's, or the free one."""
        view = None if name == "free" else int(name)
        self.show_view(view)
        self.viewer.run_method("set_view", view)

    def show_view(self, view: int | None) -> None:
        """Marks the camera that is used."""
        self.view = view
        self._blend.set_visibility(view is not None)
        if self._row is not None:
            self._row.show("free" if view is None else str(view))

    def _show_views(self) -> None:
        photos = self.bench.state["photos"]
        views = [(number, f"{photo['yaw']:g}°") for number, photo in enumerate(photos)]
        self._cameras.set_visibility(bool(photos))
        if views == self.views and self._row is not None:
            return
        self.views = views
        self._camera_row.clear()
        choices = [Choice("free", "3d_rotation", "Free", "Turn, move and zoom freely")]
        choices += [
            Choice(str(number), "", f"Photo {number + 1} · {yaw}", "As this photo's camera saw it")
            for number, yaw in views
        ]
        with self._camera_row:
            self._row = ChoiceRow(choices, self.choose_view)
        self.show_view(self.view)

    def _color_by(self, name: str) -> None:
        self._by.show(name)
        self.viewer.run_method("set_look", {"skeletonBy": name})


def _mark(button: ui.button, on: bool) -> None:
    button.classes(add="chosen" if on else "", remove="" if on else "chosen")
