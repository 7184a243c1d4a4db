"""A picture of times against sizes, a line for each program."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.cases import Case
from flowtree import check
from flowtree.files import write_whole

_NAMES = {
    "flowtree": "flowtree, all cores",
    "flowtree-1": "flowtree, one core",
    "numba": "Numba, all cores",
    "numpy": "NumPy + cKDTree, all cores",
    "hashgrid": "Warp's HashGrid, one core",
    "flowtree-cuda": "flowtree, CUDA",
    "hashgrid-cuda": "Warp's HashGrid, CUDA",
}
_COLOURS = {  # told apart with any kind of colour vision (Okabe and Ito)
    "flowtree": "#009e73",
    "flowtree-1": "#56b4e9",
    "numba": "#d55e00",
    "numpy": "#0072b2",
    "hashgrid": "#cc79a7",
    "flowtree-cuda": "#000000",
    "hashgrid-cuda": "#e69f00",
}
_OTHER = "#555555"


def draw_times(cases: Sequence[Case], file: Path, *, title: str) -> None:
    """Writes a PNG: medians as lines, from the fastest to the slowest run as bars, both axes logarithmic.

    Raises:
        InputError: matplotlib is not installed, or there is no time to draw.
        OutputError: the file could not be written.
    """
    figure_type, canvas_type = _matplotlib()
    timed = [case for case in cases if case.valid]
    check.require(bool(timed), str(file), "needs a time to draw", "none", "run a program that is right")
    figure = figure_type(figsize=(7.2, 4.8), dpi=150, layout="constrained")
    axes = figure.add_subplot()
    for name in sorted({case.program for case in timed}, key=lambda name: [*_NAMES, name].index(name)):
        own = sorted((case for case in timed if case.program == name), key=lambda case: case.size)
        sizes = [case.size for case in own]
        medians = [case.median_s for case in own]
        spread = [[c.median_s - c.min_s for c in own], [c.max_s - c.median_s for c in own]]
        label, colour = _NAMES.get(name, name), _COLOURS.get(name, _OTHER)
        axes.errorbar(sizes, medians, yerr=spread, label=label, color=colour, marker="o", ms=4, capsize=3)
        axes.annotate(
            f"{medians[-1]:.2g} s", (sizes[-1], medians[-1]), (6, -3), textcoords="offset points", fontsize=8
        )
    axes.set(xscale="log", yscale="log", xlabel="particles", ylabel="time to trace all to the foot [s]")
    axes.set_title(title, fontsize=10)
    axes.margins(x=0.09)
    axes.grid(which="major", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=9)
    data = io.BytesIO()
    canvas_type(figure).print_png(data)
    write_whole(file, data.getvalue())


def _matplotlib() -> tuple[Any, Any]:
    """Its figure and the canvas that needs no window."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        check.fail("matplotlib", "must be installed for plots", "none", "pip install 'flowtree-3d[bench]'")
    return Figure, FigureCanvasAgg
