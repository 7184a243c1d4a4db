"""A leaf of one metre: a few triangles and their texture."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flowtree import check
from flowtree.foliage.leaf_canvas import settle
from flowtree.foliage.load_leaf import load_leaf
from flowtree.foliage.paint_leaf import LEAF_WIDTHS, paint_leaf
from flowtree.foliage.trim_strip import trim_strip
from flowtree.geometry.srgb import LIGHT_OF_BYTE
from flowtree.model.mesh import Material, TreeMesh

_SIZE = 256  # height of a painted texture [pixels]
_COVERAGE_GRID = 48  # points along a triangle's side at which the alpha is looked up


@dataclass(frozen=True)
class _Body:
    """How a shape is bent: see `_strip`."""

    bands: int
    bend: float  # [radians] from stalk to tip, away from the upper side
    fold: float  # rise of the edges over the midrib, per half width; negative hangs
    cutoff: float  # of the alpha test; lower for shapes of thin parts, which filtering wears away
    translucency: float  # see `Material`
    planes: int = 1  # crossed planes around the y axis


_BODIES = {
    "broad": _Body(2, 0.5, 0.28, 0.5, 0.4),
    "lanceolate": _Body(2, 0.7, 0.25, 0.5, 0.4),
    "needle": _Body(2, 0.25, 0.0, 0.35, 0.2, planes=2),
    "frond": _Body(4, 1.1, -0.35, 0.4, 0.35),
    "compound": _Body(2, 0.4, 0.12, 0.45, 0.4),
    "blossom": _Body(2, 0.15, 0.22, 0.5, 0.5),
}


def make_leaf(
    shape: str,
    *,
    color: ArrayLike = (0.8, 0.8, 0.8),
    seed: int = 0,
    picture: str | Path | None = None,
) -> tuple[TreeMesh, Material]:
    """Makes a leaf in the frame of `Foliage`: stalk's end at the origin, blade along +y, upper side to +z.

    The paper's "quad or a small set of triangles" (Particle Flows, section 8): 8 triangles, folded along the
    midrib and bent, trimmed to the outline; 16 for the arch of a frond; needles lie on two crossed planes.
    Normals fan out over the blade, so that a crown of flat leaves is not lit like a heap of mirrors.

    Args:
        shape: broad, lanceolate, needle (a twig with needles), frond, compound (the paper's compound leaf: a
            small twig with leaflets) or blossom.
        color: (3,) linear 0..1, the mean of the texture where it is opaque. Leaves take their own colour from
            `Foliage.color`, which is multiplied with it; the default grey leaves room above for veins.
        seed: of the painting.
        picture: a PNG with alpha instead of the painted texture, its lower edge at the stalk's end. Its
            colours are scaled to the mean ``color`` too, channel by channel: only their variation stays.

    Returns: the mesh, 1 m along its midrib, and the material (double-sided, alpha-tested).

    Raises:
        InputError: an unknown shape, a colour out of range, a picture that cannot be used.
    """
    check.require(
        shape in _BODIES,
        "leaf shape",
        f"must be one of {', '.join(_BODIES)}",
        repr(shape),
        check.nearest_name(shape, _BODIES),
    )
    mean = check.array(color, "leaf color", shape=(3,), dtype=np.float64, low=0.0, high=1.0)
    body = _BODIES[shape]
    if picture is None:
        width = LEAF_WIDTHS[shape]
        texture = paint_leaf(shape, mean=mean, cutoff=body.cutoff, seed=seed, size=_SIZE)
    else:
        given = load_leaf(picture)
        width = given.shape[1] / given.shape[0]
        texture = settle(LIGHT_OF_BYTE[given[:, :, :3]], given[:, :, 3] / 255.0, mean, body.cutoff)
    material = Material(
        name=f"leaf_{shape}",
        base_color=texture,
        roughness=0.65,
        double_sided=True,
        alpha_cutoff=body.cutoff,
        translucency=body.translucency,
    )
    return _strip(body, width, texture[:, :, 3] >= 0.25 * 255 * body.cutoff), material


def leaf_coverage(mesh: TreeMesh, material: Material) -> float:
    """Area [m²] of a leaf 1 m long that passes the alpha test, one side; s² times that at a length of s.

    The texture is looked up at a regular grid of points in every triangle.
    """
    a, b, c = (mesh.positions[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    texture = material.base_color
    if texture.shape[2] == 3 or material.alpha_cutoff is None:
        return float(area.sum())
    step = (np.arange(_COVERAGE_GRID) + 1.0 / 3.0) / _COVERAGE_GRID
    u, v = (part.ravel() for part in np.meshgrid(step, step))
    below = u + v < 1.0
    weight = np.stack([1.0 - u - v, u, v])[:, below]
    uv = np.einsum("ks,tkd->tsd", weight, mesh.uvs[mesh.triangles].astype(np.float64))
    rows, columns = texture.shape[:2]
    column = np.floor(uv[:, :, 0] * columns).astype(int) % columns
    row = np.floor(uv[:, :, 1] * rows).astype(int) % rows
    there = texture[row, column, 3] >= 255.0 * material.alpha_cutoff
    return float(np.sum(area * there.mean(axis=1)))


def _strip(body: _Body, width: float, there: NDArray[np.bool_]) -> TreeMesh:
    """A bent strip with a crease along its middle, no wider than what the texture shows.

    Args:
        body: how to bend it.
        width: of the texture [m].
        there: (h, w), texels that may be seen.
    """
    along, half = trim_strip(body.bands, width, there)
    sides = np.array([-1.0, 0.0, 1.0] if body.planes == 1 else [-1.0, 1.0])
    columns = len(sides)
    s = np.repeat(along, columns)
    side = np.tile(sides, len(along))
    x = side * np.repeat(half, columns)
    corner = np.arange(len(s)).reshape(len(along), columns)
    low, high = corner[:-1], corner[1:]
    one = np.stack([low[:, :-1], low[:, 1:], high[:, 1:]], axis=-1).reshape(-1, 3)
    two = np.stack([low[:, :-1], high[:, 1:], high[:, :-1]], axis=-1).reshape(-1, 3)
    faces = np.concatenate([one, two])

    angle = body.bend * s
    y, z = np.sin(angle) / body.bend, (np.cos(angle) - 1.0) / body.bend
    rise = body.fold * np.abs(x)
    positions, normals, triangles = [], [], []
    for plane in range(body.planes):
        turn = 0.0 if body.planes == 1 else np.pi * (plane + 0.5) / body.planes
        cosine, sine = np.cos(turn), np.sin(turn)
        # Turned across the midrib first and bent with it then: crossed planes stay crossed to the tip.
        right, up = x * cosine - rise * sine, x * sine + rise * cosine
        positions.append(np.stack([right, y + up * np.sin(angle), z + up * np.cos(angle)], axis=1))
        right, up = 0.55 * side * cosine - sine, 0.55 * side * sine + cosine
        forth = 0.5 * (s - 0.4)
        normals.append(
            np.stack(
                [
                    right,
                    forth * np.cos(angle) + up * np.sin(angle),
                    up * np.cos(angle) - forth * np.sin(angle),
                ],
                axis=1,
            )
        )
        triangles.append(faces + plane * len(s))
    normal = np.concatenate(normals)
    return TreeMesh(
        positions=np.concatenate(positions).astype(np.float32),
        normals=(normal / np.linalg.norm(normal, axis=1, keepdims=True)).astype(np.float32),
        uvs=np.tile(np.stack([0.5 + x / width, 1.0 - s], axis=1), (body.planes, 1)).astype(np.float32),
        triangles=np.concatenate(triangles).astype(np.int32),
    )
