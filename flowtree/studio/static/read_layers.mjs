/** The studio's layers of numbers, as its server sends them: little endian, arrays one after another. */

/** @returns {{edge: number, densest: number, centres: Float32Array, density: Uint8Array}} metres; 255 is densest */
export function readVoxels(buffer) {
  const view = new DataView(buffer);
  const count = view.getUint32(0, true);
  return {
    edge: view.getFloat32(4, true),
    densest: view.getFloat32(8, true),
    centres: new Float32Array(buffer, 12, 3 * count),
    density: new Uint8Array(buffer, 12 + 12 * count, count),
  };
}

/** @returns {Float32Array} place and direction (six numbers) of every arrow */
export function readField(buffer) {
  return new Float32Array(buffer, 4, 6 * new DataView(buffer).getUint32(0, true));
}

/**
 * Where particles went: nodes that each lead on to a parent.
 *
 * @returns {{parent: Int32Array, points: Float32Array, step: Int32Array, particles: Int32Array, last: number}}
 */
export function readFlow(buffer) {
  const count = new DataView(buffer).getUint32(0, true);
  const step = new Int32Array(buffer, 4 + 16 * count, count);
  return {
    parent: new Int32Array(buffer, 4, count),
    points: new Float32Array(buffer, 4 + 4 * count, 3 * count),
    step,
    particles: new Int32Array(buffer, 4 + 20 * count, count),
    last: step.reduce((most, now) => Math.max(most, now), 1),
  };
}

/** @returns {Float32Array} x0 y0 z0 r0 x1 y1 z1 r1 order twig of every segment */
export function readSkeleton(buffer) {
  return new Float32Array(buffer, 4, 10 * new DataView(buffer).getUint32(0, true));
}
