import numpy as np
import pytest

from flowtree.geometry.quad_edges import pair_edges, quad_normals
from flowtree.meshing.build_tubes import BASE, CLOSED, ControlMesh
from flowtree.meshing.free_edges import free_edges
from flowtree.meshing.spread_creases import spread_creases
from flowtree.meshing.unfold_creases import unfold_creases


def tube(rings=24, sides=12, radius=0.1, length=0.04):
    """Open at both ends, where its quads stay as they are."""
    ring, side = np.divmod(np.arange(rings * sides), sides)
    turn = 2.0 * np.pi * side / sides
    positions = np.stack([radius * np.cos(turn), length * ring, radius * np.sin(turn)], axis=1)
    low = np.arange((rings - 1) * sides).reshape(-1, sides)
    after = np.roll(low, -1, axis=1)
    quads = np.stack([low, low + sides, after + sides, after], axis=2).reshape(-1, 4)
    kind = np.full(len(quads), CLOSED)
    kind[:sides] = kind[-sides:] = BASE
    none = np.zeros(len(quads), np.int64)
    return ControlMesh(
        positions, np.zeros(len(positions), np.int64), quads, np.zeros((len(quads), 4, 2)), none, kind
    )


def steepest(positions, quads):
    """[degrees], the largest angle between quads that share an edge."""
    one, two = (corner // 4 for corner in pair_edges(quads))
    normal = quad_normals(positions, quads)
    return np.degrees(np.arccos(np.clip(np.sum(normal[one] * normal[two], axis=1), -1.0, 1.0).min()))


@pytest.mark.parametrize("ring", [5, 12])
def test_a_dent_and_a_fold_are_spread_and_nothing_far_from_them_moves(ring):
    mesh = tube()
    dented = mesh.positions.copy()
    dented[12 * ring] *= (0.2, 1.0, 0.2)  # deeper than the quads are wide
    dented[12 * ring + 6 : 12 * ring + 8, 1] += 0.05  # past the next ring
    assert steepest(dented, mesh.quads) > 100.0
    spread = spread_creases(dented, mesh.quads, free_edges(mesh, (BASE,)), limit=59.5)
    assert steepest(spread, mesh.quads) <= 59.5
    far = np.abs(np.arange(len(spread)) // 12 - ring) > 9
    assert np.array_equal(spread[far], dented[far])


def test_what_few_steps_leave_more_steps_undo():
    mesh = tube()
    dented = mesh.positions.copy()
    dented[12 * 12] *= (0.2, 1.0, 0.2)
    edges = free_edges(mesh, (BASE,))
    few, more = (spread_creases(dented, mesh.quads, edges, limit=59.5, steps=steps) for steps in (1, 160))
    assert steepest(few, mesh.quads) > 59.5 >= steepest(more, mesh.quads)


def test_smooth_surfaces_and_kept_quads_stay():
    mesh = tube()
    edges = free_edges(mesh, (BASE,))
    for smooth in (spread_creases, unfold_creases):
        same = smooth(mesh.positions, mesh.quads, edges, limit=59.5)
        assert np.array_equal(same, mesh.positions)
    dented = mesh.positions.copy()
    dented[13] *= (0.2, 1.0, 0.2)
    spread = spread_creases(dented, mesh.quads, free_edges(mesh, (BASE,)), limit=59.5)
    assert np.array_equal(spread[:24], dented[:24])


@pytest.mark.parametrize("sides", [3, 12])
def test_a_fold_that_spreading_cannot_turn_is_laid_anew(sides):
    mesh = tube(rings=44)
    edges = free_edges(mesh, (BASE,))
    folded = mesh.positions.copy()
    rows = 12 * (20 + np.arange(2))[:, None] + np.arange(sides)
    folded[rows] = folded[rows[::-1]]  # quads lie on their neighbours, upside down
    stuck = spread_creases(folded, mesh.quads, edges, limit=59.5)
    assert steepest(stuck, mesh.quads) > 150.0
    laid = unfold_creases(stuck, mesh.quads, edges, limit=59.5)
    assert steepest(laid, mesh.quads) <= 59.5
    far = np.abs(np.arange(len(laid)) // 12 - 20.5) > 17
    assert np.array_equal(laid[far], folded[far])
    assert np.linalg.norm(laid[:, [0, 2]], axis=1).min() > 0.05, "thinner"


def test_a_quad_that_is_a_line_is_opened():
    mesh = tube()
    flat = mesh.positions.copy()
    flat[[144, 156]] = flat[[156, 144]]
    flat[[144, 156]] *= (0.7, 1.0, 0.7)
    spread = spread_creases(flat, mesh.quads, free_edges(mesh, (BASE,)), limit=59.5)
    assert steepest(spread, mesh.quads) <= 59.5
