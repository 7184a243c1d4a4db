/** How hard a pen is pressed, 0 to 1; whatever cannot feel it counts as pressed halfway. */

const USUAL = 0.5;

/** @param {{pointerType: string, pressure: number}} event */
export function forceOf({ pointerType, pressure }) {
  return pointerType === "pen" && pressure > 0 ? pressure : USUAL;
}

/** A brush's width: as its ring shows it where the pen is pressed halfway. */
export function widthAt(force, width) {
  return width * (0.25 + 1.5 * force);
}

/** The strength of paint: all of it where the pen is pressed halfway, or harder. */
export function strengthAt(force, strength) {
  return Math.max(Math.min(2 * force, 1) * strength, 0.05);
}

/** The mean force along a stroke: every piece of the way counts by its length, so that lingering counts nothing. */
export class Force {
  constructor([x, y, force = USUAL]) {
    this.last = [x, y];
    this.first = force;
    this.way = this.sum = 0;
  }

  add([x, y, force = USUAL]) {
    const step = Math.hypot(x - this.last[0], y - this.last[1]);
    this.last = [x, y];
    this.way += step;
    this.sum += step * force;
  }

  get mean() {
    return this.way > 0 ? this.sum / this.way : this.first;
  }
}
