"""The direction field in space around the limbs (Particle Flows, section 7)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter
from scipy.spatial import cKDTree

from flowtree.attraction.branch_levels import branch_levels
from flowtree.geometry.polylines import nearest_on_segments
from flowtree.model.attractor import Habit, LimbTree
from flowtree.model.field import LimbField
from flowtree.model.volume import DensityVolume
from flowtree.params import FieldParams

_POINTS = 56  # along the height, of the box: limbs a fiftieth of the height apart have fields of their own
_FAR = 1.6  # reaches, beyond which the views' own fields lead

#: How much higher than its foot on the limb a branch's outer end is, for its length to the side.
_CLIMB: dict[Habit, float] = {
    "upright": 0.8,
    "spreading": 0.0,
    "weeping": -0.5,
    "conifer": -0.15,
    "palm": 0.0,
}

_Array = NDArray[np.float64]


def build_limb_field(
    limbs: LimbTree,
    volume: DensityVolume,
    *,
    habit: Habit = "spreading",
    params: FieldParams = FieldParams(),
) -> LimbField:
    """Directions that lead to the nearest limb and along it to the foot: equation 3, but in space.

    The average of the views' 2D fields leads to every place at which a line of one view crosses a line of
    another, limb or not. Around the limbs in space this field takes its place; far from all of them the
    views' fields are left to lead.

    Deviations: far from a limb the direction to it is lifted or lowered, as far as the habit says, so that
    branches hang from their limbs or climb from them; under constant blending every level of limbs has an
    angle of its own.

    Args:
        limbs: the root at the origin.
        volume: the field is asked for where it holds density.
        habit: says how steeply branches climb where ``params.climb`` does not.
        params: as for the views' fields: reach, blending, angle; besides the angles of the levels.

    Returns: vectors of length 1 within ``params.reach`` of a limb, falling to 0 farther away.
    """
    shape = np.array(volume.density.shape)
    stride = max(1.0, shape[1] / _POINTS, shape.max() / (2 * _POINTS))
    spacing = stride * float(volume.voxel)
    counts = np.ceil(shape / stride).astype(int) + 2
    corner = volume.origin.astype(np.float64) - 0.5 * spacing
    index = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    place = corner + index * spacing
    voxel = np.clip(np.floor((place - volume.origin) / volume.voxel).astype(int), 0, shape - 1)
    crown = maximum_filter(volume.density > 0, size=3)
    asked = crown[tuple(np.moveaxis(voxel, -1, 0))]
    line = limbs.points.astype(np.float64)
    height = float(shape[1]) * float(volume.voxel)
    vectors = np.zeros((*counts, 3), np.float32)
    climb = _CLIMB[habit] if params.climb is None else params.climb
    vectors[asked] = _vectors(place[asked], limbs.parent, line, params, params.reach * height, climb)
    return LimbField(vectors, corner.astype(np.float32), spacing)


def _vectors(
    place: _Array,
    parent: NDArray[np.int32],
    line: _Array,
    params: FieldParams,
    reach: float,
    climb: float,
) -> NDArray[np.float32]:
    """The field (n, 3) at places (n, 3)."""
    child = np.arange(1, len(line))
    middle = 0.5 * (line[parent[child]] + line[child])
    segment = cKDTree(middle).query(place)[1]
    start, end = line[parent[child]][segment], line[child][segment]
    _, nearest = nearest_on_segments(place, start, end)
    offset = nearest - place
    distance = np.linalg.norm(offset, axis=1)
    if params.blending == "linear":
        h = np.clip(distance / reach, 0.0, 1.0)
    else:
        angles = np.array(params.angles or (params.angle,))
        level = branch_levels(parent, line)[child][segment]
        turn = np.radians(angles[np.minimum(level, len(angles) - 1)])
        h = np.sin(turn) / (np.sin(turn) + np.cos(turn))
    toward = offset / np.maximum(distance, 1e-12)[:, None]
    # The particle flows down the branch that will be: where branches climb it comes from above.
    toward[:, 1] -= climb * np.clip(distance / reach, 0.0, 1.0)
    toward /= np.maximum(np.linalg.norm(toward, axis=1, keepdims=True), 1e-12)
    tangent = start - end
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    force = h[:, None] * toward + (1.0 - h[:, None]) * tangent
    size = np.linalg.norm(force, axis=1)
    trust = np.clip((_FAR - distance / reach) / (_FAR - 1.0), 0.0, 1.0) * np.minimum(size / 0.1, 1.0)
    return np.asarray(force / np.maximum(size, 1e-12)[:, None] * trust[:, None], np.float32)
