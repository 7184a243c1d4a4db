import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.errors import InputError
from flowtree.meshing.paint_bark import paint_bark, pick_habit

STYLES = ("furrowed", "smooth", "papery", "plated", "ringed")


def linear(srgb):
    level = np.asarray(srgb) / 255.0
    return np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("style", STYLES)
def test_bark_goes_on_over_both_edges(style):
    """The step over the edge is like any other step between rows or columns: the picture has no border."""
    material = paint_bark((120, 100, 80), style=style, seed=3, size=256)
    for picture in (material.base_color, material.normal):
        for axis in (0, 1):
            step = np.abs(picture.astype(float) - np.roll(picture, 1, axis=axis)).mean(axis=(1 - axis, 2))
            middle, spread = np.median(step), np.median(np.abs(step - np.median(step)))
            assert step[0] < middle + 8.0 * spread
            assert step[0] <= step[1:].max()


@pytest.mark.parametrize("style", STYLES)
@pytest.mark.parametrize("color", [(112, 98, 84), (235, 232, 228), (60, 40, 30), (0, 0, 0), (255, 255, 255)])
def test_the_mean_is_the_colour(style, color):
    material = paint_bark(color, style=style, size=128)
    mean = linear(material.base_color).mean(axis=(0, 1))
    assert np.allclose(mean, linear(color), atol=0.012)


@given(st.tuples(*[st.floats(0, 255)] * 3), st.integers(0, 2**32), st.integers(16, 70))
@settings(max_examples=20, deadline=None)
def test_any_colour_seed_and_size_makes_a_material(color, seed, size):
    material = paint_bark(color, seed=seed, size=size)
    assert material.base_color.shape == material.normal.shape == (size, size, 3)
    normal = material.normal / 127.5 - 1.0
    assert np.allclose(np.linalg.norm(normal, axis=2), 1.0, atol=0.02)
    assert material.normal[:, :, 2].min() > 127


def test_a_seed_gives_its_bytes_and_another_gives_others():
    one, two, other = (paint_bark((120, 100, 80), seed=s, size=64) for s in (5, 5, 6))
    assert one.base_color.tobytes() == two.base_color.tobytes()
    assert one.normal.tobytes() == two.normal.tobytes()
    assert one.base_color.tobytes() != other.base_color.tobytes()


def test_the_normal_map_leans_away_from_the_heights():
    """glTF: red is right, green is up. Around a furrow the normals face each other."""
    material = paint_bark((150, 140, 130), style="ringed", seed=1, size=256)
    up = (material.normal[:, :, 1] / 127.5 - 1.0).mean(axis=1)
    light = material.base_color.mean(axis=(1, 2))
    below, above = np.roll(light, -1), np.roll(light, 1)
    # Brightness follows height here: where it rises toward the top, the surface faces down.
    assert np.corrcoef(above - below, up)[0, 1] < -0.5


@pytest.mark.parametrize(
    ("color", "habit"),
    [
        ((225, 220, 212), "papery"),
        ((150, 148, 140), "smooth"),
        ((150, 90, 60), "plated"),
        ((110, 98, 84), "furrowed"),
        ((40, 38, 36), "furrowed"),
    ],
)
def test_the_habit_follows_the_colour(color, habit):
    assert pick_habit(np.array(color, float)) == habit
    assert paint_bark(color, size=32).name == f"bark_{habit}"


def test_palms_are_ringed_and_conifers_plated_whatever_their_colour():
    for color in ((225, 220, 212), (40, 38, 36)):
        assert paint_bark(color, growth="palm", size=32).name == "bark_ringed"
        assert paint_bark(color, growth="conifer", size=32).name == "bark_plated"
        assert paint_bark(color, growth="palm", style="smooth", size=32).name == "bark_smooth"
    assert pick_habit(np.array((110.0, 98.0, 84.0)), "weeping") == "furrowed"


def test_without_a_colour_each_style_has_its_own():
    means = {s: paint_bark(None, style=s, size=32).base_color.mean(axis=(0, 1)) for s in STYLES}
    assert means["papery"].min() > 190
    assert means["plated"][0] > means["plated"][2] + 30
    assert np.ptp(means["smooth"]) < 20
    assert paint_bark(None, size=32).name == "bark_furrowed"
    assert paint_bark(None, growth="palm", size=32).name == "bark_ringed"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"color": (300, 0, 0)}, "bark color: must be at most 255"),
        ({"color": (1, 2)}, "bark color: must have shape"),
        ({"color": (np.nan, 2, 3)}, "bark color: must be finite"),
        ({"color": (1, 2, 3), "style": "furowed"}, "did you mean 'furrowed'"),
        ({"color": (1, 2, 3), "size": 2}, "bark size: must be 16 to 4096"),
    ],
)
def test_bad_input_gets_one_clear_line(arguments, message):
    with pytest.raises(InputError, match=message):
        paint_bark(arguments.pop("color"), **arguments)
