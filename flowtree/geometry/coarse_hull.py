"""A convex body of few triangles around points."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull, QhullError

_FIRST = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z])
_THIN = 1e-3  # of the points' extent: flat clouds get that much body


def coarse_hull(
    points: ArrayLike, *, corners: int = 34, share: float = 0.995
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """The hull of the points' farthest corners, widened until it holds nearly all points.

    Corners are added one by one, each time the point that stands out most; then the body grows around its
    middle until ``share`` of the points lie inside: few stray points do not blow it up.

    Args:
        points: (n, 3), n >= 1; in a plane, a line or one place they get a thin body.
        corners: at most so many, at least 4; k corners make at most 2 * k - 4 triangles.
        share: 0..1.

    Returns: positions (k, 3) and triangles, counter-clockwise seen from outside.
    """
    cloud = np.asarray(points, np.float64)
    try:
        full = ConvexHull(cloud)
    except QhullError:
        thick = _THIN * (float(np.ptp(cloud, axis=0).max()) or 1.0)
        offsets = thick * np.concatenate([np.eye(3), -np.eye(3)])
        cloud = (cloud[:, None] + offsets).reshape(-1, 3)
        full = ConvexHull(cloud)
    outer = cloud[np.sort(full.vertices)]
    if len(outer) > corners:
        outer = _farthest(outer, corners)
    hull = ConvexHull(outer)
    middle = outer.mean(axis=0)
    normals, reach = hull.equations[:, :3], -(hull.equations[:, 3] + hull.equations[:, :3] @ middle)
    # How much each point asks the body to grow: its height over the middle, relative to each face's.
    asked = np.max([(cloud - middle) @ n / r for n, r in zip(normals, reach, strict=True)], axis=0)
    growth = max(1.0, float(np.quantile(asked, share, method="higher")))
    positions = middle + growth * (outer[hull.vertices] - middle)
    number = np.full(len(outer), -1)
    number[hull.vertices] = np.arange(len(hull.vertices))
    triangles = number[hull.simplices]
    a, b, c = (positions[triangles[:, k]] for k in range(3))
    inward = np.sum(np.cross(b - a, c - a) * normals, axis=1) < 0
    triangles[inward] = triangles[inward][:, [0, 2, 1]]
    return positions.astype(np.float32), triangles.astype(np.int32)


def _farthest(outer: NDArray[np.float64], corners: int) -> NDArray[np.float64]:
    """So many of the corners that the others stand out little."""
    chosen = list(dict.fromkeys(np.argmax(_FIRST @ outer.T, axis=1).tolist()))[:corners]
    while len(chosen) < corners:
        try:
            faces = ConvexHull(outer[chosen]).equations
        except QhullError:  # the first corners lie in a plane: the farthest from it makes a body
            arms = outer - outer[chosen].mean(axis=0)
            away = np.abs(arms @ np.linalg.svd(arms[chosen])[2][-1])
        else:
            away = np.max(outer @ faces[:, :3].T + faces[:, 3], axis=1)
        away[chosen] = -np.inf
        chosen.append(int(np.argmax(away)))
    return outer[chosen]
