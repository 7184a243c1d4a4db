"""Small pictures of a tree before a sky, with their exact matte."""

import cv2
import numpy as np

from flowtree.model.photo import Photo


def draw_tree(height=200, width=160, seed=0, ground=True, sky=(150, 190, 235), haze=1.0):
    """A crown of leaves with gaps on a trunk, before a sky that fades downwards and a lawn.

    Returns: the photo and its alpha (h, w).
    """
    rng = np.random.default_rng(seed)
    scale = 4
    big = np.zeros((height * scale, width * scale), np.uint8)
    leaves = np.zeros_like(big)
    middle, crown, radius = width * scale // 2, int(0.4 * height * scale), 0.28 * height * scale
    trunk = max(4, int(0.025 * height * scale))
    cv2.rectangle(big, (middle - trunk, crown), (middle + trunk, int(0.92 * height * scale)), 255, -1)
    for _ in range(420):
        r, t = radius * np.sqrt(rng.random()), 2 * np.pi * rng.random()
        centre = (int(middle + r * np.cos(t)), int(crown + r * np.sin(t)))
        size = int(rng.uniform(0.012, 0.03) * height * scale)
        cv2.circle(leaves, centre, size, int(rng.uniform(60, 255)), -1)
    small = (width, height)
    cover = cv2.resize(
        np.maximum(big, (leaves > 0) * 255).astype(np.float32) / 255, small, interpolation=cv2.INTER_AREA
    )
    shade = cv2.resize(leaves.astype(np.float32) / 255, small, interpolation=cv2.INTER_AREA)[..., None]
    leaf = cv2.resize((leaves > 0).astype(np.float32), small, interpolation=cv2.INTER_AREA)[..., None]
    tree = leaf * (np.array([30, 60, 20]) + shade * np.array([60, 110, 40])) + (1 - leaf) * np.array(
        [75, 60, 50]
    )
    fade = np.linspace(0, 1, height)[:, None, None]
    back = (
        (1 - fade) * np.array(sky)
        + fade * np.minimum(np.array(sky) + 30.0, 255)
        + np.zeros((height, width, 3))
    )
    if ground:
        line = int(0.82 * height)
        lawn = cv2.GaussianBlur(rng.normal(0, 25, (height - line, width, 1)), (0, 0), 1.0)[..., None]
        back[line:] = np.array([120, 150, 70]) + lawn
    back = back + rng.normal(0, haze, back.shape)
    picture = cover[..., None] * tree + (1 - cover[..., None]) * back
    return Photo("tree.png", np.clip(picture, 0, 255).astype(np.uint8)), cover


def error(alpha, truth):
    """Mean absolute error over the tree's box."""
    rows, columns = np.nonzero(truth > 0.02)
    box = (slice(rows.min(), rows.max() + 1), slice(columns.min(), columns.max() + 1))
    return float(np.abs(alpha - truth)[box].mean())
