/**
 * How the photos are being arranged, told by the board and heard by the viewer at once: what the server makes of it
 * comes later. A photo is arranged by its yaw and by foot [x, y] and top (a row) in its own pixels.
 */

const listeners = new Set();
let arranged = []; // of every photo {yaw, foot, top}

/** @param {{yaw: number, foot: [number, number], top: number}[]} photos */
export function tellArranged(photos) {
  if (JSON.stringify(photos) === JSON.stringify(arranged)) return;
  arranged = photos;
  for (const listener of listeners) listener(arranged);
}

/** @returns {() => void} ends the listening */
export function onArranged(listener) {
  listeners.add(listener);
  listener(arranged);
  return () => listeners.delete(listener);
}

/** Where a view's camera saw foot and top, in pixels of its upright photo, and metres a pixel there. */
export function seenEnds({ warp: m, foot: [px, py], metres_per_pixel: mpp, placed }) {
  const move = (x, y) => {
    const w = m[2][0] * x + m[2][1] * y + m[2][2];
    return [(m[0][0] * x + m[0][1] * y + m[0][2]) / w, (m[1][0] * x + m[1][1] * y + m[1][2]) / w];
  };
  const foot = move(px, py);
  const [x, y] = move(px, py - 1);
  return { foot, top: placed.top_row, scale: mpp / Math.max(Math.hypot(x - foot[0], y - foot[1]), 1e-9) };
}

/**
 * What arranging a photo anew makes of the picture that a view has of it.
 *
 * @param {object} view as the layer "cameras" lists it
 * @param {{yaw: number, foot: [number, number], top: number}} photo as it is arranged now
 * @returns {{scale: number, aside: number, up: number, turn: number}} how much larger it is, by how many metres it
 *   moves to the right and up, by how many radians it turns
 */
export function arrangedAnew(view, photo) {
  const seen = seenEnds(view);
  const scale = (seen.foot[1] - seen.top) / Math.max(photo.foot[1] - photo.top, 1);
  return {
    scale,
    aside: (seen.foot[0] - photo.foot[0]) * scale * seen.scale,
    up: (photo.foot[1] - seen.foot[1]) * scale * seen.scale,
    turn: view.mirrored ? 0 : ((photo.yaw - view.yaw) * Math.PI) / 180,
  };
}
