"""The line at the bottom: what is being done, how far it is, what the tree is like."""

from __future__ import annotations

from typing import Any

from nicegui import ui

from flowtree.studio.page.growing_card import GrowingCard
from flowtree.studio.page.stage_words import stage_words
from flowtree.studio.page.workbench import Workbench

_JOBS = {
    "matte": "Cutting out",
    "tree": "Growing the tree",
    "variants": "Growing variants",
    "export": "Writing the file",
}
_CUT = 0.3  # share of the matte's work before a tree's


class StatusLine:
    """Progress at the left, figures at the right."""

    def __init__(self, bench: Workbench, growing: GrowingCard) -> None:
        self.bench = bench
        self.growing = growing
        self._cut = 0.0
        self._size = ""
        self._report: dict[str, Any] = {}
        with ui.element("footer").classes("status"):
            self._dot = ui.element("span").classes("state-dot")
            self._text = ui.label().classes("status-text").mark("status")
            with ui.element("div").classes("progress") as self._bar:
                self._share = ui.element("div").classes("progress-share")
            self._cancel = ui.button("Stop", on_click=lambda: bench.call(bench.session.cancel), color=None)
            self._cancel.props("flat dense no-caps").classes("quiet").mark("cancel")
            self._again = ui.button("Grow", on_click=lambda: bench.call(bench.session.run), color=None)
            self._again.props("flat dense no-caps").classes("quiet").mark("run")
            ui.element("div").classes("space")
            self._figures = ui.label().classes("figures").mark("figures")
        self._busy = False
        self.rest("Ready")
        bench.watch(self.show)

    def show(self) -> None:
        """Whether something runs, also before anything is heard of it: it can be stopped from the first."""
        busy = self.bench.state["busy"] and not self.bench.state["problem"]
        if busy == self._busy:
            return
        if self._busy:
            self.rest("Ready")
        else:
            self._text.set_text("Working")
            self._share.style("width:0%")
            self._state("busy")

    def progress(self, job: str, stage: str, share: float) -> None:
        """What is done now, and how much of it is behind."""
        words = f"{_JOBS[job]}: {stage_words(stage)}" if stage else _JOBS[job]
        if job == "matte":
            self._cut = _CUT
            share *= _CUT
        elif job == "tree":
            share = self._cut + (1.0 - self._cut) * share
        self._text.set_text(words)
        self._share.style(f"width:{100 * share:.0f}%")
        self._state("busy")
        if job in ("matte", "tree"):
            self.growing.progress(words, share)

    def rest(self, text: str) -> None:
        """Nothing is done now."""
        self._text.set_text(text)
        self._state("rest")

    def stopped(self, text: str) -> None:
        """It was stopped; it can be begun again."""
        self._text.set_text(text)
        self._state("stopped")

    def failed(self, text: str, message: str) -> None:
        """It went wrong, and why."""
        self._text.set_text(text)
        self._state("failed")
        self.growing.failed(message)

    def size(self, height: float, width: float) -> None:
        """How large the tree is [m], as it is seen."""
        self._size = f"{height:.1f} m high, {width:.1f} m wide"
        self._show_figures()

    def figures(self, report: dict[str, Any]) -> None:
        """Figures of the tree, from its report."""
        self._report = report
        self._show_figures()

    def _show_figures(self) -> None:
        report = self._report
        skeleton = report.get("skeleton", {})
        alike = [view["soft_iou"] for view in report.get("views", []) if view.get("soft_iou") is not None]
        parts = [
            self._size,
            f"{sum(alike) / len(alike):.0%} alike" if alike else "",
            f"{_grouped(skeleton['branches'])} branches" if "branches" in skeleton else "",
            f"{_grouped(report['leaves'])} leaves" if report.get("leaves") else "",
        ]
        self._figures.set_text("  ·  ".join(part for part in parts if part))

    def _state(self, state: str) -> None:
        self._busy = state == "busy"
        if not self._busy:
            self._cut = 0.0
        self._dot.classes(replace=f"state-dot {state}")
        self._bar.set_visibility(self._busy)
        self._cancel.set_visibility(self._busy)
        self._again.set_visibility(state in ("stopped", "failed"))


def _grouped(count: int) -> str:
    """A large number with thin gaps."""
    return f"{count:,}".replace(",", "\u202f")
