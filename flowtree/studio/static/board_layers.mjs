/** What the photo board shows of the project's layers: photos, mattes, attractor graphs, cameras, costs. */

import { loadGrey, MattePicture } from "flowtree-studio/matte_picture.mjs";
import { Pictures } from "flowtree-studio/pictures.mjs";

export class BoardLayers {
  /** @param {() => void} onLoad called whenever something more can be shown */
  constructor(onLoad) {
    this.onLoad = onLoad;
    this.urls = {};
    this.mattes = {};
    this.queues = {};
    this.cameras = []; // of every photo
    this.pictures = new Pictures(onLoad);
  }

  /** @param {{url: string, part?: string, box?: number[]}} layer where it is, and what of it has changed */
  async set(name, { url, part, box }) {
    if (name === "cameras") {
      const views = await loadJson(url);
      this.cameras = [];
      for (const view of views) if (!view.mirrored) this.cameras[view.photo] = view;
    } else if (name.startsWith("matte/")) {
      await this.#takeMatte(name, url, part, box);
    } else {
      this.urls[name] = url;
    }
    this.onLoad();
  }

  remove(name) {
    delete this.urls[name];
    delete this.mattes[name];
    this.pictures.forget(name);
    this.onLoad();
  }

  /** All that is there of a photo. */
  of(number) {
    return {
      picture: this.picture(number),
      matte: this.mattes[`matte/${number}`],
      graph: this.#get(`graph/${number}`, loadJson),
      camera: this.cameras[number],
    };
  }

  picture(number) {
    return this.#get(`photo/${number}`);
  }

  /** What a livewire pays; asked for when it is first needed. */
  cost(number) {
    return this.#get(`cost/${number}`, loadCost);
  }

  #get(name, load) {
    return this.pictures.get(name, this.urls[name], load);
  }

  /** Mattes of one photo are taken over one after another: a box belongs to the matte before it. */
  #takeMatte(name, url, part, box) {
    const before = (this.queues[name] ?? Promise.resolve()).catch(() => {});
    this.queues[name] = before.then(async () => {
      const known = this.mattes[name];
      if (part && known) {
        const [left, top, right, bottom] = box;
        if (await known.patch(part, [left, top, right - left, bottom - top])) return;
      }
      this.mattes[name] = await MattePicture.load(url);
    });
    return this.queues[name];
  }
}

async function loadJson(url) {
  return (await fetch(url)).json();
}

async function loadCost(url) {
  const { width, height, values } = await loadGrey(url);
  return { width, height, cost: values };
}
