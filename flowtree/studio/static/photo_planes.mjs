/** Photos in space: each stands behind the tree, as seen from its camera, or lies over the tree in that camera's view. */

import { THREE } from "nicegui-scene";

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

export class PhotoPlanes {
  constructor() {
    this.group = new THREE.Group();
    this.planes = [];
    this.pictures = []; // textures by view; they may come before the views
    this.radius = 4;
  }

  /** @param {object[]} views as the layer "cameras" lists them */
  setViews(views) {
    this.clear();
    this.planes = views.map((view) => {
      const frame = frameOf(view);
      const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, transparent: true, toneMapped: false });
      const mesh = new THREE.Mesh(new THREE.PlaneGeometry(frame.width, frame.height), material);
      mesh.rotation.y = frame.angle;
      mesh.visible = false;
      this.group.add(mesh);
      return { view, frame, mesh };
    });
    this.planes.forEach((_, index) => this.#hang(index));
  }

  setPicture(index, texture) {
    this.pictures[index]?.dispose();
    texture.colorSpace = THREE.SRGBColorSpace;
    this.pictures[index] = texture;
    this.#hang(index);
  }

  #hang(index) {
    const plane = this.planes[index];
    if (!plane || !this.pictures[index]) return;
    plane.mesh.material.map = this.pictures[index];
    plane.mesh.material.needsUpdate = true;
  }

  /**
   * @param {boolean} standing whether all photos stand behind the tree
   * @param {number | null} over the view whose photo lies over the tree
   * @param {number} blend its opacity
   */
  show(standing, over, blend) {
    this.planes.forEach(({ view, frame, mesh }, i) => {
      const front = i === over;
      const away = this.radius * (front ? 1 : -1);
      mesh.position.set(
        frame.middle[0] + frame.toward[0] * away,
        frame.middle[1],
        frame.middle[2] + frame.toward[2] * away,
      );
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
      mesh.material.dispose();
      this.group.remove(mesh);
    }
    this.planes = [];
  }
}
