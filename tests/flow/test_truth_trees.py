"""Trees of which everything is known: what flows must be one trunk near the foot."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from flowtree.attraction.build_direction_field import build_direction_field
from flowtree.attraction.trace_attractor_graph import trace_attractor_graph
from flowtree.density.solve_density import solve_density
from flowtree.flow.trace_particles import trace_particles
from flowtree.model.camera import Camera
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo

TRUTH = Path(__file__).parents[2] / ".." / "shared" / "data" / "truth"


def _view(folder, view):
    picture = np.asarray(Image.open(folder / view["file"]))
    alpha = picture[..., 3].astype(np.float32) / 255
    camera = Camera(
        view["yaw"], view["metres_per_pixel"], tuple(view["foot_pixel"]), alpha.shape[1], alpha.shape[0]
    )
    return Photo(view["file"], picture[..., :3], alpha), Matte(alpha, picture[..., :3], "alpha"), camera


@pytest.mark.skipif(not TRUTH.is_dir(), reason="the test data beside the project is not there")
@pytest.mark.parametrize("name", ["aspen", "birch", "maple_bare", "willow"])
def test_nearly_all_particles_come_down_one_trunk(name):
    folder = TRUTH / name
    truth = json.loads((folder / "truth.json").read_text(encoding="utf-8"))
    views = [
        _view(folder, v) for v in truth["views"] if v["projection"] == "orthographic" and v["yaw"] in (0, 90)
    ]
    volume = solve_density([matte for _, matte, _ in views], [camera for *_, camera in views])
    fields = [
        build_direction_field(trace_attractor_graph(photo, matte, camera), camera)
        for photo, matte, camera in views
    ]
    traces = trace_particles(volume, fields)
    above, below = traces.points[1:, 1], traces.points[traces.parent[1:], 1]
    for share in (0.02, 0.05, 0.1):
        passing = traces.particles[1:][(above > share * truth["height"]) & (below <= share * truth["height"])]
        assert passing.max() > 0.97 * passing.sum(), f"at {share} of the height"
    arriving = traces.particles[traces.parent == 0]
    assert arriving.max() > 0.97 * traces.particles[0]
    steps = np.linalg.norm(traces.points[1:] - traces.points[traces.parent[1:]], axis=1)
    assert steps.max() < 0.12 * truth["height"], "nothing is wired straight to the foot"
