"""Many views, one view, cut views: the tree is no worse for them."""

from __future__ import annotations

import numpy as np
import pytest

from flowtree.configuration import override_params
from flowtree.model.camera import Camera
from flowtree.model.photo import Photo
from flowtree.params import Params
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.render.render_mask import render_mask
from flowtree.render.soft_iou import soft_iou
from tests.pictures import save_pair

HEIGHT = 6.0
HELD_OUT = (65.0, 160.0)
SMALL = override_params(
    Params(),
    [
        *("density.resolution=24", "flow.particle_count=300", "attraction.grid_height=64"),
        *("attraction.seed_count=8", "leaves.most=1500", "twigs.most=400"),
    ],
)
LOOSE = override_params(SMALL, ["align.automatic=all", "align.distance=0"])


def camera(yaw):
    return Camera(yaw, HEIGHT / 180, (90.0, 190.0), 180, 200)


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A tree that can be looked at from anywhere."""
    return reconstruct(save_pair(tmp_path_factory.mktemp("source")), height=HEIGHT, params=SMALL).tree


@pytest.fixture(scope="module")
def cache():
    return StageCache(256)


def shot(source, yaw, rows=slice(None)):
    alpha = render_mask(source, camera(yaw))[rows]
    grey = np.where(alpha[..., None] > 0.3, np.uint8([90, 110, 60]), np.uint8(220))
    return Photo(f"from_{yaw:g}.jpg", grey, np.ascontiguousarray(alpha))


def scores(source, made, yaws):
    return [
        soft_iou(
            render_mask(made.tree, camera(y)),
            camera(y),
            render_mask(source, camera(y)),
            camera(y),
            height=HEIGHT,
        )
        for y in yaws
    ]


def make(source, yaws, cache, *, params=SMALL, cut=None):
    photos = [shot(source, yaw, (cut or {}).get(yaw, slice(None))) for yaw in yaws]
    return reconstruct(photos, yaws=yaws, height=HEIGHT, params=params, cache=cache)


def test_more_views_at_odd_yaws_make_no_worse_a_tree(source, cache):
    two = np.mean(scores(source, make(source, (0.0, 90.0), cache), HELD_OUT))
    many = make(source, (0.0, 40.0, 90.0, 140.0, 200.0), cache)
    assert [view["yaw"] for view in many.report["views"]] == [0.0, 40.0, 90.0, 140.0, 200.0]
    assert np.mean(scores(source, many, HELD_OUT)) > two - 0.02


def test_three_odd_views_and_one_alone_make_a_tree(source, cache):
    three = make(source, (0.0, 40.0, 200.0), cache)
    assert min(scores(source, three, (0.0, 40.0))) > 0.5
    lone = reconstruct([shot(source, 30.0)], yaws=[30.0], height=HEIGHT, params=SMALL, cache=cache)
    assert [view["yaw"] for view in lone.report["views"]] == [30.0, 120.0]
    assert scores(source, lone, (30.0,))[0] > 0.5


def test_a_cut_crown_and_a_hidden_foot_cost_little(source, cache):
    whole = make(source, (0.0, 90.0), cache, params=LOOSE)
    cut = make(source, (0.0, 90.0), cache, params=LOOSE, cut={0.0: slice(25, 180)})
    before, after = (np.mean(scores(source, made, (0.0, 90.0, *HELD_OUT))) for made in (whole, cut))
    assert after > before - 0.12
    known = cut.report["views"][0]["alignment"]
    assert known["foot"]["value"] == pytest.approx(190 - 25, abs=14)
    assert known["top"]["value"] < 8
    assert known["straightened"]
    assert set(known["leaves_picture_at"]) >= {"bottom"}
    assert any("outside the picture" in warning for warning in cut.report["warnings"])
