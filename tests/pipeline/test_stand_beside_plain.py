"""The painted tree and the one without paint are made side by side, and share what can be shared."""

from __future__ import annotations

import numpy as np
import pytest

from flowtree.model.edit import PaintedEdit
from flowtree.pipeline.cache import StageCache
from flowtree.pipeline.reconstruct import reconstruct
from flowtree.pipeline.stand_beside_plain import stand_beside_plain
from flowtree.pipeline.table import STAGES
from tests.pictures import save_pair
from tests.pipeline.test_marks import HEIGHT, SMALL

TABLE = stand_beside_plain(STAGES)


def test_every_stage_stands_behind_those_that_it_reads():
    made = {name: k for k, stage in enumerate(TABLE) for name in stage.outputs}
    assert len(made) == sum(len(stage.outputs) for stage in TABLE), "no value is made twice"
    for k, stage in enumerate(TABLE):
        assert all(made.get(name, -1) < k for name in stage.inputs), stage.name


def test_nothing_without_paint_hangs_on_the_paint():
    makers = {name: stage for stage in TABLE for name in stage.outputs}
    todo, seen = ["plain_skeleton", "plain_foliage", "bark"], set()
    while todo:
        stage = makers.get(todo.pop())
        if stage is not None and stage.name not in seen:
            seen.add(stage.name)
            todo += stage.inputs
    assert "painting" not in seen
    assert "plain painting" in seen
    assert {stage.name for stage in TABLE if stage.name.startswith("plain ")} <= seen


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    return save_pair(tmp_path_factory.mktemp("pair"))


def _erase(shape, columns):
    erase = np.zeros(shape, np.float32)
    erase[:, :columns] = 1.0
    return {0: PaintedEdit(erase=erase)}


def test_a_stroke_of_paint_leaves_alone_what_the_matte_without_it_tells(pair):
    cache = StageCache(512)
    plain = reconstruct(pair, height=HEIGHT, params=SMALL, cache=cache)
    size = plain.mattes[0].alpha.shape
    paint = _erase(size, size[1] // 2 - 12)
    painted = reconstruct(pair, height=HEIGHT, params=SMALL, paint=paint, cache=cache)
    assert painted.cameras == plain.cameras
    assert painted.mattes[1] is plain.mattes[1]
    assert painted.graphs[1] is plain.graphs[1]
    assert painted.graphs[0] is not plain.graphs[0]
    assert painted.tree.bark is plain.tree.bark
    alone = reconstruct(pair, height=HEIGHT, params=SMALL, paint=paint)
    assert np.array_equal(alone.skeleton.points, painted.skeleton.points), "with and without a cache"
