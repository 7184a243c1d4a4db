"""The studio's page: photos at the left, the tree in the middle, its shape at the right."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable
from typing import Any, Literal

from nicegui import Client, ui

from flowtree.studio.page.board_tools import BoardTools
from flowtree.studio.page.components import STATIC, PhotoBoard, TreeViewer
from flowtree.studio.page.export_dialog import ExportDialog
from flowtree.studio.page.growing_card import GrowingCard
from flowtree.studio.page.help_overlay import HelpOverlay
from flowtree.studio.page.photo_strip import PhotoStrip
from flowtree.studio.page.shape_panel import ShapePanel
from flowtree.studio.page.start_screen import StartScreen
from flowtree.studio.page.status_line import StatusLine
from flowtree.studio.page.top_bar import TopBar
from flowtree.studio.page.viewer_tools import ViewerTools
from flowtree.studio.page.workbench import Workbench

_BOARD_LAYERS = ("photo/", "matte/", "cost/", "graph/", "cameras")
_VIEWER_LAYERS = ("cameras", "straight/", "voxels", "field", "flow", "skeleton", "coarse.glb", "tree.glb")
_LOOK = ("page", "controls", "board", "panels", "fields", "over", "narrow")  # later ones count more
Kind = Literal["bad", "info", "good"]
_ICONS = {"bad": "error_outline", "info": "info_outline", "good": "check"}
_GROW = 1.15  # a brush by one press of a bracket


class StudioPage:
    """All parts of the page, and the way of every event to the parts that it concerns."""

    def __init__(self, bench: Workbench, client: Client) -> None:
        self.bench = bench
        self.client = client
        self.loop = asyncio.get_running_loop()
        for part in _LOOK:
            ui.add_css(STATIC / f"{part}.css")
        self.help = HelpOverlay()
        self.export = ExportDialog(bench)
        with ui.element("div").classes("studio"):
            TopBar(bench, on_help=self.help.toggle, on_export=self.export.open)
            with ui.element("section").classes("panel photos"):
                with ui.element("div").classes("board-frame") as frame:
                    self.board = PhotoBoard().classes("fill")
                self.tools = BoardTools(bench, self.board)
                with ui.element("div").classes("panel-head") as head:
                    self.tools.build_modes()
                head.move(target_index=0)
                with ui.element("div") as row:
                    self.tools.build_tools()
                row.move(target_index=1)
                with frame:
                    self.tools.build_views()
                self.strip = PhotoStrip(bench)
            with ui.element("section").classes("panel tree"):
                with ui.element("div").classes("viewer-frame") as frame:
                    self.viewer = TreeViewer().classes("fill")
                self.views = ViewerTools(bench, self.viewer)
                with ui.element("div").classes("panel-head") as head:
                    self.views.build_layers()
                head.move(target_index=0)
                with frame:
                    self.views.build_icons()
                    self.views.build_cameras()
                    growing = GrowingCard(bench)
            self.shape = ShapePanel(bench)
            self.status = StatusLine(bench, growing)
            StartScreen(bench)
        self.viewer.on("shown", lambda event: self.status.size(event.args["height"], event.args["width"]))
        self.viewer.on("shown", growing.grown)
        self.board.on("command", lambda event: bench.send(event.args["command"], event.args["number"]))
        self.board.on("activate", lambda event: bench.choose(photo=int(event.args)))
        self.board.on("pick", lambda event: self.tools.pick(**event.args))
        self.board.on("action", lambda event: self._act(str(event.args)))
        self.board.on("problem", lambda event: self.tell(str(event.args)))
        bench.on_problem(self.tell)
        bench.watch(self._show_state)

    def tell(self, message: str, kind: Kind = "bad") -> None:
        """Says something to the person."""
        with self.client:
            ui.notify(
                message,
                position="bottom-left",
                multi_line=True,
                timeout=9000,
                close_button="Close",
                icon=_ICONS[kind],
                classes=f"note {kind}",
            )

    def begin(self) -> Callable[[], None]:
        """Shows what is there, and listens to the session from now on.

        Returns: what ends the listening.
        """

        def hear(event: dict[str, Any]) -> None:  # in a thread of the session
            with contextlib.suppress(RuntimeError):  # the studio ends, and nobody listens any more
                self.loop.call_soon_threadsafe(self._receive, event)

        stop = self.bench.session.listen(hear)
        for name, revision in self.bench.session.layers().items():
            self._layer({"name": name, "url": f"/layer/{revision}/{name}"})
        if self.bench.state["notice"]:
            self.tell(self.bench.state["notice"], "info")
        if self.bench.state["problem"]:
            self._on_failed({"message": self.bench.state["problem"]})
        return stop

    def _show_state(self) -> None:
        self.board.run_method("set_state", self.bench.state, self.bench.acknowledged)
        self.board.run_method("set_photo", self.bench.photo)

    def _receive(self, event: dict[str, Any]) -> None:
        """An event of the session, now in the page's own loop."""
        if self.client.id not in Client.instances:
            return
        with self.client:
            getattr(self, f"_on_{event['event']}")(event)

    def _on_state(self, event: dict[str, Any]) -> None:
        self.bench.refresh()

    def _on_saved(self, event: dict[str, Any]) -> None:
        self.bench.unsaved = False
        self.bench.refresh()

    def _on_unsaved(self, event: dict[str, Any]) -> None:
        self.bench.unsaved = True
        self.tell(event["message"])
        self.bench.refresh()

    def _on_progress(self, event: dict[str, Any]) -> None:
        self.status.progress(event["job"], event["stage"], event["share"])

    def _on_done(self, event: dict[str, Any]) -> None:
        if not self.bench.session.busy:
            self.status.rest(f"Ready, in {event['seconds']:.1f} s")

    def _on_cancelled(self, event: dict[str, Any]) -> None:
        self.status.stopped("Stopped")
        self.shape.variants.give_up()
        self.export.failed()

    def _on_failed(self, event: dict[str, Any]) -> None:
        self.status.failed("This did not work", event["message"])
        self.shape.variants.give_up()
        self.export.failed()
        self.tell(event["message"])

    def _on_notice(self, event: dict[str, Any]) -> None:
        self.tell(event["message"], "info")

    def _on_exported(self, event: dict[str, Any]) -> None:
        self.export.done(event["url"], event["name"])
        self.tell(f"{event['name']} is written", "good")

    def _on_layer(self, event: dict[str, Any]) -> None:
        self._layer(event)

    def _on_removed(self, event: dict[str, Any]) -> None:
        for component in (self.board, self.viewer):
            component.run_method("remove_layer", event["name"])

    def _layer(self, event: dict[str, Any]) -> None:
        name, url = event["name"], event["url"]
        layer = {key: event[key] for key in ("url", "part", "box") if key in event}
        if name.startswith(_BOARD_LAYERS):
            self.board.run_method("set_layer", name, layer)
        if name.startswith(_VIEWER_LAYERS):
            self.viewer.run_method("set_layer", name, layer)
        if name.startswith("photo/"):
            self.strip.set_picture(name, url)
        elif name.startswith("variant/"):
            self.shape.variants.set_picture(int(name.split("/")[1]), url)
        elif name == "report":
            self._show_report()

    def _show_report(self) -> None:
        layer = self.bench.session.layer("report")
        if layer is None:
            return
        report = json.loads(layer.data)
        self.status.figures(report)
        views = report.get("views", [])[: len(self.bench.state["photos"])]
        likeness = {
            number: view["soft_iou"] for number, view in enumerate(views) if view.get("soft_iou") is not None
        }
        self.strip.set_likeness(likeness)

    def _act(self, action: str) -> None:
        """What a key asked for."""
        word, *rest = action.split()
        bench, session = self.bench, self.bench.session
        actions: dict[str, Callable[[], object]] = {
            "mode": lambda: self.tools.choose_mode(rest[0]),
            "size": lambda: self.tools.grow(_GROW if rest[0] == "up" else 1 / _GROW),
            "nudge": lambda: self.board.run_method("nudge", int(rest[0]), int(rest[1])),
            "view": self.tools.next_show,
            "erase": self.tools.erase,
            "frame": self._frame,
            "help": self.help.toggle,
            "wireframe": self.views.wireframe,
            "measure": self.views.measure,
            "play": self.views.play,
            "escape": self.views.escape,
            "export": self.export.open,
            "run": lambda: bench.call(session.run),
            "undo": lambda: bench.call(session.undo),
            "redo": lambda: bench.call(session.redo),
        }
        actions[word]()

    def _frame(self) -> None:
        self.board.run_method("frame")
        self.views.frame()
