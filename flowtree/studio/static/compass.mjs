/** A small compass: the tree from above, and from where each photo was taken. Dragging a camera turns it. */

import { rimAt, yawAt } from "flowtree-studio/arrangement.mjs";

const NS = "http://www.w3.org/2000/svg";
const RADIUS = 44;

export class Compass {
  /**
   * @param {HTMLElement} host
   * @param {(photo: number, yaw: number, gesture: string) => void} onTurn while a camera is dragged
   */
  constructor(host, onTurn) {
    this.onTurn = onTurn;
    this.svg = element("svg", { viewBox: "-64 -64 128 128", class: "compass", role: "group", "aria-label": "From where the photos were taken" });
    host.append(this.svg);
    this.gestures = 0;
  }

  /** @param {{yaw: number}[]} photos */
  show(photos, active) {
    const wanted = JSON.stringify([photos.map(({ yaw }) => yaw), active]);
    if (this.dragging || wanted === this.shown) return; // what is drawn anew loses the focus
    this.shown = wanted;
    this.photos = photos.map(({ yaw }) => ({ yaw }));
    this.active = active;
    this.#draw();
  }

  #draw() {
    this.svg.replaceChildren(element("circle", { r: RADIUS, class: "compass-rim" }));
    for (let yaw = 0; yaw < 360; yaw += 15) {
      const [x0, y0] = rimAt(yaw, RADIUS - (yaw % 45 ? 3 : 6));
      const [x1, y1] = rimAt(yaw, RADIUS);
      this.svg.append(element("line", { x1: x0, y1: y0, x2: x1, y2: y1, class: "compass-tick" }));
    }
    this.svg.append(element("path", { d: crown(), class: "compass-tree" }));
    this.photos.forEach(({ yaw }, i) => this.svg.append(this.#camera(yaw, i)));
  }

  #camera(yaw, i) {
    const group = element("g", { class: `compass-camera${i === this.active ? " active" : ""}`, tabindex: 0 });
    const [x, y] = rimAt(yaw, RADIUS);
    const turn = -yaw;
    group.append(
      element("path", { d: "M0,0 L-26,-96 L26,-96 Z", class: "compass-view", transform: `translate(${x} ${y}) rotate(${turn}) scale(0.4)` }),
      element("circle", { cx: x, cy: y, r: 9 }),
    );
    const text = element("text", { x, y: y + 0.5 });
    text.textContent = String(i + 1);
    group.append(text);
    const title = element("title", {});
    title.textContent = `Photo ${i + 1}: ${Math.round(yaw)}°. Drag; Shift for single degrees.`;
    group.append(title);
    group.addEventListener("pointerdown", (event) => this.#drag(event, i));
    group.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -5, ArrowRight: 5 }[event.key];
      if (!step) return;
      event.preventDefault();
      event.stopPropagation();
      this.onTurn(i, yawAt(...rimAt(yaw + step, 1), 1), `turn ${this.gestures}`);
    });
    return group;
  }

  #drag(event, i) {
    event.preventDefault();
    event.stopPropagation();
    this.dragging = true;
    this.gestures += 1;
    const gesture = `turn ${this.gestures}`;
    const turn = (now) => {
      const box = this.svg.getBoundingClientRect();
      const [dx, dy] = [now.clientX - box.x - box.width / 2, now.clientY - box.y - box.height / 2];
      const yaw = yawAt(dx, dy, now.shiftKey ? 1 : 5);
      if (yaw === this.photos[i].yaw) return;
      this.photos[i].yaw = yaw;
      this.active = i;
      this.#draw();
      this.onTurn(i, yaw, gesture);
    };
    const end = () => {
      this.dragging = false;
      this.shown = null;
      window.removeEventListener("pointermove", turn);
      window.removeEventListener("pointerup", end);
      window.removeEventListener("pointercancel", end);
      this.#draw();
    };
    window.addEventListener("pointermove", turn);
    window.addEventListener("pointerup", end);
    window.addEventListener("pointercancel", end);
  }
}

/** A crown from above: a circle with lobes. */
function crown() {
  const points = Array.from({ length: 48 }, (_, i) => rimAt(i * 7.5, 17 + 2.2 * Math.sin((i * Math.PI) / 3)));
  return `M${points.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" L")} Z`;
}

function element(name, attributes) {
  const made = document.createElementNS(NS, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}
