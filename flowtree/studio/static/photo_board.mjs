/**
 * The photo board: all photos to be arranged, or one to draw on. A finished stroke stays on show until the project
 * says that it has it.
 */

import { ArrangeView } from "flowtree-studio/arrange_view.mjs";
import { tellArranged } from "flowtree-studio/arranging.mjs";
import { BoardCanvas } from "flowtree-studio/board_canvas.mjs";
import { BoardLayers } from "flowtree-studio/board_layers.mjs";
import { Compass } from "flowtree-studio/compass.mjs";
import { drawMark, marksOf } from "flowtree-studio/draw_photo.mjs";
import { foresee } from "flowtree-studio/foresee.mjs";
import { beginGesture } from "flowtree-studio/gestures.mjs";
import { PanZoom } from "flowtree-studio/pan_zoom.mjs";
import { colorAt } from "flowtree-studio/pictures.mjs";
import { watchPointers } from "flowtree-studio/pointers.mjs";

const EMPTY = { photos: [], revision: 0 };

export class PhotoBoard {
  /**
   * @param {HTMLElement} host
   * @param {(name: "command" | "pick" | "activate", value: any) => void} emit
   */
  constructor(host, emit) {
    this.emit = emit;
    this.host = host;
    host.classList.add("photo-board");
    this.canvas = new BoardCanvas(this);
    this.state = EMPTY;
    this.pending = []; // [number, command]: on their way to the project
    this.sent = 0;
    this.layers = new BoardLayers(() => {
      this.#lay();
      this.refresh();
    });
    this.tool = { mode: "arrange", name: "move", size: 2, softness: 0.5, strength: 1 };
    this.how = { show: "overlay", split: 0.5, graphShown: true, stacked: false, cutout: false };
    this.photo = 0;
    this.transforms = new Map(); // of each photo
    this.moved = new Set(); // photos that somebody has panned or zoomed
    this.arrange = new ArrangeView();
    this.compass = new Compass(host, (photo, yaw, gesture) => {
      this.#send({ command: "SetYaw", photo, yaw, gesture });
    });
    this.pointers = watchPointers(this.canvas.ink, this);
    new ResizeObserver(() => this.#resize()).observe(host);
    this.#resize();
  }

  /** @param {object} state the project; `acknowledged` is the number of the last command that arrived */
  setState(state, acknowledged = this.sent) {
    this.state = state;
    this.pending = this.pending.filter(([number]) => number > acknowledged);
    for (const [, command] of this.pending) foresee(this.state.photos, command);
    this.photo = Math.min(this.photo, Math.max(state.photos.length - 1, 0));
    this.#lay();
    this.refresh();
  }

  /** A layer of the project has come, or has changed (`BoardLayers.set`). */
  async setLayer(name, layer) {
    await this.layers.set(name, layer);
  }

  removeLayer(name) {
    this.layers.remove(name);
  }

  /** @param {object} tool {mode, name, size [% of the photo's height], softness, strength} */
  setTool(tool) {
    const before = this.tool.mode;
    this.tool = { ...this.tool, ...tool };
    if (this.tool.mode !== before) this.#lay();
    this.refresh();
  }

  /** @param {object} how {show, split, graphShown, stacked, cutout} */
  setHow(how) {
    Object.assign(this.how, how);
    this.arrange.stacked = this.how.stacked;
    this.#lay();
    this.refresh();
  }

  setPhoto(number) {
    this.photo = this.arrange.active = number;
    this.refresh();
  }

  /** The whole photo in the frame. */
  frame() {
    this.transforms.delete(this.photo);
    this.moved.delete(this.photo);
    this.#lay();
    this.refresh();
  }

  nudge(dx, dy) {
    if (this.tool.mode !== "arrange") return;
    const command = this.arrange.nudge(dx, dy);
    if (command) this.#send({ ...command, gesture: `nudge ${this.arrange.active}` });
    this.refresh();
  }

  // Pointers -----------------------------------------------------------------------------------------------

  get single() {
    return this.tool.mode !== "arrange" && this.state.photos.length > 0;
  }

  get transform() {
    if (!this.transforms.has(this.photo)) {
      const { width, height } = this.state.photos[this.photo];
      const made = new PanZoom();
      made.fit(width, height, this.canvas.width, this.canvas.height);
      this.transforms.set(this.photo, made);
    }
    return this.transforms.get(this.photo);
  }

  /** A gesture of the active tool, or of the eraser; or null. */
  begin(at, rubs = false) {
    if (this.state.photos.length === 0) return null;
    if (!this.single) {
      const drag = this.arrange.begin(at);
      if (drag && this.arrange.active !== this.photo) {
        this.photo = this.arrange.active;
        this.emit("activate", this.photo);
      }
      this.refresh();
      const move = (points) => {
        drag.move(points[points.length - 1]);
        this.#tell();
        this.refresh();
      };
      return drag && { ...drag, move };
    }
    const toPhoto = ([x, y, force]) => [...this.transform.toPicture([x, y]), force];
    const start = toPhoto(at);
    const pixel = 1 / this.transform.scale;
    const photo = this.state.photos[this.photo];
    const divider = this.#beginDivider(start, pixel);
    if (divider) return divider;
    if (this.tool.name === "pick-tree" || this.tool.name === "pick-background") {
      this.#pickColor(start);
      return null;
    }
    const gesture = beginGesture({ ...this.sized(), ...(rubs && { name: "erase" }) }, photo, this.photo, start, pixel, {
      cost: this.layers.cost(this.photo),
      marks: marksOf(photo, this.layers.cameras[this.photo]),
      drawMark: (context, name, point, now) => drawMark(context, name, point, now, true, photo.width, true),
    });
    return gesture && { ...bound(gesture), move: (points) => gesture.move(points.map(toPhoto)) };
  }

  finish(gesture) {
    const command = gesture.finish();
    if (command) this.#send(command);
    this.live = null;
    this.drawInk();
  }

  cancel(gesture) {
    gesture.undo?.();
    this.live = null;
    this.#tell();
    this.refresh();
  }

  pan(dx, dy) {
    if (!this.single) return;
    this.transform.move(dx, dy);
    this.moved.add(this.photo);
    this.refresh();
  }

  zoom(factor, at) {
    if (!this.single) return;
    this.transform.zoom(factor, at);
    this.moved.add(this.photo);
    this.refresh();
  }

  hover(at) {
    this.cursor = at;
    this.drawInk();
  }

  #send(command) {
    this.sent += 1;
    foresee(this.state.photos, command);
    this.pending.push([this.sent, command]);
    this.emit("command", { number: this.sent, command });
    this.#tell();
    this.refresh();
  }

  #pickColor([x, y]) {
    const picture = this.layers.picture(this.photo);
    const { width, height } = this.state.photos[this.photo];
    const color = picture && colorAt(picture, [x / width, y / height]);
    if (color) this.emit("pick", { name: this.tool.name, color });
  }

  /** A drag of the line between before and after, where one begins there. */
  #beginDivider([x], pixel) {
    const { width } = this.state.photos[this.photo];
    const shown = this.how.show === "split" && this.tool.mode !== "branches" && this.layers.of(this.photo).matte;
    if (!shown || Math.abs(x - this.how.split * width) > 12 * pixel) return null;
    const move = (points) => {
      const [now] = this.transform.toPicture(points[points.length - 1]);
      this.how.split = Math.min(Math.max(now / width, 0), 1);
      this.refresh();
    };
    return { move, finish: () => null };
  }

  /** The tool with its size in the photo's pixels. */
  sized() {
    const { height } = this.state.photos[this.photo];
    return { ...this.tool, size: Math.max((this.tool.size / 100) * height, 0.5) };
  }

  // What is shown ------------------------------------------------------------------------------------------

  #resize() {
    const shift = this.canvas.resize();
    if (!shift) return;
    for (const [photo, transform] of this.transforms) {
      if (this.moved.has(photo)) transform.move(...shift);
      else this.transforms.delete(photo); // all of it is shown, in whatever frame
    }
    this.#lay();
    this.canvas.draw();
  }

  #lay() {
    const { width, height } = this.canvas;
    if (!width || this.pointers?.busy) return;
    this.arrange.update(this.state.photos, this.layers.cameras, width, height);
    this.#tell();
    this.compass.show(this.state.photos, this.photo);
    this.compass.svg.style.display = !this.single && this.state.photos.length ? "" : "none";
  }

  /** Has the viewer stand as the photos do here. */
  #tell() {
    tellArranged(this.arrange.arranged(this.state.photos));
  }

  /** Draws everything at the next frame. */
  refresh() {
    this.canvas.refresh();
  }

  /** Draws what the pen is doing. */
  drawInk() {
    this.canvas.drawInk();
  }
}

/** A gesture's methods, tied to it, so that one of them can be wrapped. */
function bound(gesture) {
  return { draw: (...args) => gesture.draw(...args), finish: () => gesture.finish() };
}
