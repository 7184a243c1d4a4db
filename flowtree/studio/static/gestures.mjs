/**
 * What a pen does on one photo: each gesture begins where it goes down, grows with it, is drawn at pointer rate,
 * and ends as one command for the project (or none).
 *
 * A gesture has `move(points)`, `draw(context, pixel)` and `finish()`; points are pixels of the photo, with the pen's force
 * behind them, `pixel` is a screen pixel in them.
 */

import { BRANCH_COLOR, LABEL_COLORS, PAINT_COLORS, drawLine, drawPaint, drawWire } from "flowtree-studio/ink.mjs";
import { pick, simplify, smooth, tidy } from "flowtree-studio/lines.mjs";
import { Livewire } from "flowtree-studio/livewire.mjs";
import { Force, strengthAt, widthAt } from "flowtree-studio/pressure.mjs";

/** A line of some width, or some strength: scribbles, painted density, broad branches, free lines. */
class Brush {
  /**
   * @param {(context: object, points: [number, number][], pixel: number, force: number) => void} show
   * @param {(points: [number, number][], force: number) => object | null} command
   */
  constructor(start, pixel, show, command) {
    this.points = [[start[0], start[1]]];
    this.force = new Force(start);
    this.pixel = pixel;
    this.show = show;
    this.command = command;
  }

  move(points) {
    for (const point of points) {
      this.points.push([point[0], point[1]]);
      this.force.add(point);
    }
  }

  draw(context, pixel) {
    this.show(context, this.points, pixel, this.force.mean);
  }

  finish() {
    return this.command(tidy(simplify(smooth(this.points), 0.4 * this.pixel)), this.force.mean);
  }
}

/** A line that snaps to what the picture shows. */
class Wire {
  constructor(start, pixel, grid, scale, command) {
    this.wire = new Livewire(grid, scale);
    this.wire.start([start[0], start[1]]);
    this.pixel = pixel;
    this.points = [[start[0], start[1]]];
    this.command = command;
  }

  move(points) {
    const [x, y] = points[points.length - 1];
    this.points = this.wire.follow([x, y]);
  }

  draw(context, pixel) {
    drawWire(context, this.points, PAINT_COLORS.direct, 2.2 * pixel);
  }

  finish() {
    const line = smooth(this.points, 6);
    return this.command(tidy(simplify(line, 0.5 * this.pixel)));
  }
}

/** Takes away what it touches. */
class Eraser {
  constructor(start, drawn, reach, command) {
    this.drawn = drawn;
    this.reach = reach;
    this.command = command;
    this.touched = new Set();
    this.move([start]);
  }

  move(points) {
    for (const point of points) {
      const left = this.drawn.map((line, i) => (this.touched.has(i) ? { points: [[-1e9, -1e9]] } : line));
      const found = pick(left, point, this.reach);
      if (found >= 0) this.touched.add(found);
    }
  }

  draw(context, pixel) {
    for (const i of this.touched) drawLine(context, this.drawn[i].points, "#ff4d4d", 5 * pixel, 0.9);
  }

  finish() {
    const indices = [...this.touched].sort((a, b) => a - b);
    return indices.length > 0 ? this.command(indices) : null;
  }
}

/** Moves one place: the foot, the top, the fork, a tip. */
class Move {
  constructor(start, show, command) {
    this.start = this.point = [start[0], start[1]];
    this.show = show;
    this.command = command;
  }

  move(points) {
    const [x, y] = points[points.length - 1];
    this.point = [x, y];
  }

  draw(context, pixel) {
    this.show(context, this.point, pixel);
  }

  finish() {
    const [x, y] = tidy([this.point])[0];
    return this.command([x, y], Math.hypot(x - this.start[0], y - this.start[1]));
  }
}

/**
 * The gesture of a tool.
 *
 * @param {object} tool {mode, name, size [photo pixels], softness, strength, snap}
 * @param {object} photo as the project's state describes it
 * @param {number} number of the photo
 * @param {[number, number, number?]} start with the pen's force, where it is known
 * @param {number} pixel a screen pixel in photo pixels
 * @param {{cost: object | null, marks: object, drawMark: Function}} around what the board knows besides
 * @returns a gesture, or null where the tool does nothing
 */
export function beginGesture(tool, photo, number, start, pixel, around) {
  const about = { photo: number };
  if (tool.mode === "matte") {
    if (tool.name === "erase") {
      const remove = (indices) => ({ command: "RemoveScribbles", ...about, indices });
      return new Eraser(start, photo.scribbles, 6 * pixel, remove);
    }
    const show = (context, points) => drawLine(context, points, LABEL_COLORS[tool.name], tool.size, 0.8);
    return new Brush(start, pixel, show, (points) => ({
      command: "AddScribble", ...about, label: tool.name, width: tool.size, points,
    }));
  }
  if (tool.mode === "density") {
    if (tool.name === "undo") {
      const remove = (indices) => ({ command: "RemovePaint", ...about, indices });
      return new Eraser(start, photo.paint, 6 * pixel, remove);
    }
    const { size: width, softness } = tool;
    const layer = (points, force) => {
      const strength = tool.name === "direct" ? tool.strength : strengthAt(force, tool.strength);
      return { kind: tool.name, width, softness, strength: Math.round(strength * 100) / 100, points };
    };
    const show = (context, points, now, force) => drawPaint(context, layer(points, force), now);
    return new Brush(start, pixel, show, (points, force) =>
      tool.name === "direct" && points.length < 2 ? null : { command: "AddPaint", ...about, ...layer(points, force) },
    );
  }
  if (tool.mode === "branches") return beginBranch(tool, photo, about, start, pixel, around);
  return null;
}

function beginBranch(tool, photo, about, start, pixel, { cost, marks, drawMark }) {
  const stroke = (width, snapped) => (points) =>
    points.length < 2 ? null : { command: "AddStroke", ...about, points, width, snapped };
  if (tool.name === "erase") {
    const remove = (indices) => ({ command: "RemoveStrokes", ...about, indices });
    return new Eraser(start, photo.strokes, 8 * pixel, remove);
  }
  if (tool.name === "pen" && cost) {
    return new Wire(start, pixel, cost, cost.width / photo.width, stroke(null, true));
  }
  if (tool.name === "pen" || tool.name === "free") {
    const show = (context, points, now) => drawWire(context, points, PAINT_COLORS.direct, 2.2 * now);
    return new Brush(start, pixel, show, stroke(null, false));
  }
  if (tool.name === "brush") {
    const show = (context, points, _, force) => drawLine(context, points, BRANCH_COLOR, widthAt(force, tool.size), 0.6);
    return new Brush(start, pixel, show, (points, force) =>
      stroke(Math.round(widthAt(force, tool.size) * 10) / 10, false)(points),
    );
  }
  if (tool.name === "tips") return beginTip(photo, about, start, pixel, drawMark);
  if (tool.name === "marks") {
    const near = Object.entries(marks)
      .map(([name, { at }]) => [name, Math.hypot(at[0] - start[0], at[1] - start[1])])
      .sort((a, b) => a[1] - b[1])[0];
    if (!near || near[1] > 24 * pixel) return null;
    const [name] = near;
    return new Move(start, (context, point, now) => drawMark(context, name, point, now), (point, moved) =>
      moved > pixel ? { command: "SetMark", ...about, name, value: name === "top" ? point[1] : point } : null,
    );
  }
  return null;
}

/** A tip is set where there is none, moved where there is one, taken away by a tap on it. */
function beginTip(photo, about, start, pixel, drawMark) {
  const tips = photo.marks.seeds ?? [];
  const at = pick(tips.map((tip) => ({ points: [tip] })), start, 14 * pixel);
  const show = (context, point, now) => drawMark(context, "tip", point, now);
  return new Move(start, show, (point, moved) => {
    const points = tips.slice();
    if (at < 0) points.push(point);
    else if (moved > 3 * pixel) points[at] = point;
    else points.splice(at, 1);
    return { command: "SetSeeds", ...about, points };
  });
}
