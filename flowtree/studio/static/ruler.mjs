/** Measuring in the viewer: how high a place is, and how far it is from the one before. */

import { THREE } from "nicegui-scene";

export class Ruler {
  constructor(scene, host) {
    this.group = new THREE.Group();
    this.group.renderOrder = 20;
    scene.add(this.group);
    this.host = host;
    this.labels = []; // {element, at}
    this.points = [];
  }

  /** Adds the place under a pointer: of the tree, or where it has a gap or ends, of the plane through its axis. */
  measure(event, canvas, camera, tree) {
    const box = canvas.getBoundingClientRect();
    const place = new THREE.Vector2(
      ((event.clientX - box.x) / box.width) * 2 - 1,
      1 - ((event.clientY - box.y) / box.height) * 2,
    );
    camera.updateMatrixWorld();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, camera);
    const hit = tree && ray.intersectObject(tree, true).find(({ object }) => object.visible);
    const point = hit ? hit.point : throughAxis(ray.ray, camera);
    if (point) this.add(point);
  }

  add(point) {
    if (this.points.length === 2) this.clear();
    this.points.push(point);
    this.#line([point, new THREE.Vector3(point.x, 0, point.z)], "#7fd1ff");
    this.#label(point, `${point.y.toFixed(2)} m high`);
    if (this.points.length === 2) {
      const [first, second] = this.points;
      this.#line([first, second], "#ffd166");
      this.#label(first.clone().lerp(second, 0.5), `${first.distanceTo(second).toFixed(2)} m`);
    }
  }

  clear() {
    for (const child of this.group.children) child.geometry.dispose();
    this.group.clear();
    for (const { element } of this.labels) element.remove();
    this.labels = [];
    this.points = [];
  }

  /** Brings the labels to where their places are on the screen. */
  follow(camera, width, height) {
    for (const { element, at } of this.labels) {
      const [x, y, z] = at.clone().project(camera).toArray();
      element.style.transform = `translate(${((x + 1) * width) / 2 + 10}px, ${((1 - y) * height) / 2 - 10}px)`;
      element.style.visibility = Math.abs(z) < 1 ? "visible" : "hidden";
    }
  }

  #line(points, color) {
    const material = new THREE.LineBasicMaterial({ color, depthTest: false, transparent: true });
    const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), material);
    line.renderOrder = 20;
    this.group.add(line);
  }

  #label(at, text) {
    const element = document.createElement("div");
    element.className = "ruler-label";
    element.textContent = text;
    this.host.append(element);
    this.labels.push({ element, at });
  }
}

/** Where a ray meets the upright plane through the y axis that faces the camera; null below the ground. */
export function throughAxis(ray, camera) {
  const normal = camera.getWorldDirection(new THREE.Vector3()).setY(0).normalize();
  const point = ray.intersectPlane(new THREE.Plane(normal, 0), new THREE.Vector3());
  return point && point.y >= 0 ? point : null;
}
