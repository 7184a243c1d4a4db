"""The kernels against their float64 twins, on every device present."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree import device as devices
from flowtree.kernels import choose_cover as kernels
from flowtree.kernels.reference import choose_cover as twins
from tests.flows import DEVICES

CELLS, PIXELS = 6, 6 * 16  # of a view, without those beside its picture


def scene(seed, things, poses, views=2):
    """Things that cover a few pixels of every view, some beside it, and what is rendered before."""
    rng = np.random.default_rng(seed)
    count = rng.integers(0, 6, views * things * poses)
    start = np.append(0, np.cumsum(count))
    view = np.repeat(
        np.arange(views), np.add.reduceat(np.append(count, 0), np.arange(views) * things * poses)
    )
    pixel = rng.integers(0, PIXELS + 1, start[-1])
    cell = np.where(pixel == PIXELS, CELLS, pixel % CELLS)
    share = rng.uniform(0.05, 0.9, start[-1])
    depth = rng.uniform(0.0, 1.0, (views, PIXELS + 1))
    depth[:, -1] = np.inf
    clear = np.exp(-depth)
    means = clear[:, :-1].reshape(views, 16, CELLS).mean(axis=1)
    known = np.pad(rng.uniform(0.5, 1.0, (views, CELLS)), ((0, 0), (0, 1)))
    wrong = np.pad(rng.uniform(0.0, 1.0, (views, CELLS)) - 1.0 + means, ((0, 0), (0, 1))) * known
    table = {
        "start": start,
        "pixel": pixel + view * (PIXELS + 1),
        "cell": cell + view * (CELLS + 1),
        "share": share,
        "depth": -np.log1p(-share),
        "focus": rng.uniform(0.2, 1.0, len(count)),
        "known": known.ravel(),
    }
    state = {"depth": depth.ravel(), "clear": clear.ravel(), "wrong": wrong.ravel()}
    state |= {"together": np.zeros(views * (CELLS + 1)), "shown": np.zeros(len(count))}
    batch = np.array([0, things // 3, things // 3, things], np.int32)  # one of them empty
    return rounded(table), rounded(state), batch, rng


def rounded(lists):
    """The same numbers for both: as the kernels keep them."""
    return {
        name: values.astype(np.int32 if values.dtype.kind == "i" else np.float32)
        for name, values in lists.items()
    }


def run(kernel, twin, table, state, poses, inputs, outputs, device):
    """What kernel and twin leave: the state's numbers and the outputs."""

    def up(values):
        return devices.upload(
            values, kernels.wp.int32 if values.dtype == np.int32 else kernels.wp.float32, device
        )

    fast_table, fast_state = kernels.CoverViews(), kernels.CoverState()
    for struct, lists in ((fast_table, table), (fast_state, state)):
        for name, values in lists.items():
            setattr(struct, name, up(values))
    fast_table.views, fast_table.poses = 2, poses
    slow_table = SimpleNamespace(**table, views=2, poses=poses)
    slow_state = SimpleNamespace(**{name: values.astype(np.float64) for name, values in state.items()})
    fast = [up(a) for a in outputs]
    given = [up(a) if isinstance(a, np.ndarray) else a for a in inputs]
    devices.launch(kernel, 1, [fast_table, *given], [fast_state, *fast], device=device)
    slow = [a.copy() for a in outputs]
    twin(0, slow_table, *inputs, slow_state, *slow)
    names = ("depth", "clear", "wrong", "shown")
    return (
        [getattr(fast_state, name).numpy() for name in names] + [a.numpy() for a in fast],
        [getattr(slow_state, name) for name in names] + slow,
    )


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), things=st.integers(1, 30), least=st.sampled_from([0.0, 0.02]))
def test_sweep_cover(device, seed, things, least):
    table, state, batch, rng = scene(seed, things, 1)
    there = rng.integers(0, 2, things).astype(np.int32)
    luck, likely = rng.random((2, things)).astype(np.float32)
    inputs, outputs = [batch, luck, likely, least], [there, np.zeros(things, np.float32)]
    fast, slow = run(kernels.sweep_cover, twins.sweep_cover, table, state, 1, inputs, outputs, device)
    for one, other in zip(fast, slow, strict=True):
        assert np.allclose(one, other, atol=2e-5)  # float32, a few dozen sums


@pytest.mark.parametrize("device", DEVICES)
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 10_000), things=st.integers(1, 15), poses=st.integers(1, 4))
def test_sweep_poses(device, seed, things, poses):
    table, state, batch, rng = scene(seed, things, poses)
    pose = rng.integers(-1, poses, things).astype(np.int32)
    fast, slow = run(
        kernels.sweep_poses, twins.sweep_poses, table, state, poses, [batch, 0.7], [pose], device
    )
    for one, other in zip(fast, slow, strict=True):
        assert np.allclose(one, other, atol=2e-5)
