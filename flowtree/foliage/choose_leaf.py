"""Which leaf goes with a silhouette."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte

_SLIM = 0.75  # a conifer's crown is at most this wide for its height
_BARE_STEM = 0.55  # a palm's stem is at least this share of its height


def choose_leaf(
    mattes: Sequence[Matte], cameras: Sequence[Camera]
) -> Literal["broad", "needle", "lanceolate"]:
    """Needles for a cone that starts near the ground, leaflets for a tuft on a bare stem, else broad leaves.

    The traced branches of a palm are the ribs of its fronds: what they bear are lanceolate leaflets.
    """
    kinds = [_kind(matte, camera) for matte, camera in zip(mattes, cameras, strict=True)]
    for kind in ("needle", "lanceolate"):
        if 2 * kinds.count(kind) > len(kinds):
            return kind
    return "broad"


def _kind(matte: Matte, camera: Camera) -> str:
    rows = np.flatnonzero((matte.alpha > 0.3).sum(axis=1) > 1)
    foot = min(int(camera.foot[1]), matte.alpha.shape[0])
    rows = rows[rows < foot]
    if len(rows) < 16:
        return "broad"
    solid = matte.alpha[rows[0] : foot] > 0.3
    bands = np.array_split(np.arange(len(solid)), 10)  # from the top
    width = np.array([float(np.mean(solid[b].sum(axis=1))) for b in bands]) / len(solid)
    widest = float(width.max())
    stem = width < 0.25 * widest
    bare = int(np.argmin(stem[::-1])) / len(stem)  # from the ground up
    if bare >= _BARE_STEM:
        return "lanceolate"
    crown = width[: len(width) - int(np.argmin(stem[::-1]))]
    tapers = bool(np.polyfit(np.arange(len(crown)), crown / widest, 1)[0] > 0.07) and crown[0] < 0.25 * widest
    low = bare <= 0.2
    return "needle" if tapers and low and widest < _SLIM and np.argmax(crown) >= 0.6 * len(crown) else "broad"
