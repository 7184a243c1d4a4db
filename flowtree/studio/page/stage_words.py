"""What a person reads while a stage runs."""

from __future__ import annotations

_WORDS = {
    "reading the photos": ("photos", "strokes", "marks", "sketch"),
    "telling tree from background": ("picks", "preparing", "matting", "coloring", "painting"),
    "fitting the photos together": ("placing", "registering", "framing", "lines", "completing", "retouching"),
    "filling the crown": ("density", "between", "leafiness", "habit"),
    "following the branches": ("attraction", "limbs", "fields", "limb_field"),
    "letting particles flow": ("flow",),
    "joining branches": ("branches", "colors", "patching"),
    "growing twigs": ("twigs",),
    "making wood and bark": ("meshing", "bark", "closing"),
    "putting leaves on": ("leaf", "foliage", "leaf_patching"),
    "finishing": ("assembly", "equipping", "fidelity"),
}
_OF_STAGE = {stage: words for words, stages in _WORDS.items() for stage in stages}


def stage_words(stage: str) -> str:
    """A few words for a stage of the pipeline's table; the same for its twin without paint."""
    return _OF_STAGE[stage.removeprefix("plain ")]
