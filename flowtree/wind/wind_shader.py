"""The recipe by which a vertex shader moves a tree, in GLSL (ES 3.00)."""

from __future__ import annotations

#: `sway` moves a vertex at rest, in the tree's own frame [m], by what `name_channels` writes. ``wind`` is the
#: wind's direction, level, times its strength (1 is a gentle breeze), ``time`` in seconds, ``flutter`` the
#: way that the tips of the largest leaves go [m], about a tenth of their length. Each tier turns around its
#: own pivot by its extent: lengths stay, and what hangs on a branch goes with it. With quantised places
#: (KHR_mesh_quantization) apply the node's matrix first; where texture coordinates carry the values see
#: `name_channels`.
WIND_SHADER = """\
vec3 turn(vec3 place, vec3 pivot, vec3 turning) {  // around the pivot; turning is axis times angle
    float angle = max(length(turning), 1e-6);
    vec3 axis = turning / angle, arm = place - pivot;
    return pivot + arm * cos(angle) + cross(axis, arm) * sin(angle)
        + axis * dot(axis, arm) * (1.0 - cos(angle));
}
vec3 swing(vec3 wind, float cycles) {  // a lean with the wind, and a swing along and across it
    vec3 along = cross(vec3(0.0, 1.0, 0.0), wind);
    float beat = sin(6.2832 * cycles), slow = sin(6.2832 * 0.31 * cycles);
    return along * (0.35 + 0.25 * slow + 0.4 * beat) + 0.4 * wind * sin(6.2832 * 0.83 * cycles);
}
vec3 sway(vec3 place, vec3 normal, vec3 limb, vec3 branch, vec4 extent, vec4 phase,
          vec3 wind, float time, float flutter) {
    place += normal * (length(wind) * flutter * extent.w * sin(6.2832 * (1.7 * time + phase.z)));
    place = turn(place, branch, 0.12 * extent.z * swing(wind, 0.9 * time + phase.y));
    place = turn(place, limb, 0.09 * extent.y * swing(wind, 0.55 * time + phase.x));
    return turn(place, vec3(0.0), 0.035 * extent.x * swing(wind, 0.25 * time));
}
"""
