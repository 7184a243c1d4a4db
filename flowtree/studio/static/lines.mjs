/** Lines that a pen draws: thinned, smoothed, found again. Points are [x, y]. */

/**
 * Leaves out points that lie nearer to the line than a tolerance (Douglas and Peucker).
 *
 * @param {[number, number][]} points
 * @param {number} tolerance
 * @returns {[number, number][]} the first and the last point are kept
 */
export function simplify(points, tolerance) {
  if (points.length < 3) return points.slice();
  const keep = new Uint8Array(points.length);
  keep[0] = keep[points.length - 1] = 1;
  const open = [[0, points.length - 1]];
  while (open.length > 0) {
    const [first, last] = open.pop();
    let farthest = -1;
    let most = tolerance;
    for (let i = first + 1; i < last; i += 1) {
      const away = distanceToSegment(points[i], points[first], points[last]);
      if (away > most) {
        most = away;
        farthest = i;
      }
    }
    if (farthest > 0) {
      keep[farthest] = 1;
      open.push([first, farthest], [farthest, last]);
    }
  }
  return points.filter((_, i) => keep[i]);
}

/**
 * Takes the tremble out of a line: every point moves to the mean of itself and its neighbours.
 *
 * @param {[number, number][]} points
 * @param {number} rounds
 * @returns {[number, number][]} as many points; both ends stay
 */
export function smooth(points, rounds = 2) {
  let line = points;
  for (let round = 0; round < rounds; round += 1) {
    line = line.map((point, i) => {
      if (i === 0 || i === line.length - 1) return point;
      const before = line[i - 1];
      const after = line[i + 1];
      return [(before[0] + 2 * point[0] + after[0]) / 4, (before[1] + 2 * point[1] + after[1]) / 4];
    });
  }
  return line;
}

/** Distance of a point from the segment between two others. */
export function distanceToSegment(point, start, end) {
  const dx = end[0] - start[0];
  const dy = end[1] - start[1];
  const square = dx * dx + dy * dy;
  const along = square > 0 ? ((point[0] - start[0]) * dx + (point[1] - start[1]) * dy) / square : 0;
  const share = Math.min(Math.max(along, 0), 1);
  return Math.hypot(point[0] - start[0] - share * dx, point[1] - start[1] - share * dy);
}

/** Distance of a point from a line of one or more points. */
export function distanceToLine(point, line) {
  let least = Math.hypot(point[0] - line[0][0], point[1] - line[0][1]);
  for (let i = 1; i < line.length; i += 1) {
    least = Math.min(least, distanceToSegment(point, line[i - 1], line[i]));
  }
  return least;
}

/**
 * The drawn thing under a pointer.
 *
 * @param {{points: [number, number][], width?: number}[]} drawn later ones lie on top
 * @param {[number, number]} point
 * @param {number} reach
 * @returns {number} its index, or -1
 */
export function pick(drawn, point, reach) {
  for (let i = drawn.length - 1; i >= 0; i -= 1) {
    const thickness = (drawn[i].width ?? 0) / 2;
    if (distanceToLine(point, drawn[i].points) <= Math.max(reach, thickness)) return i;
  }
  return -1;
}

/** Points rounded to a tenth of a pixel, without repeats: what travels to the project. */
export function tidy(points) {
  const rounded = points.map(([x, y]) => [Math.round(x * 10) / 10, Math.round(y * 10) / 10]);
  return rounded.filter(([x, y], i) => i === 0 || x !== rounded[i - 1][0] || y !== rounded[i - 1][1]);
}
