import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.density.save_volume import load_volume, save_volume
from flowtree.errors import InputError, OutputError
from flowtree.model.volume import DensityVolume

VOLUME = DensityVolume(
    np.random.default_rng(0).random((3, 4, 5)).astype(np.float32), np.float32([-1, 0, -2]), 0.1
)


def test_what_was_saved_is_loaded(tmp_path):
    save_volume(VOLUME, tmp_path / "v.npz")
    back = load_volume(tmp_path / "v.npz")
    assert back.density.tobytes() == VOLUME.density.tobytes()
    assert back.density.dtype == np.float32
    assert np.array_equal(back.origin, VOLUME.origin)
    assert back.voxel == VOLUME.voxel


def test_equal_volumes_give_equal_bytes(tmp_path):
    for name in ("a.npz", "b.npz"):
        save_volume(VOLUME, tmp_path / name)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_damaged_file_is_refused_or_still_a_volume(data, tmp_path_factory):
    path = tmp_path_factory.mktemp("volume") / "v.npz"
    save_volume(VOLUME, path)
    whole = bytearray(path.read_bytes())
    place = data.draw(st.integers(0, len(whole) - 1))
    if data.draw(st.booleans()):
        whole = whole[:place]
    else:
        whole[place] ^= data.draw(st.integers(1, 255))
    path.write_bytes(whole)
    try:
        back = load_volume(path)
    except InputError:
        return
    assert np.isfinite(back.density).all()


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"density": np.full((2, 2, 2), -1.0)}, "at least 0"),
        ({"density": np.full((2, 2, 2), np.nan)}, "finite"),
        ({"density": np.full((2, 2, 2), 1e300)}, "at most"),
        ({"density": np.ones((2, 2))}, "shape"),
        ({"density": np.zeros((0, 2, 2))}, "voxels"),
        ({"density": np.array([[["a"]]])}, "numbers"),
        ({"density": np.array([None])}, "archive"),
        ({"origin": np.zeros(2)}, "shape"),
        ({"origin": np.array([0, np.inf, 0])}, "finite"),
        ({"voxel": np.array(0.0)}, "longer"),
        ({"voxel": np.array(-1.0)}, "at least 0"),
        ({"voxel": None}, "voxel"),
    ],
)
def test_what_is_no_volume_is_refused(change, text, tmp_path):
    parts = {"density": VOLUME.density, "origin": VOLUME.origin, "voxel": np.array(0.1), **change}
    file = io.BytesIO()
    np.savez(file, **{name: value for name, value in parts.items() if value is not None})
    (tmp_path / "v.npz").write_bytes(file.getvalue())
    with pytest.raises(InputError, match=text):
        load_volume(tmp_path / "v.npz")


def test_no_file_a_folder_and_another_kind_of_file_are_refused(tmp_path):
    (tmp_path / "text.npz").write_text("not an archive")
    np.save(tmp_path / "one.npy", np.ones(3))
    for name in ("missing.npz", ".", "text.npz", "one.npy"):
        with pytest.raises(InputError):
            load_volume(tmp_path / name)


def test_an_impossible_place_is_reported(tmp_path):
    with pytest.raises(OutputError):
        save_volume(VOLUME, tmp_path / "missing" / "v.npz")
