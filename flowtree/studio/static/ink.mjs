/** How what was drawn on a photo looks: scribbles, branches, density. The context's units are the photo's pixels. */

export const LABEL_COLORS = {
  tree: "#59c36a",
  background: "#f0506e",
  unknown: "#b9a7e6",
  occluder: "#4aa3ff",
};
export const BRANCH_COLOR = "#ffb454";
export const PAINT_COLORS = { add: "#7ddc6f", erase: "#ff6b57", direct: "#ffd166" };

function trace(context, points) {
  context.beginPath();
  context.moveTo(points[0][0], points[0][1]);
  if (points.length === 1) context.lineTo(points[0][0] + 0.01, points[0][1]);
  for (let i = 1; i < points.length; i += 1) context.lineTo(points[i][0], points[i][1]);
}

/** A line of one width with round ends; one point is a dot. */
export function drawLine(context, points, color, width, alpha = 1) {
  if (points.length === 0) return;
  context.save();
  context.lineCap = context.lineJoin = "round";
  context.strokeStyle = color;
  context.globalAlpha = alpha;
  context.lineWidth = width;
  trace(context, points);
  context.stroke();
  context.restore();
}

/** A line that stands out from any picture: dark beside, bright within. */
export function drawWire(context, points, color, width, dashed = false) {
  if (points.length === 0) return;
  drawLine(context, points, "rgba(10, 14, 12, 0.55)", width * 2.2);
  context.save();
  if (dashed) context.setLineDash([width * 3, width * 2.5]);
  drawLine(context, points, color, width);
  context.restore();
}

/**
 * Widths and opacities of strokes laid over each other that together make a soft brush: full in its inner part,
 * falling smoothly to nothing at its rim.
 *
 * @param {number} softness share of the radius that falls off, 0 to 1
 * @param {number} strength 0 to 1
 * @returns {[number, number][]} [share of the width, opacity], the widest first
 */
export function softLayers(softness, strength, count = 8) {
  const layers = [];
  let before = 0;
  for (let i = 0; i < count; i += 1) {
    const fall = (i + 1) / count;
    const wanted = strength * fall * fall * (3 - 2 * fall);
    layers.push([1 - softness * ((i + 0.5) / count), Math.min((wanted - before) / (1 - before || 1), 1)]);
    before = wanted;
  }
  return layers;
}

export function drawSoft(context, points, color, width, softness, strength) {
  for (const [share, alpha] of softLayers(softness, strength)) {
    drawLine(context, points, color, width * share, alpha * 0.58);
  }
}

/** An arrow along a line, for the way branches shall flow. */
export function drawArrow(context, points, color, width) {
  drawWire(context, points, color, width);
  if (points.length < 2) return;
  const [x, y] = points[points.length - 1];
  const back = points[Math.max(0, points.length - 4)];
  const angle = Math.atan2(y - back[1], x - back[0]);
  const barb = (turn) => [x - Math.cos(angle + turn) * width * 5, y - Math.sin(angle + turn) * width * 5];
  drawWire(context, [barb(0.5), [x, y], barb(-0.5)], color, width);
}

/** Everything that was drawn on a photo, as far as a mode shows it. `pixel` is a screen pixel in photo pixels. */
export function drawStrokes(context, photo, mode, pixel) {
  if (mode === "matte") {
    for (const { label, points, width } of photo.scribbles) {
      drawLine(context, points, LABEL_COLORS[label], Math.max(width, 2 * pixel), 0.8);
    }
  }
  if (mode === "density") {
    for (const layer of photo.paint) drawPaint(context, layer, pixel);
  }
  if (mode === "branches") {
    for (const { points, width } of photo.strokes) {
      if (width) drawLine(context, points, BRANCH_COLOR, width, 0.45);
      drawWire(context, points, BRANCH_COLOR, 2.2 * pixel);
    }
  }
}

export function drawPaint(context, { kind, points, width, softness = 0.5, strength = 1 }, pixel) {
  if (kind === "direct") drawArrow(context, points, PAINT_COLORS.direct, 2 * pixel);
  else drawSoft(context, points, PAINT_COLORS[kind], width, softness, strength);
}

/** Whether a tool draws as wide as its brush. */
export function hasSize({ mode, name }) {
  if (mode === "matte") return name in LABEL_COLORS;
  return mode === "density" ? name === "add" || name === "erase" : mode === "branches" && name === "brush";
}

/** The brush's rim around the pointer; the context's units are the screen's pixels. */
export function drawRing(context, [x, y], radius, name) {
  const color = { ...LABEL_COLORS, ...PAINT_COLORS }[name] ?? BRANCH_COLOR;
  for (const [style, width] of [["rgba(10, 14, 12, 0.6)", 3], [color, 1.5]]) {
    context.beginPath();
    context.arc(x, y, Math.max(radius, 1.5), 0, 2 * Math.PI);
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  }
}

/** A handle that one can take hold of, with its name. */
export function drawHandle(context, [x, y], name, pixel, { color = "#fff", given = true, active = false } = {}) {
  context.save();
  context.translate(x, y);
  context.scale(pixel, pixel);
  context.beginPath();
  context.arc(0, 0, active ? 8 : 6, 0, 2 * Math.PI);
  context.fillStyle = given ? color : "rgba(10, 14, 12, 0.5)";
  context.strokeStyle = given ? "rgba(10, 14, 12, 0.75)" : color;
  context.lineWidth = 2;
  context.fill();
  context.stroke();
  if (name) {
    context.font = "500 11px Roboto, system-ui, sans-serif";
    context.textBaseline = "middle";
    context.lineWidth = 3;
    context.strokeStyle = "rgba(10, 14, 12, 0.75)";
    context.strokeText(name, 13, 0);
    context.fillStyle = "#fff";
    context.fillText(name, 13, 0);
  }
  context.restore();
}
