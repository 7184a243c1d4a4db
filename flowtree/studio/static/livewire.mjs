/**
 * The livewire: cheapest paths over a picture of costs, from an anchor to wherever the pen is.
 *
 * Costs are bytes (0 free, 255 dear). Every step also costs its length, so that paths are short where nothing
 * guides them. Dijkstra with buckets instead of a heap: costs are whole numbers.
 */

const STEPS = [
  [1, 0, 10],
  [-1, 0, 10],
  [0, 1, 10],
  [0, -1, 10],
  [1, 1, 14],
  [1, -1, 14],
  [-1, 1, 14],
  [-1, -1, 14],
];
const LENGTH = 24; // what a step costs where the picture says 0
const WIDEST = Math.ceil(((255 + LENGTH) * 14) / 10) + 1;

/**
 * Cheapest ways from one cell to all cells of a window.
 *
 * @param {{cost: Uint8Array, width: number, height: number}} grid
 * @param {[number, number]} start cell (column, row)
 * @param {number} reach half the window's side [cells]
 * @returns {{from: Int32Array, left: number, top: number, width: number, height: number}} for every cell of the
 *   window the cell before it (an index in the window, -1 at the start)
 */
export function cheapestPaths(grid, start, reach) {
  const left = Math.max(0, start[0] - reach);
  const top = Math.max(0, start[1] - reach);
  const width = Math.min(grid.width, start[0] + reach + 1) - left;
  const height = Math.min(grid.height, start[1] + reach + 1) - top;
  const from = new Int32Array(width * height).fill(-1);
  const distance = new Int32Array(width * height).fill(0x7fffffff);
  const buckets = Array.from({ length: WIDEST }, () => []);
  const first = start[0] - left + (start[1] - top) * width;
  distance[first] = 0;
  buckets[0].push(first);
  let waiting = 1;
  for (let now = 0; waiting > 0; now += 1) {
    const bucket = buckets[now % WIDEST];
    while (bucket.length > 0) {
      const cell = bucket.pop();
      waiting -= 1;
      if (distance[cell] !== now) continue; // a cheaper way was found meanwhile
      const x = cell % width;
      const y = (cell - x) / width;
      for (const [dx, dy, length] of STEPS) {
        const nextX = x + dx;
        const nextY = y + dy;
        if (nextX < 0 || nextY < 0 || nextX >= width || nextY >= height) continue;
        const next = nextX + nextY * width;
        const toll = grid.cost[left + nextX + (top + nextY) * grid.width] + LENGTH;
        const sum = now + Math.round((toll * length) / 10);
        if (sum < distance[next]) {
          distance[next] = sum;
          from[next] = cell;
          buckets[sum % WIDEST].push(next);
          waiting += 1;
        }
      }
    }
  }
  return { from, left, top, width, height };
}

/**
 * The way from the start of `cheapestPaths` to a cell.
 *
 * @param {ReturnType<typeof cheapestPaths>} paths
 * @param {[number, number]} end cell; one outside the window is brought to its edge
 * @returns {[number, number][]} cells, the start first
 */
export function pathTo(paths, end) {
  const x = Math.min(Math.max(end[0] - paths.left, 0), paths.width - 1);
  const y = Math.min(Math.max(end[1] - paths.top, 0), paths.height - 1);
  const cells = [];
  for (let cell = x + y * paths.width; cell >= 0; cell = paths.from[cell]) {
    cells.push([(cell % paths.width) + paths.left, Math.floor(cell / paths.width) + paths.top]);
  }
  return cells.reverse();
}

/** A wire that follows the pen: it snaps as one draws, and what lies far behind the pen stays where it is. */
export class Livewire {
  /**
   * @param {{cost: Uint8Array, width: number, height: number}} grid
   * @param {number} scale cells a pixel of the photo
   * @param {number} cooling length [cells] after which the wire is fixed
   */
  constructor(grid, scale, cooling = 40) {
    this.grid = grid;
    this.scale = scale;
    this.cooling = cooling;
    this.fixed = [];
    this.paths = null;
  }

  /** @param {[number, number]} point [pixels of the photo] */
  start(point) {
    const cell = this.#cell(point);
    this.fixed = [point];
    this.#anchor(cell);
  }

  /**
   * @param {[number, number]} point where the pen is [pixels of the photo]
   * @returns {[number, number][]} the whole wire [pixels of the photo], ending at the pen
   */
  follow(point) {
    const end = this.#cell(point);
    const away = Math.hypot(end[0] - this.anchor[0], end[1] - this.anchor[1]);
    const live = pathTo(this.paths, end).map((cell) => this.#pixel(cell));
    if (away > this.cooling) {
      // The last third may still change its mind.
      const keep = Math.max(1, Math.floor((live.length * 2) / 3));
      this.fixed.push(...live.slice(1, keep + 1));
      this.#anchor(this.#cell(live[Math.min(keep, live.length - 1)]));
      return this.follow(point);
    }
    return [...this.fixed, ...live.slice(1, -1), point];
  }

  #anchor(cell) {
    this.anchor = cell;
    this.paths = cheapestPaths(this.grid, cell, Math.ceil(this.cooling * 1.5));
  }

  #cell([x, y]) {
    const column = Math.min(Math.max(Math.floor(x * this.scale), 0), this.grid.width - 1);
    const row = Math.min(Math.max(Math.floor(y * this.scale), 0), this.grid.height - 1);
    return [column, row];
  }

  #pixel([column, row]) {
    return [(column + 0.5) / this.scale, (row + 0.5) / this.scale];
  }
}
