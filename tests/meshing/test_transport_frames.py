import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.meshing.transport_frames import transport_frames


def helix(count, pitch=0.3):
    t = np.linspace(0.0, 4.0 * np.pi, count)
    points = np.stack([np.cos(t), pitch * t, np.sin(t)], axis=1)
    tangents = np.stack([-np.sin(t), np.full(count, pitch), np.cos(t)], axis=1)
    return points, tangents / np.linalg.norm(tangents, axis=1, keepdims=True)


def carry_one_by_one(points, tangents, start):
    """Double reflection as it stands in the paper, point after point."""
    frame = [start]
    for i in range(len(points) - 1):
        chord = points[i + 1] - points[i]
        square = chord @ chord
        one = frame[-1] - (2.0 / square) * (chord @ frame[-1]) * chord
        tangent = tangents[i] - (2.0 / square) * (chord @ tangents[i]) * chord
        second = tangents[i + 1] - tangent
        frame.append(one - (2.0 / (second @ second)) * (second @ one) * second)
    return np.array(frame)


def test_the_scan_equals_walking_the_curve():
    points, tangents = helix(77)
    one, _ = transport_frames(points, tangents, np.zeros(77, int))
    assert np.allclose(one, carry_one_by_one(points, tangents, one[0]), atol=1e-9)


def test_the_twist_vanishes_with_the_fourth_power_of_the_spacing():
    """Along a helix the exact frame turns against the Frenet frame by the torsion times the arc."""
    errors = []
    for count in (41, 81, 161):
        points, tangents = helix(count)
        one, two = transport_frames(points, tangents, np.zeros(count, int))
        inward = -points * [1.0, 0.0, 1.0]
        angle = np.unwrap(np.arctan2(np.sum(inward * two, 1), np.sum(inward * one, 1)))
        torsion_arc = 0.3 / np.sqrt(1.0 + 0.3**2) * 4.0 * np.pi
        errors.append(abs(abs(angle[-1] - angle[0]) - torsion_arc))
    orders = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert np.all(orders > 3.5)


@given(st.integers(0, 10_000))
@settings(max_examples=25, deadline=None)
def test_frames_are_orthonormal_whatever_the_curve_does(seed):
    rng = np.random.default_rng(seed)
    count = rng.integers(1, 30)
    chain = np.sort(rng.integers(0, 4, count))
    points = rng.normal(size=(count, 3))
    doubled = rng.random(count) < 0.2
    points[1:][doubled[1:]] = points[:-1][doubled[1:]]
    tangents = rng.normal(size=(count, 3)).round(rng.integers(0, 3)) + np.array([0.0, 1e-6, 0.0])
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    one, two = transport_frames(points, tangents, chain)
    frame = np.stack([one, two, tangents], axis=1)
    assert np.allclose(frame @ frame.transpose(0, 2, 1), np.eye(3), atol=1e-9)
    assert np.allclose(np.linalg.det(frame), 1.0)


def test_chains_do_not_see_each_other():
    points, tangents = helix(40)
    alone, _ = transport_frames(points[10:], tangents[10:], np.zeros(30, int))
    both, _ = transport_frames(points, tangents, np.repeat([0, 1], [10, 30]))
    assert np.allclose(both[10:], alone, atol=1e-12)
