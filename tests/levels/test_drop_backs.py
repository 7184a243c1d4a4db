"""Sheets for blades: half of their triangles, the same sight."""

from __future__ import annotations

import numpy as np

from flowtree.geometry.closed_surfaces import is_closed, is_watertight, weld, without_sheets
from flowtree.levels.drop_backs import drop_backs
from flowtree.meshing.sweep_rings import sweep_rings
from flowtree.params import MeshingParams
from tests.skeletons import random_skeleton


def _sorted(places: np.ndarray) -> np.ndarray:
    return np.unique(np.sort(places.reshape(len(places), -1), axis=1), axis=0)


def test_only_triangles_behind_others_go():
    wood = sweep_rings(random_skeleton(3, 300), params=MeshingParams(tolerance=0.05))
    sheets = drop_backs(wood)
    assert len(sheets.triangles) < len(wood.triangles)
    before, after = (mesh.positions[mesh.triangles] for mesh in (wood, sheets))
    np.testing.assert_array_equal(_sorted(before), _sorted(after))
    assert len(np.unique(sheets.triangles)) == len(sheets.positions)
    welded = weld(sheets.positions, sheets.triangles)
    assert not is_closed(welded)
    assert is_watertight(without_sheets(welded))


def test_wood_without_blades_is_left_alone():
    wood = sweep_rings(random_skeleton(3, 30))
    assert drop_backs(wood) is wood
