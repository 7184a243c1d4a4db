"""Painted density changes a matte (Particle Flows, section 9)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from flowtree import check
from flowtree.model.edit import PaintedEdit
from flowtree.model.matte import Matte

_SAID = 0.5  # strength of paint above which it says what is there
_TREE = 0.5  # alpha from which a pixel's foreground colour is sure to be the tree's


def paint_matte(matte: Matte, edit: PaintedEdit) -> Matte:
    """Applies what a person painted into and erased from one view.

    Added density unites with what is there: alpha becomes 1 - (1 - alpha)(1 - add). Then the erased share
    goes: alpha becomes alpha (1 - erase). Where density was added to less than half a tree the foreground
    colour is that of the nearest tree pixel. What was unknown is known where more than half is painted: a
    person has said what is there.

    Args:
        matte: of the view.
        edit: of the same size; its directions are none of the matte's business.

    Returns: the painted matte; the same one where nothing is painted.

    Raises:
        InputError: a layer of another size than the matte, with NaN or values outside 0..1.
    """
    if edit.add is None and edit.erase is None:
        return matte
    size = matte.alpha.shape
    alpha, foreground = matte.alpha, matte.foreground
    painted = np.zeros(size, np.float32)
    if edit.add is not None:
        add = check.array(edit.add, "painted density", shape=size, low=0.0, high=1.0)
        foreground = _extend_colors(alpha, foreground, add > 0.0)
        # The union written so that nothing added is exactly nothing changed.
        alpha = np.asarray(alpha + add - alpha * add, np.float32)
        painted = np.maximum(painted, add)
    if edit.erase is not None:
        erase = check.array(edit.erase, "erased density", shape=size, low=0.0, high=1.0)
        alpha = np.asarray(alpha * (1.0 - erase), np.float32)
        painted = np.maximum(painted, erase)
    unknown = None if matte.unknown is None else matte.unknown & (painted <= _SAID)
    return replace(matte, alpha=np.clip(alpha, 0.0, 1.0), foreground=foreground, unknown=unknown)


def _extend_colors(
    alpha: NDArray[np.float32], foreground: NDArray[np.uint8], painted: NDArray[np.bool_]
) -> NDArray[np.uint8]:
    """The foreground (h, w, 3), filled with the nearest tree pixel's colour where density was painted."""
    tree = alpha >= min(_TREE, float(alpha.max()))
    fill = painted & ~tree
    if not fill.any() or float(alpha.max()) == 0.0:
        return foreground
    nearest = ndimage.distance_transform_edt(~tree, return_distances=False, return_indices=True)
    result = foreground.copy()
    result[fill] = foreground[nearest[0][fill], nearest[1][fill]]
    return result
