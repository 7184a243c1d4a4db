"""All parts of the measure of fidelity, by the name that ``--part`` takes."""

from __future__ import annotations

from benchmarks.likeness.bench import Part, find_cutouts, find_photographs, find_truth
from benchmarks.likeness.measure_cutouts import measure_cutouts
from benchmarks.likeness.measure_exact import measure_exact
from benchmarks.likeness.measure_holes import measure_holes
from benchmarks.likeness.measure_loose import measure_loose
from benchmarks.likeness.measure_mattes import measure_mattes
from benchmarks.likeness.measure_paint import measure_paint
from benchmarks.likeness.measure_photographs import measure_photographs
from benchmarks.likeness.measure_seeds import measure_seeds
from benchmarks.likeness.measure_speed import measure_speed
from benchmarks.likeness.measure_strokes import measure_strokes
from benchmarks.likeness.measure_wood import measure_wood

PARTS: dict[str, Part] = {
    "truth": Part(find_truth, measure_exact),
    "mattes": Part(find_truth, measure_mattes),
    "cutouts": Part(find_cutouts, measure_cutouts),
    "loose": Part(find_truth, measure_loose),
    "wood": Part(find_truth, measure_wood),
    "strokes": Part(find_truth, measure_strokes),
    "hole": Part(find_truth, measure_holes),
    "paint": Part(find_truth, measure_paint),
    "photographs": Part(find_photographs, measure_photographs),
    "speed": Part(find_truth, measure_speed),
    "seeds": Part(find_truth, measure_seeds),
}
