from __future__ import annotations

import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.model.wind import VertexWind
from flowtree.wind.name_channels import LAYOUTS, name_channels


def some_vertices(count: int = 20) -> VertexWind:
    rng = np.random.default_rng(0)
    return VertexWind(
        depth=rng.integers(0, 3, count).astype(np.int32),
        pivot=rng.uniform(-5, 5, (count, 2, 3)).astype(np.float32),
        extent=rng.random((count, 4)).astype(np.float32),
        phase=(rng.random((count, 3)) * 0.999).astype(np.float32),
    )


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_layout_is_what_gltf_allows(layout):
    channels = name_channels(some_vertices(), layout)
    for name, values in channels.items():
        assert values.ndim == 2
        assert len(values) == 20
        assert values.flags.c_contiguous
        assert (values.shape[1] * values.dtype.itemsize) % 4 == 0, "a vertex attribute's stride"
        assert values.dtype in (np.float32, np.uint8, np.uint16)
        assert name.startswith(("_", "TEXCOORD_")) or name == "COLOR_0"
    empty = VertexWind(*(array[:0] for array in vars(some_vertices()).values()))
    assert {name: values.shape[1] for name, values in name_channels(empty, layout).items()} == {
        name: values.shape[1] for name, values in channels.items()
    }


def test_attributes_can_be_read_back():
    wind = some_vertices()
    channels = name_channels(wind, "attributes")
    np.testing.assert_array_equal(channels["_WIND_LIMB"], wind.pivot[:, 0])
    np.testing.assert_array_equal(channels["_WIND_BRANCH"], wind.pivot[:, 1])
    np.testing.assert_allclose(channels["_WIND_EXTENT"] / 65535, wind.extent, atol=1e-5)
    np.testing.assert_allclose(channels["_WIND_PHASE"][:, :3] / 255, wind.phase, atol=0.003)
    np.testing.assert_array_equal(np.rint(channels["_WIND_PHASE"][:, 3] / 255 * 2), wind.depth)


def test_colors_are_in_the_order_of_unitys_tree_shaders():
    wind = some_vertices()
    phase, flutter, primary, secondary = name_channels(wind, "colors")["COLOR_0"].T / 255
    np.testing.assert_allclose(phase, wind.phase[:, 0], atol=0.003)
    np.testing.assert_allclose(flutter, wind.extent[:, 3], atol=0.003)
    np.testing.assert_allclose(primary, wind.extent[:, 0], atol=0.003)
    np.testing.assert_allclose(secondary, wind.extent[:, 1:3].max(axis=1), atol=0.003)


@pytest.mark.parametrize("layout", ["godot", "unity", "unreal"])
def test_texture_coordinates_arrive_in_the_engines_frame(layout):
    wind = some_vertices()
    channels = name_channels(wind, layout)
    assert list(channels) == [f"TEXCOORD_{k}" for k in range(1, 8)], "without a gap, as glTF wants it"
    arrived = np.stack(list(channels.values()), axis=1)
    if layout == "unity":  # its importers flip every second coordinate
        arrived[:, :, 1] = 1 - arrived[:, :, 1]
    flat = arrived.reshape(20, 14)
    to_engine = {
        "godot": np.eye(3),
        "unity": np.diag([-1.0, 1.0, 1.0]),
        "unreal": 100 * np.eye(3)[[0, 2, 1]],
    }[layout]
    np.testing.assert_allclose(flat[:, 0], wind.phase[:, 2], atol=1e-6)
    np.testing.assert_allclose(flat[:, 1], wind.depth, atol=1e-6)
    np.testing.assert_allclose(flat[:, 2:5], wind.pivot[:, 0] @ to_engine.T, atol=1e-4)
    np.testing.assert_allclose(flat[:, 5], wind.phase[:, 0], atol=1e-6)
    np.testing.assert_allclose(flat[:, 6:9], wind.pivot[:, 1] @ to_engine.T, atol=1e-4)
    np.testing.assert_allclose(flat[:, 9], wind.phase[:, 1], atol=1e-6)
    np.testing.assert_allclose(flat[:, 10:], wind.extent, atol=1e-6)


def test_an_unknown_layout_is_refused():
    with pytest.raises(InputError, match="unreal"):
        name_channels(some_vertices(), "unrael")
