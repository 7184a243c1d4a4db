/** All photos on common foot and top lines, to be dragged and scaled against each other. */

import { layOut, marksAt, place, rescale } from "flowtree-studio/arrangement.mjs";
import { arrangedMarks } from "flowtree-studio/draw_photo.mjs";
import { tidy } from "flowtree-studio/lines.mjs";

const HANDLE = 12; // [screen pixels]

export class ArrangeView {
  constructor() {
    this.placed = []; // of every photo: {scale, x, y}
    this.columns = []; // left and right end of the part of the frame that shows it
    this.axes = [];
    this.lines = { foot: 0, top: 0 };
    this.active = 0;
    this.stacked = false;
  }

  /** Lays the photos out anew, by their marks. */
  update(photos, cameras, frameWidth, frameHeight) {
    const count = photos.length;
    const { columns, axes, lines } = layOut(this.stacked ? Math.min(count, 1) : count, frameWidth, frameHeight);
    this.lines = lines;
    this.columns = photos.map((_, i) => columns[this.stacked ? 0 : i]);
    this.axes = photos.map((_, i) => axes[this.stacked ? 0 : i]);
    this.placed = photos.map((photo, i) => place(arrangedMarks(photo, cameras[i]), lines, this.axes[i]));
    this.sizes = photos.map(({ width, height }) => [width, height]);
    this.active = Math.min(this.active, Math.max(count - 1, 0));
  }

  /** The photo under a point, and what of it: a corner to scale by, or the photo itself. */
  find([x, y]) {
    const order = [this.active, ...this.placed.keys()].filter((i) => this.placed[i]);
    for (const i of order) {
      const [left, top, right, bottom] = this.box(i);
      const corner = [left, right].some((cx) => [top, bottom].some((cy) => Math.hypot(cx - x, cy - y) < HANDLE));
      if (corner && i === this.active) return { photo: i, part: "corner" };
      if (x >= left && x <= right && y >= top && y <= bottom) return { photo: i, part: "whole" };
    }
    return null;
  }

  /** What is seen of a photo: its left, top, right and bottom end, inside its column. */
  box(i) {
    const { scale, x, y } = this.placed[i];
    const [left, right] = this.columns[i];
    return [Math.max(x, left), y, Math.min(x + this.sizes[i][0] * scale, right), y + this.sizes[i][1] * scale];
  }

  /** A drag from a point: `move` shows it, `finish` says where the photo stands then. */
  begin(point) {
    const found = this.find(point);
    if (!found) return null;
    const { photo, part } = found;
    this.active = photo;
    const before = this.placed[photo];
    const foot = [this.axes[photo], this.lines.foot];
    let moved = 0;
    return {
      move: (now) => {
        moved = Math.max(moved, Math.hypot(now[0] - point[0], now[1] - point[1]));
        if (part === "corner") {
          const away = (at) => Math.max(Math.hypot(at[0] - foot[0], at[1] - foot[1]), 1);
          this.placed[photo] = rescale(before, away(now) / away(point), foot);
        } else {
          const [dx, dy] = [now[0] - point[0], now[1] - point[1]];
          this.placed[photo] = { ...before, x: before.x + dx, y: before.y + dy };
        }
      },
      finish: () => (moved > 2 ? this.command(photo) : null),
      undo: () => {
        this.placed[photo] = before;
      },
    };
  }

  /** Moves the active photo by an arrow key. */
  nudge(dx, dy) {
    const placed = this.placed[this.active];
    if (!placed) return null;
    this.placed[this.active] = { ...placed, x: placed.x + dx, y: placed.y + dy };
    return this.command(this.active);
  }

  /** Foot and top of every photo as it stands now, and its yaw. */
  arranged(photos) {
    return photos.slice(0, this.placed.length).map(({ yaw }, i) => {
      const round = (value) => Math.round(value * 100) / 100;
      const { foot, top } = marksAt(this.placed[i], this.lines, this.axes[i]);
      return { yaw, foot: foot.map(round), top: round(top) };
    });
  }

  command(photo) {
    const { foot, top } = marksAt(this.placed[photo], this.lines, this.axes[photo]);
    const [[x, y]] = tidy([foot]);
    return { command: "PlacePhoto", photo, foot: [x, y], top: Math.round(top * 10) / 10 };
  }

  /** Draws all photos in screen pixels; `what(i)` gives picture and matte of one. */
  draw(context, photos, what, { width, height, colors, cutout }) {
    const order = [...photos.keys()].filter((i) => i !== this.active).concat(photos.length ? [this.active] : []);
    for (const i of order) {
      const { picture, matte } = what(i);
      const [left, top, right, bottom] = this.box(i);
      if (!picture) continue;
      context.save();
      context.beginPath();
      context.rect(left, top, right - left, bottom - top);
      context.clip();
      context.imageSmoothingQuality = "high";
      if (this.stacked && i === this.active && photos.length > 1) context.globalAlpha = 0.55;
      const shown = cutout && matte ? matte.cutout(picture) : picture;
      const { scale, x, y } = this.placed[i];
      context.drawImage(shown, x, y, this.sizes[i][0] * scale, this.sizes[i][1] * scale);
      context.restore();
      this.#drawFrame(context, i, colors);
    }
    this.#drawLines(context, photos, width, height, colors);
  }

  #drawFrame(context, i, colors) {
    if (i !== this.active) return;
    const [left, top, right, bottom] = this.box(i);
    context.strokeStyle = colors.accent;
    context.lineWidth = 1.5;
    context.strokeRect(left, top, right - left, bottom - top);
    context.fillStyle = colors.accent;
    for (const x of [left, right]) for (const y of [top, bottom]) context.fillRect(x - 4, y - 4, 8, 8);
  }

  #drawLines(context, photos, width, height, colors) {
    context.save();
    context.lineWidth = 1.25;
    for (const [name, y] of [["top", this.lines.top], ["foot", this.lines.foot]]) {
      context.strokeStyle = "rgba(10, 14, 12, 0.35)";
      line(context, 0, y + 1, width, y + 1);
      context.strokeStyle = colors.line;
      line(context, 0, y, width, y);
      label(context, name, 8, y - 7, colors);
    }
    context.setLineDash([5, 5]);
    context.strokeStyle = colors.line;
    context.globalAlpha = 0.8;
    for (const i of photos.keys()) line(context, this.axes[i], this.lines.top - 14, this.axes[i], this.lines.foot + 14);
    context.restore();
  }
}

function line(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

function label(context, text, x, y) {
  context.font = "500 11px Roboto, system-ui, sans-serif";
  context.lineWidth = 3;
  context.strokeStyle = "rgba(10, 14, 12, 0.7)";
  context.strokeText(text, x, y);
  context.fillStyle = "#fff";
  context.fillText(text, x, y);
}
