"""The demo's tree is a tree, its backdrop a picture, and the bundled pictures are small enough."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from benchmarks.colonise_space import colonise_space
from benchmarks.demo_pair import main
from benchmarks.paint_backdrop import Stand, paint_backdrop

_BUNDLED = Path(__file__).parents[2] / "flowtree" / "cli" / "demo"


@pytest.mark.parametrize("seed", [0, 7])
def test_grows_a_rooted_tree_that_tapers(seed):
    skeleton = colonise_space(seed)
    again = colonise_space(seed)
    assert skeleton.points.tobytes() == again.points.tobytes()
    count = np.arange(len(skeleton.parent))
    assert (skeleton.parent[1:] < count[1:]).all()
    assert skeleton.parent[0] == -1
    assert (skeleton.parent[1:] >= 0).all()
    assert not skeleton.points[0].any()
    assert (skeleton.radius[1:] <= skeleton.radius[skeleton.parent[1:]] + 1e-6).all()
    assert skeleton.level.max() >= 3
    low = (skeleton.points[:, 1] > 0.3) & (skeleton.points[:, 1] < 2.3)
    assert np.hypot(skeleton.points[low, 0], skeleton.points[low, 2]).max() < 0.3, "a clear stem"


def test_paints_sky_above_and_shaded_grass_below():
    stand = Stand(20.0, 1.6, 20.0, (60.0, 130.0), 120, 160)
    dark, bright = (
        paint_backdrop(stand, np.full((40, 40), light, np.float32), 0.5, 1.0, 3) for light in (0.0, 1.0)
    )
    assert bright.shape == (160, 120, 3)
    assert np.isfinite(bright).all()
    assert (bright[:60, :, 2] > bright[:60, :, 1]).all()
    assert (bright[140:, :, 1] > bright[140:, :, 2]).mean() > 0.99
    assert (dark[:90] == bright[:90]).all()
    assert dark[130, 60].sum() < bright[130, 60].sum()


def test_the_bundled_pictures_are_small_and_differ_in_shape():
    files = [_BUNDLED / f"photo_{number}.jpg" for number in (0, 1)]
    assert sum(file.stat().st_size for file in files) < 700_000
    sizes = []
    for file in files:
        with Image.open(file) as picture:
            picture.load()
            sizes.append(picture.size)
    assert all(900 <= max(size) <= 1200 for size in sizes)
    assert sizes[0] != sizes[1]


def test_bad_arguments_end_with_usage(capsys):
    with pytest.raises(SystemExit) as end:
        main(["--wrong"])
    assert end.value.code == 2
    assert "usage" in capsys.readouterr().err
