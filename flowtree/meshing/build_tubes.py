"""The control mesh: square tubes around the branches, to be joined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flowtree.geometry.catmull_clark import ROUND
from flowtree.geometry.local_units import turn_between
from flowtree.meshing.branch_axes import Floats, Ints, unit
from flowtree.meshing.branch_curves import BranchCurves
from flowtree.meshing.find_exits import Exits
from flowtree.meshing.lay_rings import ControlRings, return_from
from flowtree.meshing.map_bark import wrap_bark
from flowtree.params import MeshingParams

_OVERSHOOT = 0.2  # of the drift of the ring before
_FLARE_REACH = 1.3  # of the trunk's radius, over which the root flare fades

CLOSED, HOSTING, BASE, FOOT = range(
    4
)  # quads that stay, may be opened, close a base for a while, stand on the ground


@dataclass(frozen=True)
class ControlMesh:
    """A surface of quads on the way to the finished one.

    Attributes:
        positions: (n, 3) [m].
        node: (n,), the skeleton's node that carries the vertex.
        quads: (m, 4), counter-clockwise seen from outside.
        uvs: (m, 4, 2), of the corners.
        branch: (m,), whose surface the quad is a part of.
        kind: (m,), CLOSED, HOSTING, BASE or FOOT.
    """

    positions: Floats
    node: Ints
    quads: Ints
    uvs: Floats
    branch: Ints
    kind: Ints

    def joined(self, other: ControlMesh) -> ControlMesh:
        """Both, side by side; the other's vertices are counted on."""
        return ControlMesh(
            np.concatenate([self.positions, other.positions]),
            np.concatenate([self.node, other.node]),
            np.concatenate([self.quads, other.quads + len(self.positions)]),
            np.concatenate([self.uvs, other.uvs]),
            np.concatenate([self.branch, other.branch]),
            np.concatenate([self.kind, other.kind]),
        )


@dataclass(frozen=True)
class RingCorners:
    """The corners of all rings, and what the quads between them need.

    Attributes:
        corner: (r, 4, 3) [m], counter-clockwise seen from the branch's tip.
        node: (r,), the skeleton's node that carries the ring.
        repeats: (r,), of the texture around the segment below.
        start: (r, 2), texture coordinates where the ring begins.
        first: (c,), each branch's base ring.
        last: (c,), its end.
    """

    corner: Floats
    node: Ints
    repeats: Ints
    start: Floats
    first: Ints
    last: Ints


def shrinkage(subdivisions: int) -> float:
    """How much thinner a square tube becomes: the radius of its final area over that of its corners.

    Its inverse is the factor alpha of the paper's criterion 3. The section of a straight tube is subdivided
    as the surface is.
    """
    ring = np.exp(0.5j * np.pi * np.arange(4))
    for _ in range(subdivisions):
        middle = 0.5 * (ring + np.roll(ring, -1))
        beside = np.roll(ring, 1) + np.roll(ring, -1)
        ring = np.stack([(0.75 - 0.5 * ROUND) * ring + (0.125 + 0.25 * ROUND) * beside, middle], 1).ravel()
    return float(np.sqrt(0.5 * np.abs(np.sum(np.conj(ring) * np.roll(ring, -1)).imag) / np.pi))


def place_corners(
    curves: BranchCurves,
    exits: Exits,
    rings: ControlRings,
    drift: Floats,
    steps_left: Ints,
    params: MeshingParams,
) -> RingCorners:
    """Places the rings' corners so far out that the subdivided surface has the skeleton's radius.

    A ring near a base is sheared along its branch toward the host's surface, so that its section across the
    branch stays round. Where a ring would cut the one before it both are turned to a common plane (the
    fallback against folds).

    Args:
        curves: the branches.
        exits: where they leave their hosts.
        rings: where rings stand.
        drift: (c, 3) [m], from where each branch's axis leaves its host to where its face is.
        steps_left: (c,), subdivisions that each branch will see.
        params: root flare, bark scale.
    """
    chain, arc = rings.chain, rings.arc
    center, radius, node = curves.at(chain, arc)
    first = np.flatnonzero(np.diff(chain, prepend=-1))
    last = np.append(first[1:], len(chain)) - 1
    repeats, start = wrap_bark(chain, arc, radius, params.bark_scale)
    one, _, along = curves.frames(chain, arc, 0.5 * radius)
    trunk = chain == 0
    foot = trunk & (arc <= 0.25 * exits.host_radius[0])
    if along[first[0], 1] > 0.5:
        along[foot] = (0.0, 1.0, 0.0)
    flare = np.exp(-arc / (_FLARE_REACH * exits.host_radius[0]))
    radius = np.where(trunk, radius * (1.0 + params.root_flare * flare), radius)

    pushed = center + drifted(chain, arc - arc[first][chain], drift, exits.radius)
    turned = turns_of(chain, center, pushed)
    turned[foot] = np.eye(3)
    center, along = pushed, np.einsum("rij,rj->ri", turned, along)

    factor = np.array([1.0 / shrinkage(steps) for steps in range(int(steps_left.max()) + 1)])
    reach = radius * factor[steps_left[chain]]
    angle = rings.turn[:, None] + 0.5 * np.pi * (np.arange(4) - 0.5)
    corner = np.empty((len(chain), 4, 3))
    inner = np.ones(len(chain), np.bool_)
    inner[first] = False
    for _ in range(4):
        across = unit(one - np.sum(one * along, axis=1, keepdims=True) * along)
        around = np.cross(along, across)
        out = np.cos(angle)[..., None] * across[:, None] + np.sin(angle)[..., None] * around[:, None]
        outward = exits.outward[chain]
        facing = np.maximum(np.sum(outward * along, axis=1), 0.2)
        lift = -np.sum(out * outward[:, None], axis=2) / facing[:, None] * rings.shear[:, None]
        corner = center[:, None] + reach[:, None, None] * (
            out + np.clip(lift, -2.2, 2.2)[..., None] * along[:, None]
        )
        step = corner[1:] - corner[:-1]
        middle = unit(along[1:] + along[:-1])
        folded = np.flatnonzero((np.sum(step * middle[:, None], axis=2) <= 0.0).any(axis=1) & inner[1:])
        if not len(folded):
            break
        turned = along.copy()
        turned[folded] = turned[folded + 1] = unit(middle[folded] + unit(center[folded + 1] - center[folded]))
        along = np.where(foot[:, None], along, turned)
    return RingCorners(corner, node, repeats, start, first, last)


def turns_of(chain: Ints, before: Floats, after: Floats) -> Floats:
    """Rotations (r, 3, 3) that keep rings across their branches when their centres (r, 3) are moved.

    The base keeps its own: it lies in the host's surface.
    """
    first = np.diff(chain, prepend=-1) != 0
    last = np.diff(chain, append=-1) != 0
    ways = []
    for center in (before, after):
        ahead = np.where(last[:, None], center, np.roll(center, -1, axis=0))
        ways.append(unit(ahead - np.roll(center, 1, axis=0)))
    lost = first | (np.linalg.norm(ways[0], axis=1) < 0.5) | (np.linalg.norm(ways[1], axis=1) < 0.5)
    ways[0][lost] = ways[1][lost] = (0.0, 1.0, 0.0)
    return turn_between(ways[0], ways[1])


def drifted(chain: Ints, away: Floats, drift: Floats, radius: Floats) -> Floats:
    """How far rings (r, 3) [m] are moved for branches (c,) that were pushed by drifts (c, 3).

    The first ring on the branch's own axis overshoots a little: subdivision mixes it with the one before.

    Args:
        chain: (r,), the branch of each ring, never falling.
        away: (r,) [m], its distance from the branch's base.
        drift: (c, 3) [m].
        radius: (c,) [m].
    """
    left = _share_left(away, return_from(drift, radius)[chain])
    before = np.where(np.concatenate(([False], chain[1:] == chain[:-1])), np.roll(left, 1), 0.0)
    share = np.where(left > 0.0, left, -_OVERSHOOT * before)
    moved: Floats = share[:, None] * drift[chain]
    return moved


def drift_left(away: Floats, drift: Floats, radius: Floats) -> Floats:
    """What is left (n, 3) [m] of drifts (n, 3) at distances (n,) from the bases of branches."""
    left: Floats = _share_left(away, return_from(drift, radius))[:, None] * drift
    return left


def _share_left(away: Floats, back: Floats) -> Floats:
    """(n,) from 1 at the base to 0 where a branch is back on its axis."""
    share: Floats = np.square(np.clip(1.0 - away / back, 0.0, 1.0))
    return share


def build_tubes(
    rings: ControlRings, corners: RingCorners, branches: Ints, capped: NDArray[np.bool_]
) -> tuple[ControlMesh, Ints, Ints]:
    """The tubes of some branches, closed at their tips.

    Args:
        rings: of all branches.
        corners: of all rings.
        branches: (b,), which to build, growing.
        capped: (c,), branches whose base is closed too; the others stay open there.

    Returns: the mesh; the vertex (r,) of each ring's first corner and the quad (r,) of the first side above
        it, where they are built: side k is k further.
    """
    chosen = np.zeros(len(corners.first), np.bool_)
    chosen[branches] = True
    ring = np.flatnonzero(chosen[rings.chain])
    vertex = np.full(len(rings.chain), -1, np.int64)
    vertex[ring] = 4 * np.arange(len(ring))
    end = np.zeros(len(rings.chain), np.bool_)
    end[corners.last] = True
    low = ring[~end[ring]]
    side = np.arange(4)
    near, far = vertex[low][:, None], vertex[low + 1][:, None]
    after = (side + 1) % 4
    wall = np.stack([near + side, near + after, far + after, far + side], axis=2).reshape(-1, 4)
    u = corners.start[low][:, :1] + corners.repeats[low + 1][:, None] / 4.0 * np.arange(5)
    v, v_next = (np.broadcast_to(corners.start[row, 1][:, None], (len(low), 4)) for row in (low, low + 1))
    left, right = u[:, :-1], u[:, 1:]
    pairs = ((left, v), (right, v), (right, v_next), (left, v_next))
    uvs = np.stack([np.stack(pair, axis=2) for pair in pairs], axis=2)
    hosting = ~np.isin(low, corners.first)

    tip, foot = corners.last[branches], corners.first[branches[capped[branches]]]
    caps = np.concatenate([vertex[tip][:, None] + side, vertex[foot][:, None] + side[::-1]])
    of = np.concatenate([tip, foot])
    # A cap shows the texture around its middle, as large as beside it.
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, -1.0], [0.0, -1.0]])
    cap_uvs = corners.start[of][:, None] + 0.25 * corners.repeats[of][:, None, None] * square
    kinds = np.full(len(of), CLOSED)
    kinds[len(tip) :] = np.where(foot == corners.first[0], FOOT, BASE)
    quad = np.full(len(rings.chain), -1, np.int64)
    quad[low] = 4 * np.arange(len(low))
    mesh = ControlMesh(
        positions=corners.corner[ring].reshape(-1, 3),
        node=np.repeat(corners.node[ring], 4),
        quads=np.concatenate([wall, caps]),
        uvs=np.concatenate([uvs.reshape(-1, 4, 2), cap_uvs]),
        branch=np.concatenate([np.repeat(rings.chain[low], 4), rings.chain[of]]),
        kind=np.concatenate([np.repeat(np.where(hosting, HOSTING, CLOSED), 4), kinds]),
    )
    return mesh, vertex, quad
