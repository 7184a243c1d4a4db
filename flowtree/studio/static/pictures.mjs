/** Pictures by their address, loaded once. */

export class Pictures {
  /** @param {() => void} onLoad called whenever one more can be shown */
  constructor(onLoad) {
    this.onLoad = onLoad;
    this.known = new Map();
  }

  /** @returns the picture when it is there; else null, and it is asked for */
  get(url, load = loadImage) {
    if (!url) return null;
    if (!this.known.has(url)) {
      this.known.set(url, null);
      load(url).then(
        (picture) => {
          this.known.set(url, picture);
          this.onLoad();
        },
        () => this.known.delete(url), // asked for again when it is next needed
      );
    }
    return this.known.get(url);
  }

  /** Forgets all but these. */
  keep(urls) {
    const wanted = new Set(urls);
    for (const url of this.known.keys()) if (!wanted.has(url)) this.known.delete(url);
  }
}

async function loadImage(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  return image;
}
