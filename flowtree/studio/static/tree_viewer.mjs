/** The viewer: the tree in space, and everything on the way to it. It draws only when there is something new to see. */

import { OrbitControls, THREE } from "nicegui-scene";
import { FlowPlayer } from "flowtree-studio/flow_player.mjs";
import { aimEye, PhotoPlanes } from "flowtree-studio/photo_planes.mjs";
import { Ruler } from "flowtree-studio/ruler.mjs";
import { StageLight } from "flowtree-studio/stage_light.mjs";
import { SHOWN_AS, ViewerLayers } from "flowtree-studio/viewer_layers.mjs";

const FIELD_OF_VIEW = 30; // [degrees]

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
    this.perspective = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 2000);
    this.eye = new THREE.PerspectiveCamera(); // of the photo that is looked through
    this.camera = this.perspective;
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.18;
    this.controls.addEventListener("change", () => {
      if (this.#isTurned()) this.#leaveView();
      this.render();
    });
    this.shown = { photos: false, density: false, field: false, flow: false, skeleton: false, wood: true, leaves: true };
    this.wireframe = false;
    this.skeletonBy = "thickness";
    this.blend = 0.5;
    this.view = null;
    this.zoom = 1; // of what a photo's camera sees
    this.size = { height: 10, radius: 4 };
    this.layers = new ViewerLayers(this.scene);
    this.player = new FlowPlayer(host, () => this.#showTime());
    this.#watchClicks();
    this.#watchWheel();
    this.renderer.domElement.addEventListener("webglcontextrestored", () => this.#shadow());
    new ResizeObserver(() => this.#resize()).observe(host);
    this.#resize();
    this.frame();
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
    this.size = { height: Math.max(box.max.y, 0.1), radius };
    this.planes.radius = radius * 1.15;
    this.light.fit(this.size.height, radius);
    this.#apply();
    this.#shadow();
    if (first && this.view === null) this.frame();
    this.emit("shown", { name, height: this.size.height, width: box.max.x - box.min.x });
  }

  async #loadViews(url) {
    const views = await (await fetch(url)).json();
    if (this.layers.urls.cameras !== url) return;
    this.planes.setViews(views);
    if (this.view !== null) this.setView(this.view < views.length ? this.view : null);
    this.#apply();
  }

  async #loadPicture(name, url) {
    const texture = await new THREE.TextureLoader().loadAsync(url);
    if (this.layers.urls[name] !== url) return;
    this.planes.setPicture(Number(name.split("/")[1]), texture);
    this.#apply();
  }

  /** Layers of numbers are fetched when they are first shown. */
  async #loadObject(name) {
    if (this.shown[SHOWN_AS[name]] && (await this.layers.fetch(name))) this.#build(name);
  }

  #build(name) {
    this.layers.build(name, { height: this.size.height, skeletonBy: this.skeletonBy });
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
    this.planes.show(this.shown.photos, this.view, this.blend);
    this.light.setShadows(this.view === null);
    this.light.rings.visible = this.view === null;
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

  // Cameras ------------------------------------------------------------------------------------------------

  /** The whole tree, a little from the side. */
  frame() {
    this.#use(this.perspective);
    const { height, radius } = this.size;
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const reach = Math.max((height * 0.62) / half, (radius * 1.12) / (half * Math.min(this.perspective.aspect, 3)));
    const away = reach + radius * 0.5;
    this.controls.target.set(0, height * 0.46, 0);
    this.camera.position.set(Math.sin(0.45) * away, height * 0.46 + away * 0.09, Math.cos(0.45) * away);
    this.camera.near = away / 200;
    this.camera.far = away * 20;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.render();
  }

  /** @param {number | null} index of the view to look from, as its photo did; null is free */
  setView(index) {
    const plane = index === null ? null : this.planes.planes[index];
    this.view = plane ? index : null;
    if (plane) {
      this.zoom = 1;
      this.#use(this.eye);
      this.#lookThrough();
    } else {
      this.frame();
    }
    this.#apply();
  }

  setBlend(blend) {
    this.blend = blend;
    this.#apply();
  }

  /** Sees the tree as the photo's camera did, in a frame of another shape. */
  #lookThrough() {
    const plane = this.planes.planes[this.view];
    if (!plane) return;
    const { place, target } = aimEye(this.eye, plane, this.width / this.height, this.zoom, this.size.radius);
    this.controls.target.set(...target);
    this.camera.position.set(...place);
    this.controls.update();
  }

  /** Whether the camera of a photo looks another way than the photo did. */
  #isTurned() {
    if (this.view === null || this.camera !== this.eye) return false;
    const [x, , z] = this.planes.planes[this.view].frame.toward;
    const looks = this.camera.position.clone().sub(this.controls.target).normalize();
    return looks.x * x + looks.z * z < 0.9999;
  }

  /** Turning the view leaves the photo's camera: from elsewhere the photo would lie. */
  #leaveView() {
    const looks = this.camera.position.clone().sub(this.controls.target).normalize();
    this.view = null;
    this.frame();
    const away = this.camera.position.distanceTo(this.controls.target);
    this.camera.position.copy(this.controls.target).addScaledVector(looks, away);
    this.controls.update();
    this.#apply();
    this.emit("view", null);
  }

  #use(camera) {
    this.camera = camera;
    this.controls.object = camera;
    // Whoever moves with a photo's camera no longer sees what it saw.
    this.controls.enableZoom = this.controls.enablePan = camera === this.perspective;
  }

  // Drawing ------------------------------------------------------------------------------------------------

  #resize() {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.width = clientWidth;
    this.height = clientHeight;
    this.renderer.setSize(clientWidth, clientHeight);
    this.perspective.aspect = clientWidth / clientHeight;
    this.perspective.updateProjectionMatrix();
    if (this.view !== null) this.#lookThrough();
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
      this.controls.update(); // says "change" again while it still glides
      this.#draw();
    });
  }

  #draw() {
    if (!this.width) return;
    this.renderer.render(this.scene, this.camera);
    this.ruler.follow(this.camera, this.width, this.height);
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

  /** In a photo's camera the wheel looks closer, without going nearer. */
  #watchWheel() {
    this.renderer.domElement.addEventListener("wheel", (event) => {
      if (this.view === null) return;
      event.preventDefault();
      this.zoom = Math.min(Math.max(this.zoom * Math.exp(-event.deltaY * 0.0012), 0.5), 12);
      this.#lookThrough();
      this.render();
    }, { passive: false });
  }

  #watchClicks() {
    let down = null;
    const { domElement } = this.renderer;
    domElement.addEventListener("pointerdown", (event) => {
      down = [event.clientX, event.clientY];
    });
    domElement.addEventListener("pointerup", (event) => {
      if (!this.measuring || !down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 4) return;
      this.ruler.measure(event, domElement, this.camera, this.layers.objects.tree);
      this.render();
    });
  }
}
