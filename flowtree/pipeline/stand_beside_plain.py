"""The tree that the same photographs give where nobody has painted on them, made beside the painted one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flowtree.pipeline import photo_steps
from flowtree.pipeline.stage import Stage

_FIRST = "painting"
_SHOWN = "branches"
#: What of the tree without paint the painted one is patched with.
_WANTED = ("plain_skeleton", "plain_foliage", "bark")


def stand_beside_plain(stages: Sequence[Stage]) -> tuple[Stage, ...]:
    """The table for painted photographs: each stage that the paint changes has a twin without the paint.

    Twins run beside the stages where cores are free, those up to the branches behind all of these, so that
    branches can be shown soon; and they share the results of runs without paint. There are only those that
    `patch_skeleton` and `patch_leaves` hang on. The bark is not the paint's business: it is made without
    paint alone.

    Args:
        stages: for photographs on which nobody painted, with ``plain_skeleton`` and ``plain_foliage`` among
            the sources; here stages make them.
    """
    changed: set[str] = set()
    twins: dict[str, Stage] = {}
    for stage in stages:
        if stage.name == _FIRST:
            twin = replace(stage, name="plain painting", run=photo_steps.run_leaving_bare)
        elif changed.intersection(stage.inputs) and not set(_WANTED).intersection(stage.inputs):
            twin = replace(stage, name=f"plain {stage.name}", same_as=stage.name)
        else:
            continue
        inputs = tuple(_plain(name) if name in changed else name for name in stage.inputs)
        changed.update(stage.outputs)
        outputs = tuple(name if name in _WANTED else _plain(name) for name in stage.outputs)
        twins[stage.name] = replace(twin, inputs=inputs, outputs=outputs)
    needed, wanted = set(), set(_WANTED)
    for name, twin in reversed(twins.items()):
        if wanted.intersection(twin.outputs):
            needed.add(name)
            wanted.update(twin.inputs)
    table: list[Stage] = []
    waiting: list[Stage] = []
    shown = False
    for stage in stages:
        if stage.name not in needed or not set(_WANTED).intersection(stage.outputs):
            table.append(stage)
        if stage.name in needed:
            waiting.append(twins[stage.name])
        shown = shown or stage.name == _SHOWN
        if shown:
            table += waiting
            waiting.clear()
    return tuple(table)


def _plain(name: str) -> str:
    return f"plain_{name.removeprefix('painted_')}"
