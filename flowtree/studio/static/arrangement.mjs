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
 * The columns of the trees' axes, so that photos stand beside each other in a frame, and the lines they share.
 *
 * @param {{width: number, height: number, marks: {foot: [number, number], top: number}}[]} photos
 * @returns {{axes: number[], lines: {foot: number, top: number}}} the lines are the same fraction for all
 */
export function layOut(photos, frameWidth, frameHeight, gap = 12) {
  // With trees one unit high: how far every photo reaches to the left and right of its axis, up and down.
  const units = photos.map(({ width, height, marks }) => {
    const tall = Math.max(marks.foot[1] - marks.top, 1);
    return {
      left: marks.foot[0] / tall,
      right: (width - marks.foot[0]) / tall,
      above: marks.top / tall,
      below: (height - marks.foot[1]) / tall,
    };
  });
  const most = (name) => Math.max(...units.map((unit) => unit[name]), 0);
  const across = units.reduce((sum, unit) => sum + unit.left + unit.right, 0);
  const down = 1 + Math.max(most("above"), 0.05) + Math.max(most("below"), 0.05);
  const unit = Math.max(
    Math.min((frameWidth - gap * (photos.length + 1)) / across, (frameHeight - 2 * gap) / down),
    10,
  );
  const top = (frameHeight - down * unit) / 2 + Math.max(most("above"), 0.05) * unit;
  let x = (frameWidth - across * unit - gap * (photos.length - 1)) / 2;
  const axes = units.map(({ left, right }) => {
    const axis = x + left * unit;
    x = axis + right * unit + gap;
    return axis;
  });
  return { axes, lines: { foot: top + unit, top } };
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
