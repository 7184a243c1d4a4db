"""Joints, the skin they move, and their swaying in a GLB."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flowtree.export.glb_builder import GlbBuilder
from flowtree.export.glb_vertices import Frame
from flowtree.model.wind import Armature, Sway

_SHORT = 32767


def add_skin(
    builder: GlbBuilder, name: str, armature: Armature, frame: Frame | None
) -> tuple[int, list[int]]:
    """Adds the joints as nodes below one another, and a skin.

    Args:
        builder: the file.
        name: of the tree.
        armature: at least one joint.
        frame: in which places are quantised: what undoes it stands in the skin, because the place of a
            skinned mesh's node counts for nothing.

    Returns: the skin, and the joints' nodes; the first is the root joint, which is in no scene yet.
    """
    parent, points = armature.parent.tolist(), armature.points.astype(np.float64)
    offsets = points - np.where(armature.parent[:, None] >= 0, points[armature.parent], 0.0)
    nodes = [
        builder.add("nodes", {"name": f"{name}_joint_{k:03d}", "translation": offset})
        for k, offset in enumerate(offsets.tolist())
    ]
    for k, up in enumerate(parent):
        if up >= 0:
            builder.entry("nodes", nodes[up]).setdefault("children", []).append(nodes[k])
    undo = np.tile(np.eye(4), (len(points), 1, 1))
    undo[:, :3, 3] = -points
    if frame is not None:
        undo[:, :3, 3] += frame.centre
        undo[:, [0, 1, 2], [0, 1, 2]] = frame.step
    # glTF stores matrices by columns.
    matrices = builder.accessor(undo.transpose(0, 2, 1).reshape(-1, 16).astype(np.float32))
    entry = {"name": name, "skeleton": nodes[0], "joints": nodes, "inverseBindMatrices": matrices}
    return builder.add("skins", entry), nodes


def add_animation(builder: GlbBuilder, sway: Sway, nodes: list[int]) -> None:
    """Adds the turning of every joint that does not rest, as 16-bit fractions."""
    times = builder.accessor(sway.times.astype(np.float32)[:, None], bounds=True)
    samplers, channels = [], []
    for joint, node in enumerate(nodes):
        turns = _unit(sway.rotation[:, joint])
        if (turns == turns[0]).all() and turns[0, 3] == 1.0:
            continue
        stored = np.rint(turns * _SHORT).astype(np.int16)
        output = builder.accessor(stored, normalized=True)
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": "rotation"}})
    if channels:
        builder.add("animations", {"name": sway.name, "samplers": samplers, "channels": channels})


def _unit(turns: NDArray[np.float32]) -> NDArray[np.float64]:
    length = np.sqrt((turns.astype(np.float64) ** 2).sum(axis=1, keepdims=True))
    unit: NDArray[np.float64] = turns / length
    return unit
