import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from flowtree.errors import InputError
from flowtree.foliage.make_leaf import leaf_coverage, make_leaf
from flowtree.model.mesh import Material, TreeMesh

SHAPES = ("broad", "lanceolate", "needle", "frond", "compound", "blossom")


def linear(srgb):
    level = np.asarray(srgb) / 255.0
    return np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)


def opaque_mean(material):
    passes = material.base_color[:, :, 3] >= 255 * material.alpha_cutoff
    return linear(material.base_color[passes][:, :3]).mean(axis=0)


@pytest.fixture(scope="module")
def leaves():
    return {shape: make_leaf(shape, seed=4) for shape in SHAPES}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_leaf_is_a_metre_from_the_origin_along_y_facing_z(leaves, shape):
    mesh, _ = leaves[shape]
    middle = mesh.positions[np.isclose(mesh.uvs[:, 0], 0.5)] if shape != "needle" else mesh.positions
    low, high = mesh.uvs[:, 1] == 1.0, mesh.uvs[:, 1] == 0.0
    assert np.abs(mesh.positions[low][:, 1]).max() < 0.05
    if shape != "needle":
        assert np.abs(mesh.positions[low & np.isclose(mesh.uvs[:, 0], 0.5)]).max() < 1e-6
    length = np.linalg.norm(np.diff(np.unique(middle[:, 1:], axis=0), axis=0), axis=1).sum()
    assert shape == "needle" or length == pytest.approx(1.0, abs=0.03)
    assert np.all(mesh.positions[high][:, 1] > 0.75)
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-5)
    if shape != "needle":
        a, b, c = (mesh.positions[mesh.triangles[:, k]] for k in range(3))
        assert np.cross(b - a, c - a)[:, 2].min() > 0
        assert mesh.normals[:, 2].min() > 0
    assert len(mesh.triangles) <= (16 if shape == "frond" else 8)


@pytest.mark.parametrize("shape", [shape for shape in SHAPES if shape != "needle"])
def test_the_mesh_is_symmetric(leaves, shape):
    mesh, _ = leaves[shape]
    mirrored = mesh.positions * [-1.0, 1.0, 1.0]
    away = np.linalg.norm(mirrored[:, None] - mesh.positions[None], axis=2).min(axis=1)
    assert away.max() < 1e-6


@pytest.mark.parametrize("shape", SHAPES)
def test_little_of_the_mesh_is_transparent(leaves, shape):
    mesh, material = leaves[shape]
    solid = dataclasses.replace(material, alpha_cutoff=None)
    assert leaf_coverage(mesh, material) > 0.4 * leaf_coverage(mesh, solid)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_mesh_shows_the_whole_picture(leaves, shape):
    """Every opaque texel lies in some triangle: the outline is trimmed, not cut."""
    mesh, material = leaves[shape]
    rows, columns = material.base_color.shape[:2]
    y, x = np.nonzero(material.base_color[:, :, 3] >= 255 * material.alpha_cutoff)
    point = np.stack([(x + 0.5) / columns, (y + 0.5) / rows], axis=1)
    held = np.zeros(len(point), bool)
    for triangle in mesh.triangles:
        a, b, c = mesh.uvs[triangle].astype(float)
        weight = np.linalg.solve(np.stack([b - a, c - a], axis=1), (point - a).T)
        held |= (weight >= -1e-3).all(axis=0) & (weight.sum(axis=0) <= 1.001)
    assert held.mean() > 0.999


@pytest.mark.parametrize("shape", SHAPES)
def test_the_texture_is_neutral_so_that_leaf_colours_multiply(leaves, shape):
    _, material = leaves[shape]
    assert np.allclose(opaque_mean(material), 0.8, atol=0.01)
    assert material.double_sided
    variation = linear(material.base_color[:, :, 1])[material.base_color[:, :, 3] > 200].std()
    assert 0.02 < variation < 0.25


@pytest.mark.parametrize("shape", SHAPES)
def test_colours_run_out_under_the_transparent_texels(leaves, shape):
    """What a filter mixes in beyond the edge is leaf, not canvas."""
    _, material = leaves[shape]
    texture = material.base_color.astype(int)
    clear = texture[:, :, 3] == 0
    assert texture[clear][:, :3].min() > 60
    edge = clear[:, 1:] & (texture[:, :-1, 3] > 128)
    assert np.abs(texture[:, 1:, :3][edge] - texture[:, :-1, :3][edge]).mean() < 25


@given(st.sampled_from(SHAPES), st.integers(0, 2**32), st.tuples(*[st.floats(0.02, 0.9)] * 3))
@settings(max_examples=10, deadline=None)
def test_any_seed_and_colour(shape, seed, color):
    mesh, material = make_leaf(shape, color=color, seed=seed)
    assert np.allclose(opaque_mean(material), color, rtol=0.05, atol=0.01)
    assert 0.05 < leaf_coverage(mesh, material) < 0.8


def test_a_seed_gives_its_bytes_and_another_gives_others():
    one, two, other = (make_leaf("needle", seed=s)[1].base_color.tobytes() for s in (1, 1, 2))
    assert one == two
    assert one != other


def half_alpha(width, height):
    """A 1 m square whose texture is opaque in its left half."""
    texture = np.full((height, width, 4), 255, np.uint8)
    texture[:, width // 2 :, 3] = 0
    square = np.array([[-0.5, 0, 0], [0.5, 0, 0], [0.5, 1, 0], [-0.5, 1, 0]], np.float32)
    mesh = TreeMesh(
        positions=square,
        normals=np.tile(np.float32([0, 0, 1]), (4, 1)),
        uvs=np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32),
        triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    )
    return mesh, Material("half", texture, alpha_cutoff=0.5)


def test_coverage_is_the_area_that_passes():
    mesh, material = half_alpha(64, 64)
    assert leaf_coverage(mesh, material) == pytest.approx(0.5, abs=0.01)
    assert leaf_coverage(mesh, dataclasses.replace(material, alpha_cutoff=None)) == pytest.approx(1.0)
    assert leaf_coverage(mesh, dataclasses.replace(material, base_color=material.base_color[:, :, :3])) == 1.0


def oval(width=60, height=100):
    y, x = np.mgrid[:height, :width]
    inside = ((x - width / 2) / (width / 2 - 2)) ** 2 + ((y - height / 2) / (height / 2 - 2)) ** 2 < 1
    picture = np.zeros((height, width, 4), np.uint8)
    picture[inside] = (40, 120, 30, 255)
    picture[(y < height // 2) & inside, 1] = 160
    return picture


def test_the_users_picture_becomes_the_texture(tmp_path):
    Image.fromarray(oval()).save(tmp_path / "leaf.png")
    mesh, material = make_leaf("broad", picture=tmp_path / "leaf.png")
    assert material.base_color.shape == (100, 60, 4)
    assert np.array_equal(material.base_color[:, :, 3], oval()[:, :, 3])
    assert np.allclose(opaque_mean(material), 0.8, atol=0.02)
    assert np.ptp(mesh.positions[:, 0]) <= 0.6 + 1e-6
    upper, lower = material.base_color[20, 30], material.base_color[80, 30]
    assert upper[1] > lower[1] + 20


def test_pictures_that_cannot_be_leaves_get_one_clear_line(tmp_path):
    Image.new("RGB", (32, 32), (30, 90, 20)).save(tmp_path / "solid.png")
    Image.new("RGBA", (32, 32), (30, 90, 20, 255)).save(tmp_path / "opaque.png")
    Image.new("RGBA", (32, 32), (30, 90, 20, 0)).save(tmp_path / "empty.png")
    (tmp_path / "text.png").write_text("leaf")
    for name, message in {
        "solid.png": "needs an alpha channel",
        "opaque.png": "must be opaque where the leaf is",
        "empty.png": "must be opaque where the leaf is",
        "text.png": "must be a picture of a leaf",
        "none.png": "must be a picture of a leaf",
    }.items():
        with pytest.raises(InputError, match=f"{name}: {message}") as caught:
            make_leaf("broad", picture=tmp_path / name)
        assert "\n" not in str(caught.value)


def test_an_unknown_shape_and_a_bad_colour():
    with pytest.raises(InputError, match="did you mean 'needle'"):
        make_leaf("needles")
    with pytest.raises(InputError, match="leaf color: must be at most 1"):
        make_leaf("broad", color=(0.1, 2.0, 0.1))
