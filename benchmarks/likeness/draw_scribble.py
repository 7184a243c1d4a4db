"""The scribble that a person would draw next."""

from __future__ import annotations

from heapq import heappop, heappush

import cv2
import numpy as np
from numpy.typing import NDArray
from skimage.measure import label
from skimage.morphology import skeletonize

TREE, BACKGROUND = 1, 2

# A person does not see single leaves and holes: they are smoothed away [picture heights].
_SIGHT = 0.002
# Mean error from which a place looks wrong: first what is plainly so.
_WRONG = (0.5, 0.3)
# A stroke stays where nearly all is tree, or nearly nothing [alpha].
_PURE = 0.2
# A stroke is at most so wide [picture heights], and never wider than half of the place it repairs.
_WIDEST = 0.012


def draw_scribble(
    alpha: NDArray[np.float32],
    truth: NDArray[np.float32],
    scribbles: NDArray[np.uint8],
    *,
    labels: tuple[int, ...] = (TREE, BACKGROUND),
) -> NDArray[np.uint8] | None:
    """Adds one stroke where the matte is most wrong, through the middle of that place.

    The place is the connected region with the largest error in which all is tree, or nothing; the stroke is
    the longest line through its skeleton.

    Args:
        alpha: (h, w) the matte as it is.
        truth: (h, w) as it should be.
        scribbles: (h, w) drawn so far: 0 nothing, 1 tree, 2 background.
        labels: that may be drawn.

    Returns: the scribbles with one more; None where nothing looks wrong.
    """
    height = alpha.shape[0]
    missing = cv2.GaussianBlur(truth - alpha, (0, 0), _SIGHT * height)
    seen = cv2.GaussianBlur(truth, (0, 0), _SIGHT * height)
    for least in _WRONG:
        best, region, chosen = 0.0, None, 0
        for kind in labels:
            wrong, other = (missing, 1.0 - seen) if kind == TREE else (-missing, seen)
            places = label((wrong > least) & (other < _PURE), connectivity=1)
            weight = np.bincount(places.ravel(), wrong.ravel())
            weight[0] = 0.0
            if weight.max() > best:
                best, region, chosen = float(weight.max()), places == weight.argmax(), kind
        if region is not None:
            return _stroke(region, scribbles, chosen)
    return None


def _stroke(region: NDArray[np.bool_], scribbles: NDArray[np.uint8], kind: int) -> NDArray[np.uint8]:
    """One line of a round brush through the region."""
    inside = np.pad(region, 1)
    depth = cv2.distanceTransform(inside.astype(np.uint8), cv2.DIST_L2, 5)[1:-1, 1:-1]
    line = _longest_line(skeletonize(region), depth)
    brush = max(1, round(min(_WIDEST * region.shape[0], float(depth[tuple(line.T)].mean()))))
    drawn = np.zeros_like(scribbles)
    cv2.polylines(drawn, [line[:, ::-1].reshape(-1, 1, 2)], False, 1, thickness=brush)
    return np.where((drawn > 0) & region, np.uint8(kind), scribbles)


def _longest_line(skeleton: NDArray[np.bool_], depth: NDArray[np.float32]) -> NDArray[np.int32]:
    """The longest of all shortest ways through a skeleton, (n, 2) rows and columns: walked twice."""
    if not skeleton.any():
        return np.array([np.unravel_index(int(depth.argmax()), depth.shape)], np.int32)
    nodes = [tuple(int(n) for n in at) for at in np.argwhere(skeleton)]
    first, _ = _walk(nodes[0], set(nodes))
    last, before = _walk(first, set(nodes))
    line = [last]
    while line[-1] != first:
        line.append(before[line[-1]])
    return np.array(line, np.int32)


def _walk(
    start: tuple[int, int], nodes: set[tuple[int, int]]
) -> tuple[tuple[int, int], dict[tuple[int, int], tuple[int, int]]]:
    """The node furthest from a start, and the way back from every node."""
    away, before, queue, last = {start: 0.0}, {start: start}, [(0.0, start)], start
    while queue:
        so_far, at = heappop(queue)
        if so_far > away[at]:
            continue
        last = at
        for down in (-1, 0, 1):
            for right in (-1, 0, 1):
                near = at[0] + down, at[1] + right
                length = so_far + (down * down + right * right) ** 0.5
                if near in nodes and length < away.get(near, np.inf):
                    away[near], before[near] = length, at
                    heappush(queue, (length, near))
    return last, before
