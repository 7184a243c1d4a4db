/** An alpha matte in the browser: loaded as a grey picture, patched where it changed, shown in several ways. */

const TINT = [196, 44, 92]; // what is not tree, under "overlay"
const TINT_ALPHA = 0.5;

/**
 * Fills the pixels of a box with a way to show them.
 *
 * @param {Uint8ClampedArray} rgba of the whole picture, 4 bytes a pixel, written to
 * @param {Uint8Array} alpha of the whole picture
 * @param {number} width of the picture
 * @param {[number, number, number, number]} box x, y, width, height
 * @param {"overlay" | "mask" | "grey"} kind
 */
export function shade(rgba, alpha, width, [left, top, wide, high], kind) {
  for (let y = top; y < top + high; y += 1) {
    for (let x = left; x < left + wide; x += 1) {
      const i = x + y * width;
      const a = alpha[i];
      if (kind === "overlay") {
        rgba.set(TINT, 4 * i);
        rgba[4 * i + 3] = (255 - a) * TINT_ALPHA;
      } else if (kind === "mask") {
        rgba[4 * i + 3] = a;
      } else {
        rgba[4 * i] = rgba[4 * i + 1] = rgba[4 * i + 2] = a;
        rgba[4 * i + 3] = 255;
      }
    }
  }
}

/** Puts the values of a smaller picture into a larger one. */
export function paste(values, width, patch, [left, top, wide, high]) {
  for (let y = 0; y < high; y += 1) {
    values.set(patch.subarray(y * wide, (y + 1) * wide), left + (top + y) * width);
  }
}

/** The grey values of a picture at a URL. */
export async function loadGrey(url) {
  const response = await fetch(url);
  if (response.status !== 200) throw new Error(`${url}: ${response.status}`); // 204: it is no longer to be had
  const bitmap = await createImageBitmap(await response.blob(), { colorSpaceConversion: "none" });
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const { data } = context.getImageData(0, 0, width, height);
  const values = new Uint8Array(width * height);
  for (let i = 0; i < values.length; i += 1) values[i] = data[4 * i];
  return { width, height, values };
}

export class MattePicture {
  constructor({ width, height, values }) {
    this.width = width;
    this.height = height;
    this.alpha = values;
    this.shown = new Map(); // kind -> {canvas, context, image}
    this.cutouts = new Map();
  }

  static async load(url) {
    return new MattePicture(await loadGrey(url));
  }

  /**
   * Takes over the box that changed; the box's picture lies at a URL.
   *
   * @returns {Promise<boolean>} whether the box was still to be had
   */
  async patch(url, box) {
    const patch = await loadGrey(url).catch(() => null);
    if (!patch) return false;
    paste(this.alpha, this.width, patch.values, box);
    for (const [kind, { context, image }] of this.shown) {
      shade(image.data, this.alpha, this.width, box, kind);
      context.putImageData(image, 0, 0, ...box);
    }
    this.cutouts.clear();
    return true;
  }

  /** @returns {OffscreenCanvas} the matte as an overlay, a mask or a grey picture */
  as(kind) {
    if (!this.shown.has(kind)) {
      const canvas = new OffscreenCanvas(this.width, this.height);
      const context = canvas.getContext("2d");
      const image = context.createImageData(this.width, this.height);
      shade(image.data, this.alpha, this.width, [0, 0, this.width, this.height], kind);
      context.putImageData(image, 0, 0);
      this.shown.set(kind, { canvas, context, image });
    }
    return this.shown.get(kind).canvas;
  }

  /** @returns {OffscreenCanvas} the photo where it is tree, transparent elsewhere */
  cutout(photo) {
    if (!this.cutouts.has(photo)) {
      const canvas = new OffscreenCanvas(this.width, this.height);
      const context = canvas.getContext("2d");
      context.drawImage(photo, 0, 0, this.width, this.height);
      context.globalCompositeOperation = "destination-in";
      context.drawImage(this.as("mask"), 0, 0);
      this.cutouts.clear();
      this.cutouts.set(photo, canvas);
    }
    return this.cutouts.get(photo);
  }
}
