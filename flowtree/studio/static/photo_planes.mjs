/** Photos in space: each stands behind the tree, as seen from its camera, or lies over the tree in that camera's view. */

import { THREE } from "nicegui-scene";
import { arrangedAnew } from "flowtree-studio/arranging.mjs";

/** The middle of a view's picture, its size and its directions, in metres. */
export function frameOf(view) {
  const angle = (view.yaw * Math.PI) / 180;
  const right = [Math.cos(angle), 0, -Math.sin(angle)];
  const toward = [Math.sin(angle), 0, Math.cos(angle)];
  const mpp = view.metres_per_pixel;
  const aside = (view.width / 2 - view.foot[0]) * mpp;
  const up = (view.foot[1] - view.height / 2) * mpp;
  return {
    right,
    toward,
    middle: [right[0] * aside, up, right[2] * aside],
    width: view.width * mpp,
    height: view.height * mpp,
    angle,
  };
}

/**
 * Gives a camera the eye of a photo: it stands where the photo was taken and looks level at the tree's axis, and its
 * frustum is shifted so that the photo's rectangle, in the plane through the axis, fills the frame.
 *
 * @param {THREE.PerspectiveCamera} camera whose projection is set
 * @param {{view: object, frame: object}} plane
 * @param {number} aspect of the frame
 * @param {number} zoom
 * @param {number} radius of the tree [m]
 * @returns {{place: number[], target: number[]}} where it stands, and the place of the axis that it looks at
 */
export function aimEye(camera, { view, frame }, aspect, zoom, radius) {
  // A parallel projection is one from very far away.
  const distance = view.distance ?? 100 * Math.max(frame.width, frame.height);
  const height = view.distance == null ? frame.middle[1] : view.eye;
  const aside = frame.middle[0] * frame.right[0] + frame.middle[2] * frame.right[2];
  const up = frame.middle[1] - height;
  const high = Math.max(frame.height / 2, frame.width / 2 / aspect) / zoom;
  const wide = high * aspect;
  const near = Math.max(distance - 3 * radius, distance / 100);
  const scale = near / distance;
  const ends = [aside - wide, aside + wide, up + high, up - high].map((end) => end * scale);
  camera.projectionMatrix.makePerspective(...ends, near, distance + 10 * radius);
  camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  const [x, , z] = frame.toward;
  return { place: [x * distance, height, z * distance], target: [0, height, 0] };
}

/**
 * Where the photo's corners lie in a view's picture, from the upper left one clockwise.
 *
 * @param {object} view as the layer "cameras" lists it
 * @returns {[number, number][]}
 */
export function cornersOf({ warp: m, frame: [width, height] }) {
  // The rows of the inverse, but for a common factor.
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const columns = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
  return [[0, 0], [width, 0], [width, height], [0, height]].map(([x, y]) => {
    const [u, v, w] = [0, 1, 2].map((k) => columns[0][k] * x + columns[1][k] * y + columns[2][k]);
    return [u / w, v / w];
  });
}

/** The picture without what lies beyond its photo's frame. */
function cutFrame(picture, view) {
  const canvas = document.createElement("canvas");
  canvas.width = picture.width;
  canvas.height = picture.height;
  const context = canvas.getContext("2d");
  const [across, down] = [picture.width / view.width, picture.height / view.height];
  context.beginPath();
  for (const [x, y] of cornersOf(view)) context.lineTo(x * across, y * down);
  context.clip();
  context.drawImage(picture, 0, 0);
  return canvas;
}

const AS_SEEN = { scale: 1, aside: 0, up: 0, turn: 0 };

export class PhotoPlanes {
  constructor() {
    this.group = new THREE.Group();
    this.planes = [];
    this.pictures = []; // by view; they may come before the views
    this.radius = 4;
  }

  /** @param {object[]} views as the layer "cameras" lists them */
  setViews(views) {
    this.clear();
    this.planes = views.map((view) => {
      const frame = frameOf(view);
      const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true, toneMapped: false });
      const mesh = new THREE.Mesh(new THREE.PlaneGeometry(frame.width, frame.height), material);
      mesh.visible = false;
      this.group.add(mesh);
      return { view, frame, mesh, anew: AS_SEEN };
    });
    this.planes.forEach((_, index) => this.#hang(index));
  }

  /** Has the planes stand as their photos are being arranged (`arranging.mjs`). */
  arrange(photos) {
    for (const plane of this.planes) {
      const photo = photos[plane.view.photo];
      plane.anew = photo ? arrangedAnew(plane.view, photo) : AS_SEEN;
    }
  }

  /** @param {HTMLImageElement | ImageBitmap} picture the view's straightened picture */
  setPicture(index, picture) {
    this.pictures[index] = picture;
    this.#hang(index);
  }

  #hang(index) {
    const plane = this.planes[index];
    const picture = this.pictures[index];
    if (!plane || !picture) return;
    const { material } = plane.mesh;
    material.map?.dispose();
    material.map = new THREE.CanvasTexture(cutFrame(picture, plane.view));
    material.map.colorSpace = THREE.SRGBColorSpace;
    material.map.anisotropy = 4;
    material.needsUpdate = true;
  }

  /**
   * @param {boolean} standing whether all photos stand behind the tree
   * @param {number | null} over the view whose photo lies over the tree
   * @param {number} blend its opacity
   */
  show(standing, over, blend) {
    this.planes.forEach(({ view, frame, mesh, anew }, i) => {
      const front = i === over;
      const away = front ? 0 : -this.radius; // what lies over the tree is drawn last, whatever is before it
      const angle = frame.angle + anew.turn;
      const aside = (frame.middle[0] * frame.right[0] + frame.middle[2] * frame.right[2]) * anew.scale + anew.aside;
      mesh.position.set(
        Math.cos(angle) * aside + Math.sin(angle) * away,
        frame.middle[1] * anew.scale + anew.up,
        -Math.sin(angle) * aside + Math.cos(angle) * away,
      );
      mesh.rotation.y = angle;
      mesh.scale.setScalar(anew.scale);
      mesh.material.opacity = front ? blend : 1;
      mesh.material.depthTest = !front;
      mesh.material.depthWrite = !front;
      mesh.renderOrder = front ? 10 : 0;
      const there = mesh.material.map != null;
      mesh.visible = there && (front ? blend > 0 : standing && over === null && !view.mirrored);
    });
  }

  clear() {
    for (const { mesh } of this.planes) {
      mesh.geometry.dispose();
      mesh.material.map?.dispose();
      mesh.material.dispose();
      this.group.remove(mesh);
    }
    this.planes = [];
  }
}
