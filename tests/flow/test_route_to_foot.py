import numpy as np
import pytest

from flowtree.flow.route_to_foot import route_to_foot
from flowtree.model.field import LimbField
from flowtree.model.volume import DensityVolume
from tests.flows import cone_volume


def _at(route, place):
    directions, corner, spacing = route
    cell = np.round((np.asarray(place) - corner) / spacing).astype(int)
    return directions[tuple(np.clip(cell, 0, np.array(directions.shape[:3]) - 1))]


def test_on_the_stem_the_way_is_down():
    route = route_to_foot(cone_volume())
    for y in (0.3, 0.8, 1.4):
        assert _at(route, (0.0, y, 0.0))[1] < -0.9


def _gallows():
    """A stem, an arm, and a curtain that hangs from its end."""
    density = np.zeros((32, 32, 5), np.float32)
    density[4:6, :, 1:4] = 1.0
    density[4:28, 28:31, 1:4] = 1.0
    density[26:28, 6:31, 1:4] = 1.0
    return DensityVolume(density, np.float32([-0.5, 0, -0.25]), 0.1)


def test_under_a_hanging_crown_the_way_leads_up_through_the_branches():
    curtain = _at(route_to_foot(_gallows()), (2.2, 2.2, 0.0))
    assert curtain[1] > 0.7


@pytest.mark.parametrize("shape", [(1, 1, 1), (1, 80, 1), (90, 1, 2), (3, 200, 3), (40, 33, 7)])
def test_any_shape_has_vectors_of_length_1_to_2_or_none(shape):
    density = np.zeros(shape, np.float32)
    density[-1, -1, -1] = 1e-20
    directions, corner, spacing = route_to_foot(DensityVolume(density, np.float32([-1, 0, -1]), 0.1))
    length = np.linalg.norm(directions, axis=-1)
    assert (((length > 1 - 1e-5) & (length < 2 + 1e-5)) | (length == 0)).all()
    assert min(directions.shape[:3]) >= 3
    assert max(directions.shape[:3]) <= 100
    # The box covers the volume.
    assert (corner <= np.float32([-1, 0, -1])).all()
    reach = corner + spacing * (np.array(directions.shape[:3]) - 1)
    assert (reach > np.array([-1, 0, -1]) + np.array(shape) * 0.1 - 0.5 * spacing).all()


def test_the_way_is_as_symmetric_as_the_volume():
    directions, _, _ = route_to_foot(cone_volume(size=16))
    mirrored = directions[::-1] * [-1, 1, 1]
    # The foot lies on a point beside the axis, between two: the middle alone may differ.
    assert np.median(np.abs(directions - mirrored)) < 0.1


def test_vectors_are_longer_in_the_air_than_in_the_crown():
    route = route_to_foot(_gallows())
    assert np.linalg.norm(_at(route, (1.0, 3.0, 0.0))) < 1.1  # in the arm
    assert np.linalg.norm(_at(route, (1.0, 1.5, 0.0))) > 1.8  # below it


def _limb_field(vector):
    vectors = np.broadcast_to(np.float32(vector), (12, 14, 12, 3)).copy()
    return LimbField(vectors, np.float32([-1.1, -0.1, -1.1]), 0.2)


def test_where_the_limbs_field_is_sure_it_alone_is_followed():
    directions, corner, spacing = route_to_foot(cone_volume(), _limb_field((0.6, 0.0, -0.8)))
    assert np.array_equal(corner, np.float32([-1.1, -0.1, -1.1]))
    assert spacing == 0.2
    assert np.allclose(directions, np.float32([1.2, 0.0, -1.6]), atol=1e-5)


def test_where_it_says_nothing_the_way_is_as_without_it():
    volume = cone_volume()
    with_limbs, without = route_to_foot(volume, _limb_field((0.0, 0.0, 0.0))), route_to_foot(volume)
    for place in ((0.0, 0.5, 0.0), (0.1, 1.5, 0.1), (-0.3, 1.7, 0.1)):
        ways = [way / np.linalg.norm(way) for way in (_at(with_limbs, place), _at(without, place))]
        assert ways[0] @ ways[1] > 0.9
    length = np.linalg.norm(with_limbs[0], axis=-1)
    assert length.max() < 2 + 1e-5


def test_half_sure_the_two_are_mixed():
    plain = _at(route_to_foot(cone_volume(), _limb_field((0.0, 0.0, 0.0))), (0.0, 0.7, 0.0))
    mixed = _at(route_to_foot(cone_volume(), _limb_field((0.5, 0.0, 0.0))), (0.0, 0.7, 0.0))
    assert plain[1] < -0.9
    assert mixed[0] > 0.5
    assert mixed[1] < -0.5
    assert np.linalg.norm(mixed) == pytest.approx(1.5, abs=0.01)
