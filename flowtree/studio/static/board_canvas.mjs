/**
 * What the photo board draws on. Two canvases lie on each other: the lower holds what is settled and is drawn anew
 * when something of it changes; the upper holds what the pen is just drawing and is drawn at pointer rate.
 */

import { drawPhoto } from "flowtree-studio/draw_photo.mjs";
import { drawRing, hasSize } from "flowtree-studio/ink.mjs";

export class BoardCanvas {
  /** @param {object} board whose state, layers, tool and gesture are drawn */
  constructor(board) {
    this.board = board;
    this.base = board.host.appendChild(document.createElement("canvas"));
    this.ink = board.host.appendChild(document.createElement("canvas"));
    this.ink.tabIndex = 0;
  }

  /** Takes the frame's size over. @returns {[number, number] | null} how its middle has moved; null if it has none */
  resize() {
    const { clientWidth, clientHeight } = this.board.host;
    if (clientWidth === 0 || clientHeight === 0) return null;
    const shift = this.width ? [(clientWidth - this.width) / 2, (clientHeight - this.height) / 2] : [0, 0];
    this.width = clientWidth;
    this.height = clientHeight;
    this.density = window.devicePixelRatio || 1;
    for (const canvas of [this.base, this.ink]) {
      canvas.width = Math.round(clientWidth * this.density);
      canvas.height = Math.round(clientHeight * this.density);
    }
    return shift;
  }

  /** Draws everything at the next frame. */
  refresh() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.draw();
    });
  }

  draw() {
    if (!this.width) return;
    const { board } = this;
    const { photos } = board.state;
    const context = this.#enterFrame(this.base);
    context.clearRect(0, 0, this.width, this.height);
    if (photos.length > 0 && !board.single) this.#drawArranged(context, photos);
    else if (photos.length > 0) this.#drawOne(context);
    this.drawInk();
  }

  #drawArranged(context, photos) {
    const { arrange, how } = this.board;
    const accent = getComputedStyle(this.board.host).getPropertyValue("--accent").trim() || "#7fbf6a";
    const frame = { width: this.width, height: this.height, colors: { accent, line: "#ffd166" }, cutout: how.cutout };
    arrange.draw(context, photos, (i) => this.#what(i), frame);
  }

  #drawOne(context) {
    const { how, photo, tool, transform, layers } = this.board;
    const what = this.#what(photo);
    if (what.picture) {
      this.#enterPhoto(context);
      drawPhoto(context, what, { ...how, mode: tool.mode, tool: tool.name }, 1 / transform.scale);
    }
    if (tool.mode === "branches" && tool.name === "pen") layers.cost(photo); // there before the pen is
  }

  #what(i) {
    return { photo: this.board.state.photos[i], ...this.board.layers.of(i) };
  }

  /** Draws what the pen is doing: called for every movement of it. */
  drawInk() {
    const { board } = this;
    const context = this.#enterFrame(this.ink);
    context.clearRect(0, 0, this.width, this.height);
    this.ink.style.cursor = this.#cursorStyle();
    this.ink.dataset.tool = `${board.tool.mode} ${board.tool.name}`; // for who looks from outside
    if (!board.single) return;
    if (board.live?.draw) {
      this.#enterPhoto(context);
      board.live.draw(context, 1 / board.transform.scale);
    }
    if (board.cursor && hasSize(board.tool)) {
      this.#enterFrame(this.ink);
      drawRing(context, board.cursor, (board.sized().size * board.transform.scale) / 2, board.tool.name);
    }
  }

  /** Has a canvas be drawn on in the frame's pixels. */
  #enterFrame(canvas) {
    const context = canvas.getContext("2d");
    context.setTransform(this.density, 0, 0, this.density, 0, 0);
    return context;
  }

  /** Has the context draw in the photo's pixels. */
  #enterPhoto(context) {
    const { scale, x, y } = this.board.transform;
    context.setTransform(scale * this.density, 0, 0, scale * this.density, x * this.density, y * this.density);
  }

  #cursorStyle() {
    const { board } = this;
    if (board.pointers.panning) return "grab";
    if (!board.single) {
      const found = board.cursor && board.arrange.find(board.cursor);
      return found ? (found.part === "corner" ? "nwse-resize" : "move") : "default";
    }
    return hasSize(board.tool) ? "none" : "crosshair";
  }
}
