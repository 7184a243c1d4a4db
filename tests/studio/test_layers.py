"""Layers: what a browser reads is what the stages made."""

from __future__ import annotations

import io
import json

import numpy as np
import pytest
from PIL import Image

from flowtree.model.attractor import AttractorGraph
from flowtree.model.camera import Camera
from flowtree.model.field import LimbField
from flowtree.model.photo import Photo
from flowtree.model.placement import Placement
from flowtree.model.traces import FlowTraces
from flowtree.model.volume import DensityVolume
from flowtree.studio.layer_book import LayerBook
from flowtree.studio.layer_shelf import LayerShelf
from flowtree.studio.layers import space_layers
from flowtree.studio.layers.layer import Layer, json_layer
from flowtree.studio.layers.photo_layers import matte_layer
from flowtree.studio.layers.space_layers import field_layer, flow_layer, skeleton_layer, voxels_layer
from flowtree.studio.layers.tree_layers import coarse_layer
from flowtree.studio.layers.view_layers import cameras_layer, graph_layer
from tests.trees import hand_made_skeleton


def _count(layer):
    return int(np.frombuffer(layer.data, "<u4", 1)[0])


def _volume(shape=(5, 6, 7)):
    density = np.random.default_rng(1).random(shape).astype(np.float32)
    density[density < 0.4] = 0.0
    return DensityVolume(density, np.array([-1.0, 0.0, -2.0], np.float32), 0.5)


def test_voxels_lie_where_the_density_is():
    volume = _volume()
    layer = voxels_layer(volume)
    n = _count(layer)
    edge, densest = np.frombuffer(layer.data, "<f4", 2, 4)
    centres = np.frombuffer(layer.data, "<f4", 3 * n, 12).reshape(n, 3)
    share = np.frombuffer(layer.data, np.uint8, n, 12 + 12 * n)
    assert len(layer.data) == 12 + 13 * n
    assert n == (volume.density > 0).sum()
    assert edge == 0.5
    cells = np.rint((centres - volume.origin) / edge - 0.5).astype(int)
    assert np.allclose(share / 255 * densest, volume.density[tuple(cells.T)], atol=densest / 255)


def test_too_many_voxels_become_fewer_of_the_same_mass(monkeypatch):
    volume = _volume((9, 8, 7))
    monkeypatch.setattr(space_layers, "_MOST_VOXELS", 100)
    layer = voxels_layer(volume)
    n = _count(layer)
    edge, densest = np.frombuffer(layer.data, "<f4", 2, 4)
    assert n <= 100
    assert edge == 1.0
    share = np.frombuffer(layer.data, np.uint8, n, 12 + 12 * n).astype(float)
    mass = (share / 255 * densest).sum() * edge**3
    assert mass == pytest.approx(float(volume.density.sum()) * 0.5**3, rel=0.01)


def test_an_empty_volume_is_no_voxels():
    empty = DensityVolume(np.zeros((3, 3, 3), np.float32), np.zeros(3, np.float32), 1.0)
    assert _count(voxels_layer(empty)) == 0


def test_arrows_are_directions_of_the_field():
    vectors = np.zeros((4, 4, 4, 3), np.float32)
    vectors[1, 2, 3] = (0.0, -1.0, 0.0)
    layer = field_layer(LimbField(vectors, np.array([1.0, 2.0, 3.0], np.float32), 0.5))
    assert _count(layer) == 1
    arrow = np.frombuffer(layer.data, "<f4", 6, 4)
    assert arrow.tolist() == [1.5, 3.0, 4.5, 0.0, -1.0, 0.0]


def _traces(tips):
    """A stem of 3 points with tips of 2 points each."""
    parent = [-1, 0, 1]
    for _ in range(tips):
        parent += [2, len(parent)]
    n = len(parent)
    step = np.array([100, 90, 80] + [70, 60] * tips, np.int32)
    points = np.random.default_rng(0).random((n, 3)).astype(np.float32)
    return FlowTraces(np.array(parent, np.int32), points, np.ones(n, np.int32), step)


@pytest.mark.parametrize("most", [60_000, 40])
def test_particles_flow_down_to_one_root_whatever_is_left_out(monkeypatch, most):
    monkeypatch.setattr(space_layers, "_MOST_POINTS", most)
    traces = _traces(50)
    layer = flow_layer(traces)
    n = _count(layer)
    parent = np.frombuffer(layer.data, "<i4", n, 4)
    step = np.frombuffer(layer.data, "<i4", n, 4 + 16 * n)
    assert len(layer.data) == 4 + 24 * n
    assert (parent[1:] < np.arange(1, n)).all()
    assert (parent == -1).sum() == 1
    assert (step[parent[1:]] > step[1:]).all()
    assert n == len(traces.parent) if most > 1000 else n <= 2 * most


def test_every_segment_of_the_skeleton_is_there():
    skeleton = hand_made_skeleton()
    layer = skeleton_layer(skeleton)
    rows = np.frombuffer(layer.data, "<f4", offset=4).reshape(-1, 10)
    assert len(rows) == _count(layer) == len(skeleton.parent) - 1
    assert np.allclose(rows[:, 4:7], skeleton.points[1:])
    assert np.allclose(rows[:, :3], skeleton.points[skeleton.parent[1:]])
    assert np.allclose(rows[:, 7], skeleton.radius[1:])
    assert coarse_layer(skeleton).data[:4] == b"glTF"


def test_a_matte_tells_the_box_that_changed():
    before = np.zeros((20, 30), np.float32)
    after = before.copy()
    after[5:9, 10:25] = 0.5
    layer = matte_layer(0, after, before)
    assert layer.box == (10, 5, 25, 9)
    whole = np.asarray(Image.open(io.BytesIO(layer.data)))
    part = np.asarray(Image.open(io.BytesIO(layer.part)))
    patched = np.zeros((20, 30), np.uint8)
    patched[5:9, 10:25] = part
    assert (patched == whole).all()
    assert matte_layer(0, after).box is None


def _placement(scale, warp=None):
    camera = Camera(yaw=90.0, metres_per_pixel=0.01, foot=(50.0, 90.0), width=100, height=100)
    return Placement(camera, warp), Photo("a.jpg", np.zeros((100, 100, 3), np.uint8), scale=scale)


def test_graphs_lie_on_the_upright_photo():
    placement, photo = _placement(0.5)
    parent = np.array([-1, 0, 1, 1, 3], np.int32)
    points = np.array([[0, 0], [0, 0.3], [0.2, 0.5], [-0.2, 0.5], [-0.3, 0.6]], np.float32)
    graph = json.loads(graph_layer(0, AttractorGraph(parent, points), photo, placement).data)
    assert sorted(len(line) for line in graph["lines"]) == [2, 2, 3]
    assert [100.0, 180.0] in [line[0] for line in graph["lines"]]
    shifted, photo = _placement(0.5, np.array([[1.0, 0, 7], [0, 1, 0], [0, 0, 1]]))
    moved = json.loads(graph_layer(0, AttractorGraph(parent, points), photo, shifted).data)
    assert np.allclose(moved["lines"][0][0], np.add(graph["lines"][0][0], [14, 0]))


def test_cameras_tell_which_photo_a_view_is_of():
    placement, photo = _placement(0.5)
    views = json.loads(cameras_layer([photo, photo], [placement, placement], [False, True]).data)
    assert [(view["photo"], view["mirrored"]) for view in views] == [(0, False), (0, True)]
    assert np.allclose(views[0]["warp"], np.diag([2.0, 2.0, 1.0]))


def test_a_layer_is_drawn_again_only_for_other_objects():
    book, made = LayerBook(), []

    def make():
        made.append(1)
        return json_layer("report", {})

    one, two = [1], [1]
    assert book.draw("report", (one, "a"), make) is not None
    assert book.draw("report", (one, "a"), make) is None
    assert book.draw("report", (two, "a"), make) is not None
    assert book.draw("report", (two, "b"), make) is not None
    assert len(made) == 3


def test_the_shelf_shows_the_layers_of_the_photos_there_are():
    shelf = LayerShelf()
    shelf.show(2)
    for name in ("photo/0", "photo/1", "straight/1", "tree.glb"):
        [event] = shelf.put(json_layer(name, {}))
        assert event["url"] == f"/layer/{event['revision']}/{name}"
    assert set(shelf.layers()) == {"photo/0", "photo/1", "straight/1", "tree.glb"}
    assert shelf.show(1) == [{"event": "removed", "name": "photo/1"}]
    assert set(shelf.layers()) == {"photo/0", "straight/1", "tree.glb"}
    assert [event["name"] for event in shelf.show(2)] == ["photo/1"]
    assert {event["name"] for event in shelf.show(0)} == {"photo/0", "photo/1", "straight/1", "tree.glb"}
    assert shelf.layers() == {}
    assert shelf.put(json_layer("report", {})) == []
    assert shelf.get("nothing") is None


def test_the_part_of_a_matte_is_a_layer_of_its_own():
    shelf = LayerShelf()
    shelf.show(1)
    shelf.put(Layer("matte/0", "image/png", b"whole"))
    assert shelf.get("matte-part/0") is None
    [event] = shelf.put(Layer("matte/0", "image/png", b"whole", (1, 2, 3, 4), b"part"))
    assert event["part"] == f"/layer/{event['revision']}/matte-part/0"
    assert shelf.get("matte-part/0").data == b"part"
