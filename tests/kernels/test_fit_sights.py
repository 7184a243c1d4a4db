"""The kernels against their float64 twins, on every device present."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.geometry.projection import view_axes
from flowtree.kernels import fit_sights as kernels
from flowtree.kernels.reference import fit_sights as twins
from tests.flows import DEVICES

SEEDS = st.integers(0, 10_000)


def _chance(seed, views=2, side=6, rows=5):
    """Views, some of them parallel, and a picture and a box for them."""
    rng = np.random.default_rng(seed)
    axes = [view_axes(yaw) for yaw in rng.uniform(0, 360, views)]
    made = SimpleNamespace(
        right=np.array([a[0] for a in axes], np.float32),
        toward=np.array([a[2] for a in axes], np.float32),
        closeness=np.where(rng.random(views) < 0.3, 0.0, 1 / rng.uniform(1.5, 4, views)).astype(np.float32),
        eye=rng.uniform(0, 1, views).astype(np.float32),
        left=-5 * 0.2,
        cell=0.2,
        corner=np.array([-side / 2 * 0.2, 0.0, -side / 2 * 0.2]),
    )
    # Nothing at the borders: there float32 finds a place on either side.
    picture, box = np.zeros((views, 10, rows + 3), np.float32), np.zeros((side, rows, side), np.float32)
    for values in (picture[:, 1:-1, :-1], box[1:-1, 1:-1, 1:-1]):
        values[:] = rng.random(values.shape) * (rng.random(values.shape) < 0.8)
    return made, picture, box


def _upload(made, device):
    views = kernels.SightViews()
    for name, kind in (("right", wp.vec3), ("toward", wp.vec3), ("closeness", float), ("eye", float)):
        setattr(views, name, devices.upload(getattr(made, name), kind, device))
    views.left, views.cell, views.corner = made.left, made.cell, wp.vec3(*map(float, made.corner))
    return views


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_sum_sights(device, seed):
    made, picture, box = _chance(seed)
    out = devices.zeros(picture.shape, float, device)
    inputs = [devices.upload(values, float, device) for values in (picture, box)]
    devices.launch(
        kernels.sum_sights,
        picture.size,
        [_upload(made, device), *inputs, 5],
        [out],
        device=device,
        split_from=2,
    )
    slow = np.zeros(picture.shape)
    twins.sum_sights(0, made, picture, box.astype(float), 5, slow)
    assert np.allclose(out.numpy(), slow, atol=1e-4)
    assert (out.numpy()[picture == 0] == 0).all()


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_scale_sights(device, seed):
    made, picture, box = _chance(seed)
    out = devices.upload(box, float, device)
    count = box.shape[0] * box.shape[1]
    inputs = [_upload(made, device), devices.upload(picture, float, device), -1.5]
    devices.launch(kernels.scale_sights, count, inputs, [out], device=device, split_from=2)
    slow = box.astype(float)
    twins.scale_sights(0, made, picture, -1.5, slow)
    assert np.allclose(out.numpy(), slow, atol=1e-4)


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_carve_sights(device, seed):
    made, picture, box = _chance(seed)
    out = devices.upload(box, float, device)
    count = box.shape[0] * box.shape[1]
    inputs = [_upload(made, device), devices.upload(picture, float, device), 0.3]
    devices.launch(kernels.carve_sights, count, inputs, [out], device=device, split_from=2)
    slow = box.astype(float)
    twins.carve_sights(0, made, picture, 0.3, slow)
    assert np.mean(out.numpy() != slow.astype(np.float32)) < 0.02
