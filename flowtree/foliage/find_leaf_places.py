"""Where leaves could hang on the twigs (Particle Flows, section 8)."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from flowtree.geometry.frames import quaternions, side_axes, unit
from flowtree.geometry.parent_array import sum_before
from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.place_code import place_code
from flowtree.geometry.whorl_turns import whorl_turns
from flowtree.model.skeleton import Skeleton
from flowtree.params import LeafParams

_STREAMS = 16  # random numbers of a place; those from `FREE_STREAM` on are the caller's
FREE_STREAM = 9
_COUNT, _WAY, _TURN, _LEAN, _BEND, _ROLL, _SIZE = 0, 1, 2, 3, 4, 7, 8


@dataclass(frozen=True)
class LeafPlaces:
    """Leaves that could grow.

    Attributes:
        node: (m,) the skeleton's node on whose segment each grows.
        length: (m,) [m].
        position: (m, 3) stalk's end [m].
        along: (m, 3) unit, the blade's.
        normal: (m, 3) unit, the upper side's.
        code: (m,) of the node, for the place's random numbers.
        number: (m,) the first of them.
    """

    node: NDArray[np.int64]
    length: NDArray[np.float64]
    position: NDArray[np.float64]
    along: NDArray[np.float64]
    normal: NDArray[np.float64]
    code: NDArray[np.int64]
    number: NDArray[np.int64]

    @property
    def centre(self) -> NDArray[np.float64]:
        """(m, 3) middle of the blade [m]."""
        return self.position + 0.5 * self.length[:, None] * self.along

    @property
    def rotation(self) -> NDArray[np.float64]:
        """(m, 4) unit quaternions (x, y, z, w), from the leaf's frame to the world."""
        return quaternions(np.cross(self.along, self.normal), self.along, self.normal)

    def take(self, which: NDArray[np.bool_]) -> LeafPlaces:
        """Some of them."""
        return LeafPlaces(**{field.name: getattr(self, field.name)[which] for field in fields(self)})


def bearing_way(skeleton: Skeleton, params: LeafParams) -> NDArray[np.float64]:
    """Length of each node's segment that bears leaves [m], (n,): on twigs and thin branches."""
    parent = skeleton.parent
    segment = skeleton.points.astype(np.float64) - skeleton.points[np.maximum(parent, 0)]
    bears = (parent >= 0) & (skeleton.twig | (skeleton.particles <= params.bearing_particles))
    return np.asarray(np.linalg.norm(segment, axis=1) * bears)


def find_leaf_places(
    skeleton: Skeleton, *, rate: float, length: float, height: float, params: LeafParams, seed: int
) -> LeafPlaces:
    """Places in phyllotactic order along everything thin, by the Golden Section rule.

    Args:
        skeleton: with twigs.
        rate: of the places along what bears leaves [1/m].
        length: mean, of a leaf [m].
        height: of the tree [m].
        params: divergence, whorl, angle, plagiotropism, hang.
        seed: of all that is random.
    """
    parent = skeleton.parent
    segment = skeleton.points.astype(np.float64) - skeleton.points[np.maximum(parent, 0)]
    way = bearing_way(skeleton, params)
    codes = place_code(skeleton.points, height)
    whorls = np.floor(way * rate / params.whorl + place_chance(codes, seed, _COUNT)).astype(np.int64)
    count = params.whorl * whorls * (way > 0)
    before = sum_before(parent, count)
    node = np.repeat(np.arange(len(parent)), count)
    index = np.arange(len(node)) - np.repeat(np.cumsum(count) - count, count)
    code, number = codes[node], (1 + index) * _STREAMS

    def between(low: float, high: float, stream: int) -> NDArray[np.float64]:
        return low + (high - low) * place_chance(code, seed, number + stream)

    def normal(stream: int) -> NDArray[np.float64]:
        return np.asarray(ndtri(between(1e-9, 1.0 - 1e-9, stream)))

    # All leaves of a whorl stand where its first one does.
    step = index // params.whorl
    along_step = place_chance(code, seed, (1 + step * params.whorl) * _STREAMS + _WAY)
    share = (step + along_step) / np.maximum(count[node] // params.whorl, 1)
    position = skeleton.points[node] - segment[node] * (1.0 - share[:, None])
    axis = unit(segment[node])
    first, second = side_axes(axis)
    turned = whorl_turns(before[node] + index, params.whorl, params.divergence)
    turn = np.radians(turned + 20.0 * normal(_TURN))[:, None]
    lean = np.radians(params.angle * between(0.6, 1.3, _LEAN))[:, None]
    along = np.cos(lean) * axis + np.sin(lean) * (np.cos(turn) * first + np.sin(turn) * second)
    bend = 0.15 * np.stack([normal(_BEND + k) for k in range(3)], axis=1)
    along = unit(along + np.array([0.0, -params.hang, 0.0]) + bend)
    over, aside = side_axes(along)
    roll = normal(_ROLL) * (1.0 - params.plagiotropism) * np.pi / 2
    upper = np.cos(roll)[:, None] * over + np.sin(roll)[:, None] * aside
    return LeafPlaces(node, length * between(0.75, 1.25, _SIZE), position, along, upper, code, number)
