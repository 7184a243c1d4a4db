import cv2
import numpy as np
import pytest

from flowtree.matting.find_sky import find_sky
from flowtree.matting.release_sky import release_sky


def snowy_tree(seed=0):
    """A crown, half of it snow in the colours of the clouds, before a blue sky with one cloud.

    Returns: CIELAB (h, w, 3), the crown and its snow, both (h, w).
    """
    rng = np.random.default_rng(seed)
    rows, columns = np.mgrid[:160, :120]
    picture = np.full((160, 120, 3), (120, 165, 225), float)
    picture[10:40, 5:45] = (225, 228, 235)
    crown = np.hypot(rows - 90, columns - 60) < 42
    snow = crown & (cv2.GaussianBlur(rng.normal(0, 1, crown.shape), (0, 0), 3.0) > 0)
    picture[crown] = np.array([50, 60, 45]) * rng.uniform(0.5, 1.4, (int(crown.sum()), 1))
    picture[snow] = np.array([228, 230, 236]) * rng.uniform(0.85, 1.05, (int(snow.sum()), 1))
    picture = np.clip(picture + rng.normal(0, 1.0, picture.shape), 0, 255) / 255
    return cv2.cvtColor(picture.astype(np.float32), cv2.COLOR_RGB2Lab), crown, snow


def found(lab):
    mean = cv2.blur(lab, (5, 5))
    texture = np.sqrt(np.maximum(cv2.blur(lab * lab, (5, 5)) - mean * mean, 0).sum(axis=2))
    return find_sky(lab, texture)


def test_a_stroke_on_snow_brings_all_snow_back():
    lab, crown, snow = snowy_tree()
    sky = found(lab)
    inner = cv2.erode(snow.astype(np.uint8), np.ones((5, 5))) > 0
    before = sky.mask[inner].mean()
    stroke = inner.copy()
    stroke[:, :60] = False
    after, chance = release_sky(lab, sky, stroke)
    left = inner & (np.arange(120) < 60)
    assert after.mask[left].mean() <= min(0.2, before)
    assert chance[left].mean() > 0.5
    beside = ~(cv2.dilate(crown.astype(np.uint8), np.ones((5, 5))) > 0)
    assert (sky.mask & ~after.mask)[beside].mean() < 0.1
    assert after.distance[after.mask].max() < 99.0


@pytest.mark.parametrize("where", ["nowhere", "dark", "mostly dark"])
def test_a_stroke_on_leaves_teaches_nothing_about_the_sky(where):
    lab, crown, snow = snowy_tree(1)
    sky = found(lab)
    stroke = np.zeros_like(crown)
    if where != "nowhere":
        stroke = crown & ~snow
    if where == "mostly dark":
        stroke[60] |= crown[60]
    after, chance = release_sky(lab, sky, stroke)
    assert np.array_equal(after.mask, sky.mask)
    assert not chance.any()
