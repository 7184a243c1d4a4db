/** Pictures and data by name, fetched when they are first needed; the one before is shown until the next is there. */

export class Pictures {
  /** @param {() => void} onLoad called whenever one more can be shown */
  constructor(onLoad) {
    this.onLoad = onLoad;
    this.known = new Map(); // name -> {url, value}
  }

  /** @returns what is there under a name, or null; what lies at another address now is asked for */
  get(name, url, load = loadImage) {
    if (!url) return null;
    if (!this.known.has(name)) this.known.set(name, { url: null, value: null });
    const entry = this.known.get(name);
    if (entry.url !== url) {
      entry.url = url;
      load(url).then(
        (value) => {
          if (entry.url !== url) return;
          entry.value = value;
          this.onLoad();
        },
        () => {
          if (entry.url === url) entry.url = null; // asked for again when it is next needed
        },
      );
    }
    return entry.value;
  }

  forget(name) {
    this.known.delete(name);
  }
}

async function loadImage(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  return image;
}

/**
 * The mean colour around a place of a picture.
 *
 * @param {HTMLImageElement} picture
 * @param {[number, number]} share of its width and height
 * @returns {string | null} #rrggbb; null where the picture is transparent, or ends
 */
export function colorAt(picture, [x, y]) {
  const context = new OffscreenCanvas(1, 1).getContext("2d");
  const [left, top] = [x * picture.naturalWidth - 2, y * picture.naturalHeight - 2];
  context.drawImage(picture, left, top, 5, 5, 0, 0, 1, 1);
  const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data;
  return a > 0 ? `#${[r, g, b].map((value) => value.toString(16).padStart(2, "0")).join("")}` : null;
}
