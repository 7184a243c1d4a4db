"""What holds of every card."""

from __future__ import annotations

import numpy as np

from flowtree.model.asset import Card


def check_card(card: Card) -> None:
    """A proper mesh with a texture that has no dark rim."""
    mesh = card.mesh
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(float) for k in range(3))
    facing = np.cross(b - a, c - a)
    assert (np.sum(facing * mesh.normals[mesh.triangles[:, 0]], axis=1) > 0).all()
    assert np.allclose(np.sum(mesh.normals * mesh.tangents[:, :3], axis=1), 0, atol=1e-6)
    assert (mesh.uvs >= 0).all()
    assert (mesh.uvs <= 1).all()
    picture = card.material.base_color
    clear, solid = picture[:, :, 3] == 0, picture[:, :, 3] == 255
    assert clear.any()
    assert solid.any()
    painted = picture[:, :, :3].max(axis=2) > 0  # not between the pictures
    assert picture[clear & painted][:, :3].max(axis=1).min() > 0.3 * np.median(
        picture[solid][:, :3].max(axis=1)
    )
    normal = card.material.normal[:, :, :3] / 127.5 - 1.0
    assert np.allclose(np.linalg.norm(normal, axis=2), 1.0, atol=0.02)
    assert (normal[:, :, 2] > -0.01).all()
