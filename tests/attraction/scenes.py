"""Small painted trees for the attraction tests."""

import cv2
import numpy as np

from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo


def scene(alpha, color=(60, 120, 50), foot=None):
    """Photo, matte and camera of an alpha (h, w) in one colour; the tree is 10 m tall."""
    alpha = np.asarray(alpha, np.float32)
    rows = np.flatnonzero((alpha > 0.5).any(axis=1))
    top, bottom = (rows[0], rows[-1] + 1) if len(rows) else (0, alpha.shape[0])
    if foot is None:
        columns = np.flatnonzero(alpha[bottom - 1] > 0.5)
        foot = (float(columns.mean()) + 0.5 if len(columns) else alpha.shape[1] / 2, float(bottom))
    rgb = np.full((*alpha.shape, 3), 255, np.uint8)
    rgb[alpha > 0.5] = color
    camera = Camera(0.0, 10.0 / (bottom - top), foot, alpha.shape[1], alpha.shape[0])
    return Photo("painted", rgb), Matte(alpha, rgb, "alpha channel"), camera


def lollipop(height=240, width=200):
    """A round crown on a stem."""
    alpha = np.zeros((height, width), np.uint8)
    cv2.circle(alpha, (width // 2, int(0.38 * height)), int(0.34 * height), 255, -1)
    cv2.rectangle(alpha, (width // 2 - 5, height // 2), (width // 2 + 5, int(0.97 * height)), 255, -1)
    return alpha / np.float32(255)


def spire(height=240, width=160):
    """A cone down to the ground."""
    alpha = np.zeros((height, width), np.uint8)
    cone = np.array([[width // 2, 8], [width - 20, height - 8], [20, height - 8]], np.int32)
    cv2.fillPoly(alpha, [cone], 255)
    return alpha / np.float32(255)


BARE = (
    ((100, 230), (100, 130)),
    ((100, 130), (50, 60)),
    ((100, 130), (150, 50)),
    ((125, 90), (120, 30)),
    ((75, 95), (30, 100)),
)


def bare(height=240, width=200):
    """A stem that forks, lines of a few pixels."""
    alpha = np.zeros((height, width), np.uint8)
    for (start, end), thick in zip(BARE, (9, 5, 5, 3, 3), strict=True):
        cv2.line(alpha, start, end, 255, thick, cv2.LINE_AA)
    return alpha / np.float32(255)


#: Limbs of a stem at column 200, a few pixels thick, that leave it nearly level.
LEVEL = (
    ((200, 330), (70, 320)),
    ((200, 300), (330, 285)),
    ((200, 240), (80, 225)),
    ((200, 205), (310, 190)),
    ((200, 150), (110, 130)),
    ((200, 120), (280, 95)),
)


def level_limbs(leaves=False):
    """A grey bare tree of 512 pixels with level limbs, or thinner ones, of which the upper are green."""
    fine = np.zeros((512 * 4, 400 * 4), np.uint8)
    cv2.line(fine, (800, 2000), (800, 200), 255, 40)
    for start, end in LEVEL:
        cv2.line(fine, [4 * k for k in start], [4 * k for k in end], 255, 12 if leaves else 20)
    alpha = cv2.resize(fine, (400, 512), interpolation=cv2.INTER_AREA).astype(np.float32) / 255
    rgb = np.full((512, 400, 3), (150, 140, 130), np.uint8)
    if leaves:
        rgb[:220] = 60, 150, 50
    seen = np.where(alpha[..., None] > 0, rgb, np.uint8(250))  # what is beside a limb is mixed in at its edge
    photo = np.rint(alpha[..., None] * seen + (1 - alpha[..., None]) * 250).astype(np.uint8)
    return Photo("level", photo), Matte(alpha, rgb, "automatic"), Camera(0.0, 0.02, (200.0, 500.0), 400, 512)


def assert_tree(graph):
    """What every attractor graph must be: rooted at the foot, finite, each parent before its child."""
    count = len(graph.parent)
    assert count > 1
    assert graph.parent.dtype == np.int32
    assert graph.points.dtype == np.float32
    assert graph.points.shape == (count, 2)
    assert graph.parent[0] == -1
    assert (graph.parent[1:] >= 0).all()
    assert (graph.parent[1:] < np.arange(1, count)).all()
    assert graph.points[0].tolist() == [0.0, 0.0]
    assert np.isfinite(graph.points).all()
