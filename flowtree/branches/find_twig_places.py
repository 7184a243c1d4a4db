"""Where twigs could grow on the branches (Particle Flows, section 8)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from flowtree.branches.order_branches import order_branches
from flowtree.branches.shape_twigs import TwigShapes
from flowtree.geometry.frames import side_axes, unit
from flowtree.geometry.parent_array import parents_first, sum_before
from flowtree.geometry.place_chance import place_chance
from flowtree.geometry.place_code import place_code
from flowtree.geometry.whorl_turns import whorl_turns
from flowtree.model.skeleton import Skeleton
from flowtree.params import TwigParams

STREAMS = 8  # random numbers of a place; those from `FREE_STREAM` on are the caller's
FREE_STREAM = 5
_SLIMMER = 0.8  # times its branch's radius, a twig's at most
_COUNT, _TURN, _LEAN, _LENGTH, _SHAPE = range(5)


@dataclass(frozen=True)
class TwigPlaces:
    """Twigs that could grow.

    Attributes:
        node: (m,) the skeleton's node that each grows from.
        points: (m, n, 3) [m], world.
        radius: (m,) at the base [m].
        code: (m,) of the place, for its random numbers.
        number: (m,) the first of them.
    """

    node: NDArray[np.int64]
    points: NDArray[np.float64]
    radius: NDArray[np.float64]
    code: NDArray[np.int64]
    number: NDArray[np.int64]

    def take(self, which: NDArray[np.bool_]) -> TwigPlaces:
        """Some of them."""
        return TwigPlaces(
            self.node[which], self.points[which], self.radius[which], self.code[which], self.number[which]
        )


def find_twig_places(
    skeleton: Skeleton,
    shapes: TwigShapes,
    *,
    bears: NDArray[np.bool_],
    frequency: float,
    length: float,
    height: float,
    params: TwigParams,
    seed: int,
) -> TwigPlaces:
    """Twigs in phyllotactic order along each branch, as dense as asked for.

    Args:
        skeleton: branches with radii.
        shapes: of the twigs, of which each place takes one by chance.
        bears: (n,) nodes whose segment bears twigs.
        frequency: of the places [1/m].
        length: mean, of a twig [m].
        height: of the tree [m].
        params: divergence, whorl, angle, plagiotropism, rigidity, radius.
        seed: of the bends.
    """
    parent = skeleton.parent
    segment = skeleton.points.astype(np.float64) - skeleton.points[np.maximum(parent, 0)]
    codes = place_code(skeleton.points, height)
    wanted = np.linalg.norm(segment, axis=1) * frequency * bears
    whorls = np.floor(wanted / params.whorl + place_chance(codes, seed, _COUNT)).astype(np.int64)
    count = params.whorl * whorls
    before = sum_before(parent, count)  # the spiral goes on over the nodes
    node = np.repeat(np.arange(len(parent)), count)
    index = np.arange(len(node)) - np.repeat(np.cumsum(count) - count, count)
    code, number = codes[node], (1 + index) * STREAMS

    def between(low: float, high: float, stream: int) -> NDArray[np.float64]:
        return low + (high - low) * place_chance(code, seed, number + stream)

    axis = unit(segment[node])
    first, second = side_axes(axis)
    jitter = 12.0 * ndtri(between(1e-9, 1.0 - 1e-9, _TURN))
    turn = np.radians(whorl_turns(index + before[node], params.whorl, params.divergence) + jitter)[:, None]
    lean = np.radians(params.angle * between(0.7, 1.2, _LEAN))[:, None]
    along = np.cos(lean) * axis + np.sin(lean) * (np.cos(turn) * first + np.sin(turn) * second)
    level = unit(along * np.array([1.0, 1.0 - params.plagiotropism, 1.0]))
    along = np.where(level.any(axis=1, keepdims=True), level, along)  # what stands upright bends nowhere
    over, aside = side_axes(along)
    long = length * between(0.4, 1.45, _LENGTH)
    kinds = len(shapes.points)
    which = np.minimum(between(0.0, kinds, _SHAPE).astype(np.int64), kinds - 1)
    shape = shapes.points[which] * long[:, None, None]
    points = shape @ np.stack([-aside, along, over], axis=1)
    points[..., 1] -= (1.0 - params.rigidity) * shape[..., 1] ** 2 / long[:, None]
    radius = np.minimum(params.radius * height, _SLIMMER * skeleton.radius[node])
    return TwigPlaces(node, points + skeleton.points[node, None], radius, code, number)


def append_twigs(skeleton: Skeleton, shapes: TwigShapes, twigs: TwigPlaces) -> Skeleton:
    """The skeleton with the twigs' nodes behind its own, in an order that keeps parents first."""
    count, nodes = len(twigs.node), len(shapes.parent)
    first = len(skeleton.parent) + np.arange(count)[:, None] * nodes
    own = np.where(shapes.parent >= 0, first + shapes.parent, twigs.node[:, None]).ravel()
    order, parent = parents_first(np.concatenate([skeleton.parent, own]))
    points = np.concatenate([skeleton.points, twigs.points.reshape(-1, 3).astype(np.float32)])
    radius = np.concatenate([skeleton.radius, (twigs.radius[:, None] * shapes.thickness).ravel()])
    particles = np.concatenate([skeleton.particles, np.ones(count * nodes, np.int32)])
    return Skeleton(
        parent=parent,
        points=points[order],
        radius=radius[order].astype(np.float32),
        particles=particles[order],
        level=order_branches(parent, radius[order]),
        twig=np.concatenate([skeleton.twig, np.ones(count * nodes, np.bool_)])[order],
    )
