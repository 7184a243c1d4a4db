/** What the viewer shows of the way to the tree: voxels, the direction field, flowing particles, the skeleton. */

import { THREE } from "nicegui-scene";

const ORDER_COLORS = ["#8a5a3c", "#d9823b", "#e8c547", "#6fbf73", "#4aa3c7", "#8f7ad6", "#d46fb0"].map(
  (color) => new THREE.Color(color),
);

function attribute(array, size) {
  return new THREE.BufferAttribute(array, size);
}

/** Points as large as their voxels, denser ones brighter. */
export function voxelCloud({ edge, centres, density }) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", attribute(centres, 3));
  geometry.setAttribute("density", new THREE.BufferAttribute(density, 1, true));
  const material = new THREE.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms: { edge: { value: edge }, scale: { value: 1 } },
    vertexShader: `
      attribute float density; uniform float edge; uniform float scale; varying vec4 color;
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        gl_PointSize = max(1.0, 1.7 * edge * projectionMatrix[1][1] * scale / gl_Position.w);
        float d = sqrt(density);
        color = vec4(mix(vec3(0.05, 0.22, 0.36), vec3(0.75, 0.9, 0.35), d), 0.04 + 0.4 * d);
      }`,
    fragmentShader: `
      varying vec4 color;
      void main() {
        float r = length(gl_PointCoord - 0.5);
        if (r > 0.5) discard;
        gl_FragColor = vec4(color.rgb, color.a * smoothstep(0.5, 0.2, r));
        #include <colorspace_fragment>
      }`,
  });
  const cloud = new THREE.Points(geometry, material);
  cloud.frustumCulled = false;
  cloud.renderOrder = 1; // seen through: what is in it is drawn over it
  return cloud;
}

/** A short line for every arrow, faint where it starts. */
export function fieldArrows(arrows, length) {
  const count = arrows.length / 6;
  const positions = new Float32Array(6 * count);
  const colors = new Float32Array(8 * count);
  for (let i = 0; i < count; i += 1) {
    const [x, y, z, dx, dy, dz] = arrows.subarray(6 * i, 6 * i + 6);
    positions.set([x, y, z, x + dx * length, y + dy * length, z + dz * length], 6 * i);
    const color = new THREE.Color().setHSL(0.58 - 0.36 * Math.max(dy, -dy * 0.2) - 0.18 * Math.hypot(dx, dz), 0.75, 0.6);
    colors.set([color.r, color.g, color.b, 0.05, color.r, color.g, color.b, 0.95], 8 * i);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", attribute(positions, 3));
  geometry.setAttribute("color", attribute(colors, 4));
  const material = new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false });
  const lines = new THREE.LineSegments(geometry, material);
  lines.renderOrder = 2;
  return lines;
}

/** Particles on their way down, with trails; `setTime` takes steps of the flow. */
export function flowParticles({ parent, points, step, particles }) {
  const moving = [];
  for (let i = 0; i < parent.length; i += 1) if (parent[i] >= 0) moving.push(i);
  const start = new Float32Array(3 * moving.length);
  const goal = new Float32Array(3 * moving.length);
  const span = new Float32Array(2 * moving.length);
  const mass = new Float32Array(moving.length);
  const trail = new Float32Array(6 * moving.length);
  const times = new Float32Array(2 * moving.length);
  moving.forEach((i, k) => {
    const from = points.subarray(3 * i, 3 * i + 3);
    const to = points.subarray(3 * parent[i], 3 * parent[i] + 3);
    start.set(from, 3 * k);
    goal.set(to, 3 * k);
    span.set([step[i], Math.max(step[parent[i]], step[i] + 1)], 2 * k);
    mass[k] = particles[i];
    trail.set(from, 6 * k);
    trail.set(to, 6 * k + 3);
    times.set([step[i], step[parent[i]]], 2 * k);
  });
  const uniforms = { time: { value: 0 }, tail: { value: 40 }, scale: { value: 1 } };
  const group = new THREE.Group();
  group.add(trailLines(trail, times, uniforms), fronts(start, goal, span, mass, uniforms));
  group.setTime = (time, last) => {
    uniforms.time.value = time;
    uniforms.tail.value = last * 0.12;
  };
  group.setScale = (scale) => {
    uniforms.scale.value = scale;
  };
  return group;
}

function trailLines(trail, times, uniforms) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", attribute(trail, 3));
  geometry.setAttribute("when", attribute(times, 1));
  const material = new THREE.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms,
    vertexShader: `
      attribute float when; uniform float time; uniform float tail; varying float strength;
      void main() {
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        strength = when > time ? -1.0 : 0.16 + 0.6 * exp((when - time) / tail);
      }`,
    fragmentShader: `
      varying float strength;
      void main() {
        if (strength < 0.0) discard;
        gl_FragColor = vec4(mix(vec3(0.08, 0.3, 0.5), vec3(0.9, 0.5, 0.1), strength), strength);
        #include <colorspace_fragment>
      }`,
  });
  const lines = new THREE.LineSegments(geometry, material);
  lines.frustumCulled = false;
  lines.renderOrder = 3;
  return lines;
}

function fronts(start, goal, span, mass, uniforms) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", attribute(start, 3));
  geometry.setAttribute("goal", attribute(goal, 3));
  geometry.setAttribute("span", attribute(span, 2));
  geometry.setAttribute("mass", attribute(mass, 1));
  const material = new THREE.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    uniforms,
    vertexShader: `
      attribute vec3 goal; attribute vec2 span; attribute float mass;
      uniform float time; uniform float scale; varying float heavy;
      void main() {
        float share = (time - span.x) / (span.y - span.x);
        bool here = share >= 0.0 && share < 1.0;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(mix(position, goal, clamp(share, 0.0, 1.0)), 1.0);
        if (!here) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        heavy = min(log(mass) / 7.0, 1.0);
        gl_PointSize = (2.6 + 7.0 * heavy) * scale;
      }`,
    fragmentShader: `
      varying float heavy;
      void main() {
        float r = length(gl_PointCoord - 0.5);
        if (r > 0.5) discard;
        vec3 color = mix(vec3(0.55, 0.85, 1.0), vec3(1.0, 0.78, 0.36), heavy);
        gl_FragColor = vec4(color, smoothstep(0.5, 0.3, r));
        #include <colorspace_fragment>
      }`,
  });
  const dots = new THREE.Points(geometry, material);
  dots.frustumCulled = false;
  dots.renderOrder = 4;
  return dots;
}

/** Every segment a ribbon that faces the viewer, as thick as the branch, never thinner than a pixel. */
export function skeletonRibbons(segments, by) {
  const count = segments.length / 10;
  const buffer = new THREE.InstancedInterleavedBuffer(segments, 10);
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.instanceCount = count;
  geometry.setAttribute("position", attribute(new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.setAttribute("head", new THREE.InterleavedBufferAttribute(buffer, 4, 0));
  geometry.setAttribute("tail", new THREE.InterleavedBufferAttribute(buffer, 4, 4));
  geometry.setAttribute("tint", new THREE.InstancedBufferAttribute(tints(segments, by), 3));
  const material = new THREE.ShaderMaterial({
    side: THREE.DoubleSide,
    uniforms: { resolution: { value: new THREE.Vector2(1, 1) }, least: { value: 0.8 } },
    vertexShader: `
      attribute vec4 head; attribute vec4 tail; attribute vec3 tint;
      uniform vec2 resolution; uniform float least; varying vec3 color; varying float across;
      void main() {
        vec4 a = projectionMatrix * modelViewMatrix * vec4(head.xyz, 1.0);
        vec4 b = projectionMatrix * modelViewMatrix * vec4(tail.xyz, 1.0);
        vec2 along = (b.xy / b.w - a.xy / a.w) * resolution + vec2(1e-4, 0.0);
        along = normalize(along);
        vec4 at = mix(a, b, position.x);
        float radius = mix(head.w, tail.w, position.x);
        float pixels = max(radius * projectionMatrix[1][1] * resolution.y * 0.5 / at.w, least);
        vec2 offset = vec2(-along.y, along.x) * position.y * pixels + along * (position.x * 2.0 - 1.0) * pixels * 0.35;
        at.xy += offset * 2.0 / resolution * at.w;
        gl_Position = at;
        color = tint;
        across = position.y;
      }`,
    fragmentShader: `
      varying vec3 color; varying float across;
      void main() {
        gl_FragColor = vec4(color * (1.0 - 0.35 * across * across), 1.0);
        #include <colorspace_fragment>
      }`,
  });
  const ribbons = new THREE.Mesh(geometry, material);
  ribbons.frustumCulled = false;
  return ribbons;
}

/** A colour a segment: by the branch's order, or by its thickness. */
export function tints(segments, by) {
  const count = segments.length / 10;
  const colors = new Float32Array(3 * count);
  let thickest = 1e-6;
  for (let i = 0; i < count; i += 1) thickest = Math.max(thickest, segments[10 * i + 3]);
  const color = new THREE.Color();
  for (let i = 0; i < count; i += 1) {
    if (by === "order") {
      color.copy(ORDER_COLORS[Math.min(segments[10 * i + 8], ORDER_COLORS.length - 1)]);
    } else {
      const share = Math.min(Math.max(1 + Math.log10(segments[10 * i + 3] / thickest) / 2.2, 0), 1);
      color.setHSL(0.33 - 0.27 * share, 0.45 + 0.15 * share, 0.66 - 0.2 * share);
    }
    colors.set([color.r, color.g, color.b], 3 * i);
  }
  return colors;
}
