/** Where a picture lies on the screen: moved and scaled, never turned. */

export class PanZoom {
  constructor() {
    this.scale = 1;
    this.x = 0;
    this.y = 0;
  }

  /** Shows a whole picture in a frame. */
  fit(width, height, frameWidth, frameHeight, margin = 16) {
    const across = Math.max(frameWidth - 2 * margin, 1) / width;
    const down = Math.max(frameHeight - 2 * margin, 1) / height;
    this.scale = Math.min(across, down);
    this.x = (frameWidth - width * this.scale) / 2;
    this.y = (frameHeight - height * this.scale) / 2;
  }

  /** @returns {[number, number]} a point of the screen, in the picture's pixels */
  toPicture([x, y]) {
    return [(x - this.x) / this.scale, (y - this.y) / this.scale];
  }

  /** @returns {[number, number]} a point of the picture, on the screen */
  toScreen([x, y]) {
    return [x * this.scale + this.x, y * this.scale + this.y];
  }

  /** Scales about a point of the screen, which stays where it is. */
  zoom(factor, [x, y], least = 0.02, most = 40) {
    const next = Math.min(Math.max(this.scale * factor, least), most);
    const ratio = next / this.scale;
    this.x = x - (x - this.x) * ratio;
    this.y = y - (y - this.y) * ratio;
    this.scale = next;
  }

  move(dx, dy) {
    this.x += dx;
    this.y += dy;
  }
}
