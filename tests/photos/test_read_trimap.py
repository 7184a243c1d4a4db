import numpy as np
import pytest
from PIL import Image

from flowtree.errors import InputError
from flowtree.model.photo import Photo
from flowtree.photos.read_trimap import read_trimap

PHOTO = Photo("tree.jpg", np.zeros((60, 40, 3), np.uint8), scale=0.5)


def drawing(height=120, width=80):
    grey = np.full((height, width), 128, np.uint8)
    grey[: height // 4] = 0
    grey[height // 2 :] = 255
    return grey


@pytest.mark.parametrize("size", [(60, 40), (120, 80), (30, 20)])
def test_any_size_of_the_aspect_is_scaled_to_the_photo(tmp_path, size):
    Image.fromarray(drawing(*size)).save(tmp_path / "t.png")
    trimap = read_trimap(tmp_path / "t.png", PHOTO)
    assert trimap.shape == (60, 40)
    assert set(np.unique(trimap)) == {0, 128, 255}
    assert (trimap[:14] == 0).all()
    assert (trimap[31:] == 255).all()


def test_where_black_meets_white_inside_a_pixel_it_is_unknown(tmp_path):
    grey = np.zeros((120, 80), np.uint8)
    grey[61:] = 255
    Image.fromarray(grey).save(tmp_path / "t.png")
    trimap = read_trimap(tmp_path / "t.png", PHOTO)
    assert (trimap[30] == 128).all()
    assert (trimap[:30] == 0).all()
    assert (trimap[31:] == 255).all()


def test_wrong_aspect_and_one_sided_trimaps_are_refused(tmp_path):
    Image.fromarray(drawing(80, 120)).save(tmp_path / "wide.png")
    with pytest.raises(InputError, match="aspect of tree"):
        read_trimap(tmp_path / "wide.png", PHOTO)
    Image.fromarray(np.full((60, 40), 128, np.uint8)).save(tmp_path / "grey.png")
    with pytest.raises(InputError, match="needs some black"):
        read_trimap(tmp_path / "grey.png", PHOTO)
    Image.fromarray(np.zeros((60, 40), np.uint8)).save(tmp_path / "black.png")
    with pytest.raises(InputError, match="needs some white"):
        read_trimap(tmp_path / "black.png", PHOTO)
    with pytest.raises(InputError, match="no such file"):
        read_trimap(tmp_path / "none.png", PHOTO)
