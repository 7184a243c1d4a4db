/**
 * Photos side by side on a common foot line and a common top line, as the tree stands in all of them.
 *
 * A photo's marks are the tree's foot [x, y] and the row of its top, in its own pixels. Placing a photo means: its
 * foot on the foot line, its top on the top line. Dragging and scaling a placed photo means: other marks.
 */

/**
 * Where a photo is drawn.
 *
 * @param {{foot: [number, number], top: number}} marks
 * @param {{foot: number, top: number}} lines rows on the board
 * @param {number} axis column on the board where the tree stands
 * @returns {{scale: number, x: number, y: number}} board = photo * scale + (x, y)
 */
export function place(marks, lines, axis) {
  const scale = (lines.foot - lines.top) / Math.max(marks.foot[1] - marks.top, 1);
  return { scale, x: axis - marks.foot[0] * scale, y: lines.foot - marks.foot[1] * scale };
}

/** The marks of a photo that is drawn at a place: the inverse of `place`. */
export function marksAt(placed, lines, axis) {
  return {
    foot: [(axis - placed.x) / placed.scale, (lines.foot - placed.y) / placed.scale],
    top: (lines.top - placed.y) / placed.scale,
  };
}

/** A placed photo, scaled about a point of the board that stays where it is. */
export function rescale(placed, factor, [x, y]) {
  return {
    scale: placed.scale * factor,
    x: x - (x - placed.x) * factor,
    y: y - (y - placed.y) * factor,
  };
}

/**
 * Columns for photos that stand beside each other in a frame, with the tree in the middle of each, and the lines
 * that they share. A photo may be wider than its column: what counts is the tree.
 *
 * @param {number} count of photos
 * @returns {{columns: [number, number][], axes: number[], lines: {foot: number, top: number}}} left and right end
 *   and middle of every column; rows of the lines
 */
export function layOut(count, frameWidth, frameHeight, gap = 10) {
  const wide = (frameWidth - gap * (count + 1)) / Math.max(count, 1);
  // Most crowns are narrower than their tree is high.
  const high = Math.max(Math.min(wide / 0.92, frameHeight * 0.8), 20);
  const top = (frameHeight - high) / 2 - 0.02 * high;
  const columns = Array.from({ length: count }, (_, i) => {
    const left = gap + i * (wide + gap);
    return [left, left + wide];
  });
  const axes = columns.map(([left, right]) => (left + right) / 2);
  return { columns, axes, lines: { foot: top + high, top } };
}

/** Degrees on the compass of a point around its middle: 0 below (the front), 90 to the right, -180 to 180. */
export function yawAt(dx, dy, step = 5) {
  const degrees = (Math.atan2(dx, dy) * 180) / Math.PI;
  const rounded = Math.round(degrees / step) * step;
  return rounded <= -180 ? rounded + 360 : rounded + 0; // + 0: no negative zero
}

/** The point on the compass's rim for a yaw. */
export function rimAt(yaw, radius) {
  const angle = (yaw * Math.PI) / 180;
  return [Math.sin(angle) * radius, Math.cos(angle) * radius];
}
