/** From where the viewer sees the tree: turned freely, or through the eye of a photo. */

import { OrbitControls, THREE } from "nicegui-scene";
import { aimEye } from "flowtree-studio/photo_planes.mjs";

const FIELD_OF_VIEW = 30; // [degrees]

export class ViewerCameras {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {import("flowtree-studio/photo_planes.mjs").PhotoPlanes} planes
   * @param {() => void} onMove called when something else is seen
   * @param {() => void} onLeave called when a person has turned away from a photo's view
   */
  constructor(canvas, planes, onMove, onLeave) {
    this.planes = planes;
    this.onMove = onMove;
    this.perspective = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.05, 2000);
    this.eye = new THREE.PerspectiveCamera(); // of the photo that is looked through
    this.now = this.perspective;
    this.view = null; // index of that photo's view
    this.framed = true; // whether nobody has moved since all of the tree was shown
    this.zoom = 1; // of what its camera sees
    this.size = { height: 10, radius: 4 }; // of the tree [m]
    this.controls = new OrbitControls(this.now, canvas);
    this.controls.enableDamping = true;
    this.controls.dampingFactor = 0.18;
    this.controls.addEventListener("change", () => {
      if (this.#isTurned()) {
        this.#leaveView();
        onLeave();
      }
      onMove();
    });
    this.controls.addEventListener("start", () => {
      this.framed = false;
    });
    this.#watchWheel(canvas);
  }

  /** The whole tree, a little from the side. */
  frame() {
    this.view = null;
    this.#use(this.perspective);
    const { height, radius } = this.size;
    const half = Math.tan((FIELD_OF_VIEW * Math.PI) / 360);
    const reach = Math.max((height * 0.62) / half, (radius * 1.12) / (half * Math.min(this.perspective.aspect, 3)));
    const away = reach + radius * 0.5;
    this.controls.target.set(0, height * 0.46, 0);
    this.now.position.set(Math.sin(0.45) * away, height * 0.46 + away * 0.09, Math.cos(0.45) * away);
    this.now.near = away / 200;
    this.now.far = away * 20;
    this.now.updateProjectionMatrix();
    this.controls.update();
    this.framed = true;
    this.onMove();
  }

  /** @param {number | null} index of the view to look from, as its photo did; null is free */
  look(index) {
    const plane = index === null ? null : this.planes.planes[index];
    if (!plane) {
      this.frame();
      return;
    }
    this.view = index;
    this.zoom = 1;
    this.#use(this.eye);
    this.#lookThrough();
  }

  /** Fits a frame of another shape. */
  resize(width, height) {
    this.aspect = width / height;
    this.perspective.aspect = this.aspect;
    this.perspective.updateProjectionMatrix();
    if (this.view !== null) this.#lookThrough();
    else if (this.framed) this.frame();
  }

  /** Sees the tree as the photo's camera did, in a frame of another shape. */
  #lookThrough() {
    const plane = this.planes.planes[this.view];
    if (!plane) return;
    const { place, target } = aimEye(this.eye, plane, this.aspect ?? 1, this.zoom, this.size.radius);
    this.controls.target.set(...target);
    this.now.position.set(...place);
    this.controls.update();
  }

  /** Whether the camera of a photo looks another way than the photo did. */
  #isTurned() {
    if (this.view === null || this.now !== this.eye) return false;
    const [x, , z] = this.planes.planes[this.view].frame.toward;
    const looks = this.now.position.clone().sub(this.controls.target).normalize();
    return looks.x * x + looks.z * z < 0.9999;
  }

  /** Turning the view leaves the photo's camera: from elsewhere the photo would lie. */
  #leaveView() {
    const looks = this.now.position.clone().sub(this.controls.target).normalize();
    this.frame();
    const away = this.now.position.distanceTo(this.controls.target);
    this.now.position.copy(this.controls.target).addScaledVector(looks, away);
    this.controls.update();
    this.framed = false;
  }

  #use(camera) {
    this.now = camera;
    this.controls.object = camera;
    // Whoever moves with a photo's camera no longer sees what it saw.
    this.controls.enableZoom = this.controls.enablePan = camera === this.perspective;
  }

  /** In a photo's camera the wheel looks closer, without going nearer. */
  #watchWheel(canvas) {
    canvas.addEventListener("wheel", (event) => {
      if (this.view === null) return;
      event.preventDefault();
      this.zoom = Math.min(Math.max(this.zoom * Math.exp(-event.deltaY * 0.0012), 0.5), 12);
      this.#lookThrough();
      this.onMove();
    }, { passive: false });
  }
}
