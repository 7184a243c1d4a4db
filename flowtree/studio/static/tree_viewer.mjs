/** The viewer: the tree in space, and everything on the way to it. It draws only when there is something new to see. */

import { THREE } from "nicegui-scene";
import { onArranged } from "flowtree-studio/arranging.mjs";
import { FlowPlayer } from "flowtree-studio/flow_player.mjs";
import { PhotoPlanes } from "flowtree-studio/photo_planes.mjs";
import { Ruler } from "flowtree-studio/ruler.mjs";
import { StageLight } from "flowtree-studio/stage_light.mjs";
import { ViewerCameras } from "flowtree-studio/viewer_cameras.mjs";
import { SHOWN_AS, ViewerLayers } from "flowtree-studio/viewer_layers.mjs";

const SHADOWS_REST = 150; // [ms] after the last change of the arrangement

export class TreeViewer {
  /**
   * @param {HTMLElement} host
   * @param {(name: "shown" | "view", value: any) => void} emit "shown" when a tree is on the screen
   */
  constructor(host, emit) {
    this.host = host;
    this.emit = emit;
    host.classList.add("tree-viewer");
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: false });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.toneMappingExposure = 1.2;
    this.renderer.domElement.tabIndex = 0;
    host.append(this.renderer.domElement);
    this.scene = new THREE.Scene();
    this.light = new StageLight(this.scene);
    this.planes = new PhotoPlanes();
    this.ruler = new Ruler(this.scene, host);
    this.scene.add(this.planes.group);
    this.cameras = new ViewerCameras(
      this.renderer.domElement,
      this.planes,
      () => this.render(),
      () => {
        this.#apply();
        this.emit("view", null);
      },
    );
    this.shown = { photos: false, density: false, field: false, flow: false, skeleton: false, wood: true, leaves: true };
    this.wireframe = false;
    this.skeletonBy = "thickness";
    this.blend = 0.5;
    this.layers = new ViewerLayers(this.scene);
    this.player = new FlowPlayer(host, () => this.#showTime());
    this.stop = onArranged((photos) => this.#follow(photos));
    this.#watchClicks();
    this.renderer.domElement.addEventListener("webglcontextrestored", () => this.#shadow());
    new ResizeObserver(() => this.#resize()).observe(host);
    this.#resize();
    this.cameras.frame();
  }

  // Layers -------------------------------------------------------------------------------------------------

  async setLayer(name, { url }) {
    this.layers.urls[name] = url;
    if (name === "coarse.glb" || name === "tree.glb") await this.#loadTree(name, url);
    else if (name === "cameras") await this.#loadViews(url);
    else if (name.startsWith("straight/")) await this.#loadPicture(name, url);
    else if (name in SHOWN_AS) await this.#loadObject(name);
  }

  removeLayer(name) {
    if (name in SHOWN_AS) this.layers.remove(name);
    if (name === "tree.glb") this.layers.remove("tree");
    this.render();
  }

  async #loadTree(name, url) {
    const first = !this.layers.objects.tree;
    const tree = await this.layers.loadTree(name, url);
    if (!tree) return;
    const box = new THREE.Box3().setFromObject(tree);
    const radius = Math.max(-box.min.x, box.max.x, -box.min.z, box.max.z, 0.1);
    const height = Math.max(box.max.y, 0.1);
    this.cameras.size = { height, radius };
    this.planes.radius = radius * 1.15;
    this.light.fit(height, radius);
    this.#apply();
    this.#shadow();
    if (first && this.cameras.view === null) this.cameras.frame();
    this.emit("shown", { name, height, width: box.max.x - box.min.x });
  }

  async #loadViews(url) {
    const views = await (await fetch(url)).json();
    if (this.layers.urls.cameras !== url) return;
    this.planes.setViews(views);
    this.layers.setViews(views);
    const { view } = this.cameras;
    if (view !== null) this.cameras.look(view < views.length ? view : null);
    this.#follow(this.arranged);
    this.#apply();
  }

  async #loadPicture(name, url) {
    const picture = await new THREE.ImageLoader().loadAsync(url);
    if (this.layers.urls[name] !== url) return;
    this.planes.setPicture(Number(name.split("/")[1]), picture);
    this.#apply();
  }

  /** Layers of numbers are fetched when they are first shown. */
  async #loadObject(name) {
    if (this.shown[SHOWN_AS[name]] && (await this.layers.fetch(name))) this.#build(name);
  }

  #build(name) {
    this.layers.build(name, { height: this.cameras.size.height, skeletonBy: this.skeletonBy });
    if (name === "flow") this.player.setLength(this.layers.data.flow.values.last);
    this.#scale();
    this.#apply();
  }

  // What is shown ------------------------------------------------------------------------------------------

  /** @param {object} shown {photos, density, field, flow, skeleton, wood, leaves}: those that change */
  setShown(shown) {
    Object.assign(this.shown, shown);
    for (const name of Object.keys(SHOWN_AS)) this.#loadObject(name);
    this.#apply();
    this.#shadow();
  }

  setLook({ wireframe = this.wireframe, skeletonBy = this.skeletonBy }) {
    this.wireframe = wireframe;
    if (skeletonBy !== this.skeletonBy) {
      this.skeletonBy = skeletonBy;
      if (this.layers.data.skeleton) this.#build("skeleton");
    }
    this.#apply();
  }

  #apply() {
    this.layers.objects.tree?.traverse((node) => {
      if (!node.isMesh) return;
      node.visible = node.name.endsWith("leaves") ? this.shown.leaves : this.shown.wood;
      node.material.wireframe = this.wireframe;
    });
    for (const [name, key] of Object.entries(SHOWN_AS)) {
      if (this.layers.objects[name]) this.layers.objects[name].visible = this.shown[key];
    }
    this.player.setShown(this.shown.flow && Boolean(this.layers.objects.flow));
    const { view } = this.cameras;
    this.planes.show(this.shown.photos, view, this.blend);
    this.light.setShadows(view === null);
    this.light.rings.visible = view === null;
    this.#showTime();
  }

  #showTime() {
    const { flow } = this.layers.objects;
    if (flow?.visible) flow.setTime(this.player.time, this.player.length);
    this.render();
  }

  #shadow() {
    this.renderer.shadowMap.needsUpdate = true;
    this.render();
  }

  /** Has everything stand where the photos are being arranged to, until it is made anew. */
  #follow(photos) {
    this.arranged = photos;
    this.planes.arrange(photos);
    this.layers.arrange(photos);
    this.#apply();
    // The shadows take as long as all the rest: they follow when the hand rests.
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.#shadow(), SHADOWS_REST);
  }

  /** @param {number | null} index of the view to look from, as its photo did; null is free */
  setView(index) {
    this.cameras.look(index);
    this.#apply();
  }

  setBlend(blend) {
    this.blend = blend;
    this.#apply();
  }

  // Drawing ------------------------------------------------------------------------------------------------

  #resize() {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.width = clientWidth;
    this.height = clientHeight;
    this.renderer.setSize(clientWidth, clientHeight);
    this.cameras.resize(clientWidth, clientHeight);
    this.#scale();
    this.#draw();
  }

  #scale() {
    if (this.width) this.layers.setScale(this.width, this.height, this.renderer.getPixelRatio());
  }

  /** Draws at the next frame. */
  render() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.cameras.controls.update(); // says "change" again while it still glides
      this.#draw();
    });
  }

  #draw() {
    if (!this.width) return;
    this.renderer.render(this.scene, this.cameras.now);
    this.ruler.follow(this.cameras.now, this.width, this.height);
    this.drawn = (this.drawn ?? 0) + 1;
  }

  /** @returns {string} the view as a PNG's data URL, on the page's ground */
  screenshot() {
    this.#draw();
    const { domElement } = this.renderer;
    const canvas = document.createElement("canvas");
    canvas.width = domElement.width;
    canvas.height = domElement.height;
    const context = canvas.getContext("2d");
    context.fillStyle = getComputedStyle(this.host).getPropertyValue("--stage").trim() || "#20261f";
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(domElement, 0, 0);
    return canvas.toDataURL("image/png");
  }

  // Measuring ----------------------------------------------------------------------------------------------

  setMeasuring(on) {
    this.measuring = on;
    if (!on) this.ruler.clear();
    this.renderer.domElement.style.cursor = on ? "crosshair" : "";
    this.render();
  }

  #watchClicks() {
    let down = null;
    const { domElement } = this.renderer;
    domElement.addEventListener("pointerdown", (event) => {
      down = [event.clientX, event.clientY];
    });
    domElement.addEventListener("pointerup", (event) => {
      if (!this.measuring || !down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      this.ruler.measure(event, domElement, this.cameras.now, this.layers.objects.tree);
      this.render();
    });
  }
}
