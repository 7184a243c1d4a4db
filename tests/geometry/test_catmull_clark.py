import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.catmull_clark import ROUND, split_corners, subdivide_corners, subdivide_quads

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
SIDES = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def grid(size=6):
    """A flat sheet of quads, its rim open."""
    x, y = np.meshgrid(np.arange(size), np.arange(size), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(size * size)], axis=1).astype(float)
    first = (np.arange(size - 1)[:, None] * size + np.arange(size - 1)).ravel()
    return points, np.stack([first, first + size, first + size + 1, first + 1], axis=1)


def slow_step(positions, quads):
    """Catmull and Clark's rules, one vertex after the other, for closed surfaces."""
    centers = positions[quads].mean(axis=1)
    edges = {}
    for face, quad in enumerate(quads):
        for k in range(4):
            edges.setdefault(frozenset((quad[k], quad[(k + 1) % 4])), []).append(face)
    on_edge = {
        edge: (positions[list(edge)].sum(axis=0) + centers[faces].sum(axis=0)) / 4.0
        for edge, faces in edges.items()
    }
    moved = []
    for vertex, place in enumerate(positions):
        faces = [f for f, quad in enumerate(quads) if vertex in quad]
        middles = [positions[list(edge)].mean(axis=0) for edge in edges if vertex in edge]
        n = len(faces)
        moved.append((centers[faces].mean(axis=0) + 2.0 * np.mean(middles, axis=0) + (n - 3.0) * place) / n)
    return np.array(moved), on_edge, centers


@given(st.integers(0, 1000), st.integers(0, 2))
@settings(max_examples=10, deadline=None)
def test_it_is_catmull_and_clarks_rule(seed, steps):
    positions, quads = CUBE + 0.3 * np.random.default_rng(seed).normal(size=CUBE.shape), SIDES
    for _ in range(steps):
        positions, quads, _ = subdivide_quads(positions, quads)
    finer, rows, edges = subdivide_quads(positions, quads)
    moved, on_edge, centers = slow_step(positions, quads)
    count = len(positions)
    assert np.allclose(finer[:count], moved)
    assert np.allclose(finer[count : count + len(edges)], [on_edge[frozenset(e)] for e in edges])
    assert np.allclose(finer[count + len(edges) :], centers)
    assert np.array_equal(np.sort(rows[:, 0]), np.sort(quads.ravel()))


def test_values_at_corners_hang_on_nothing_that_was_in_memory(monkeypatch):
    quads = SIDES[:3] + 9  # a vertex of no quad, as a paste leaves them, has no value
    values = np.random.default_rng(0).random((3, 4, 2))
    plain = subdivide_corners(quads, values, rounding=ROUND)

    def dirty(shape, dtype=np.float64):
        return np.full(shape, np.finfo(dtype).max if dtype is np.float64 else -1, dtype)

    monkeypatch.setattr(np, "empty", dirty)
    assert np.array_equal(subdivide_corners(quads, values, rounding=ROUND), plain)


def test_a_sphere_stays_one():
    positions, quads = CUBE, SIDES
    for _ in range(3):
        positions, quads, _ = subdivide_quads(positions, quads)
    assert len(quads) == 6 * 4**3
    start, end = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
    passed = np.sort(start * len(positions) + end)
    assert np.all(np.diff(passed) > 0)
    assert np.array_equal(passed, np.sort(end * len(positions) + start))
    assert len(positions) - len(passed) // 2 + len(quads) == 2


def test_a_flat_sheet_stays_where_it_is():
    positions, quads = grid()
    finer, rows, _ = subdivide_quads(positions, quads)
    assert np.allclose(finer[:, 2], 0.0)
    assert finer[:, :2].min() >= 0.0
    assert finer[:, :2].max() <= 5.0
    inner = (positions[:, :2] > 0).all(axis=1) & (positions[:, :2] < 5).all(axis=1)
    assert np.allclose(finer[: len(positions)][inner], positions[inner])
    assert np.allclose(finer[0], [0.125, 0.125, 0.0])  # a corner is cut as a closed rim's would be
    assert len(rows) == 4 * len(quads)


def test_corners_follow_the_surface_and_keep_their_seams():
    positions, quads = grid()
    stretched = positions.copy()
    stretched[:, 0] **= 2
    uvs = stretched[quads][:, :, :2].copy()
    uvs[quads[:, 0] >= 18] += [100.0, 0.0]  # another piece of the picture from the middle on
    finer, rows, _ = subdivide_quads(stretched, quads)
    values = subdivide_corners(quads, uvs)
    seam = np.repeat(quads[:, 0] >= 18, 4)
    apart = values - np.where(seam[:, None, None], [100.0, 0.0], 0.0) - finer[rows][:, :, :2]
    beside = np.abs(finer[rows][:, :, 0] - 9.0).min(axis=1) < 4.0
    assert np.allclose(apart[~beside], 0.0)
    assert np.abs(apart).max() < 1.0
    place, corner = split_corners(quads, uvs)
    assert len(place) == 36 + 6
    assert np.array_equal(place[corner], quads)


def test_rounding_makes_a_regular_octagon_of_a_square_tube():
    square = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    points = np.concatenate([np.column_stack([square, np.full(4, height)]) for height in range(5)])
    low, side = 4 * np.arange(4)[:, None], np.arange(4)
    after = (side + 1) % 4
    quads = np.stack([low + side, low + after, low + 4 + after, low + 4 + side], axis=2).reshape(-1, 4)
    finer, *_ = subdivide_quads(points, quads, rounding=ROUND)
    ring = finer[np.abs(finer[:, 2] - 2.0) < 1e-9]
    assert len(ring) == 8
    assert np.ptp(np.hypot(ring[:, 0], ring[:, 1])) < 1e-12
    plain, *_ = subdivide_quads(points, quads)
    assert np.ptp(np.hypot(*plain[np.abs(plain[:, 2] - 2.0) < 1e-9, :2].T)) > 0.04


def test_rounding_leaves_planes_and_lines_as_they_are():
    points, quads = grid()
    bent = np.column_stack([points, 2.0 * points[:, 0] - points[:, 1]])
    finer, *_ = subdivide_quads(bent, quads, rounding=ROUND)
    assert np.allclose(finer[:, 2], 0.0)
    assert np.allclose(finer[:, 3], 2.0 * finer[:, 0] - finer[:, 1])
