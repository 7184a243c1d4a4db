/**
 * The photo board: all photos to be arranged, or one to draw on.
 *
 * Two canvases lie on each other: the lower holds what is settled and is drawn anew when something of it changes;
 * the upper holds what the pen is just drawing and is drawn at pointer rate. A finished stroke stays on show until
 * the project says that it has it.
 */

import { ArrangeView } from "flowtree-studio/arrange_view.mjs";
import { BoardLayers } from "flowtree-studio/board_layers.mjs";
import { Compass } from "flowtree-studio/compass.mjs";
import { drawMark, drawPhoto, marksOf } from "flowtree-studio/draw_photo.mjs";
import { foresee } from "flowtree-studio/foresee.mjs";
import { beginGesture } from "flowtree-studio/gestures.mjs";
import { drawRing, hasSize } from "flowtree-studio/ink.mjs";
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
    this.base = host.appendChild(document.createElement("canvas"));
    this.ink = host.appendChild(document.createElement("canvas"));
    this.ink.tabIndex = 0;
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
    this.arrange = new ArrangeView();
    this.compass = new Compass(host, (photo, yaw, gesture) => {
      this.#send({ command: "SetYaw", photo, yaw, gesture });
    });
    this.pointers = watchPointers(this.ink, this);
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
      made.fit(width, height, this.width, this.height);
      this.transforms.set(this.photo, made);
    }
    return this.transforms.get(this.photo);
  }

  /** A gesture of the active tool, or null. */
  begin(at) {
    if (this.state.photos.length === 0) return null;
    if (!this.single) {
      const drag = this.arrange.begin(at);
      if (drag && this.arrange.active !== this.photo) {
        this.photo = this.arrange.active;
        this.emit("activate", this.photo);
      }
      this.refresh();
      return drag && { ...drag, move: (points) => { drag.move(points[points.length - 1]); this.refresh(); } };
    }
    const start = this.transform.toPicture(at);
    const pixel = 1 / this.transform.scale;
    const photo = this.state.photos[this.photo];
    const divider = this.#beginDivider(start, pixel);
    if (divider) return divider;
    if (this.tool.name === "pick-tree" || this.tool.name === "pick-background") {
      this.#pickColor(start);
      return null;
    }
    const gesture = beginGesture(this.#sized(), photo, this.photo, start, pixel, {
      cost: this.layers.cost(this.photo),
      marks: marksOf(photo, this.layers.cameras[this.photo]),
      drawMark: (context, name, point, now) => drawMark(context, name, point, now, true, photo.width, true),
    });
    return gesture && { ...bound(gesture), move: (points) => gesture.move(points.map((p) => this.transform.toPicture(p))) };
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
    this.refresh();
  }

  pan(dx, dy) {
    if (!this.single) return;
    this.transform.move(dx, dy);
    this.refresh();
  }

  zoom(factor, at) {
    if (!this.single) return;
    this.transform.zoom(factor, at);
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
  #sized() {
    const { height } = this.state.photos[this.photo];
    return { ...this.tool, size: Math.max((this.tool.size / 100) * height, 0.5) };
  }

  // Drawing ------------------------------------------------------------------------------------------------

  #resize() {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    const shift = this.width ? [(clientWidth - this.width) / 2, (clientHeight - this.height) / 2] : [0, 0];
    this.width = clientWidth;
    this.height = clientHeight;
    for (const transform of this.transforms.values()) transform.move(...shift);
    this.density = window.devicePixelRatio || 1;
    for (const canvas of [this.base, this.ink]) {
      canvas.width = Math.round(clientWidth * this.density);
      canvas.height = Math.round(clientHeight * this.density);
    }
    this.#lay();
    this.#draw();
  }

  #lay() {
    if (!this.width || this.pointers?.busy) return;
    this.arrange.update(this.state.photos, this.layers.cameras, this.width, this.height);
    this.compass.show(this.state.photos, this.photo);
    this.compass.svg.style.display = !this.single && this.state.photos.length ? "" : "none";
  }

  /** Draws everything at the next frame. */
  refresh() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.#draw();
    });
  }

  #what(i) {
    return { photo: this.state.photos[i], ...this.layers.of(i) };
  }

  #draw() {
    if (!this.width) return;
    const context = this.base.getContext("2d");
    context.setTransform(this.density, 0, 0, this.density, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    const { photos } = this.state;
    if (photos.length > 0 && !this.single) {
      const style = getComputedStyle(this.host);
      const colors = { accent: style.getPropertyValue("--accent").trim() || "#7fbf6a", line: "#ffd166" };
      const frame = { width: this.width, height: this.height, colors, cutout: this.how.cutout };
      this.arrange.draw(context, photos, (i) => this.#what(i), frame);
    } else if (photos.length > 0) {
      const what = this.#what(this.photo);
      if (what.picture) {
        this.#enter(context);
        drawPhoto(context, what, { ...this.how, mode: this.tool.mode, tool: this.tool.name }, 1 / this.transform.scale);
      }
      if (this.tool.mode === "branches" && this.tool.name === "pen") {
        this.layers.cost(this.photo); // there before the pen is
      }
    }
    this.drawInk();
  }

  /** Has the context draw in the photo's pixels. */
  #enter(context) {
    const { scale, x, y } = this.transform;
    context.setTransform(scale * this.density, 0, 0, scale * this.density, x * this.density, y * this.density);
  }

  /** Draws what the pen is doing: called for every movement of it. */
  drawInk() {
    const context = this.ink.getContext("2d");
    context.setTransform(this.density, 0, 0, this.density, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    this.ink.style.cursor = this.#cursorStyle();
    if (!this.single) return;
    if (this.live?.draw) {
      this.#enter(context);
      this.live.draw(context, 1 / this.transform.scale);
    }
    if (this.cursor && hasSize(this.tool)) {
      context.setTransform(this.density, 0, 0, this.density, 0, 0);
      drawRing(context, this.cursor, (this.#sized().size * this.transform.scale) / 2, this.tool.name);
    }
  }

  #cursorStyle() {
    if (this.pointers.panning) return "grab";
    if (!this.single) {
      const found = this.cursor && this.arrange.find(this.cursor);
      return found ? (found.part === "corner" ? "nwse-resize" : "move") : "default";
    }
    return hasSize(this.tool) ? "none" : "crosshair";
  }
}

/** A gesture's methods, tied to it, so that one of them can be wrapped. */
function bound(gesture) {
  return { draw: (...args) => gesture.draw(...args), finish: () => gesture.finish() };
}
