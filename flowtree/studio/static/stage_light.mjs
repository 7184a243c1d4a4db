/** Sun, sky and ground around the tree. */

import { THREE } from "nicegui-scene";

const SUN = new THREE.Vector3(-0.55, 0.95, 0.75).normalize();

export class StageLight {
  constructor(scene) {
    this.sky = new THREE.HemisphereLight("#eaf1f8", "#9a9484", 3.4);
    this.sun = new THREE.DirectionalLight("#fff3e0", 4.2);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 3;
    this.ground = new THREE.Mesh(
      new THREE.CircleGeometry(1, 64).rotateX(-Math.PI / 2),
      new THREE.ShadowMaterial({ opacity: 0.3 }),
    );
    this.ground.receiveShadow = true;
    this.rings = new THREE.Group();
    scene.add(this.sky, this.sun, this.sun.target, this.ground, this.rings);
    this.fitted = 0;
  }

  /** Sun and ground for a tree of a size [m]. */
  fit(height, radius) {
    const reach = Math.max(height, 2 * radius) * 0.75;
    this.sun.target.position.set(0, height / 2, 0);
    this.sun.position.copy(SUN).multiplyScalar(reach * 3).add(this.sun.target.position);
    const { camera } = this.sun.shadow;
    Object.assign(camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1, far: reach * 8 });
    camera.updateProjectionMatrix();
    this.sun.shadow.bias = -0.0006;
    this.sun.shadow.normalBias = 0.02;
    this.ground.scale.setScalar(reach * 2.4);
    if (Math.abs(this.fitted - reach) > 0.1 * reach) this.#drawRings(reach);
  }

  /** Circles on the ground, one every metre (or two, five, ten) from the trunk. */
  #drawRings(reach) {
    this.fitted = reach;
    this.rings.clear();
    const step = [1, 2, 5, 10, 20].find((metres) => reach / metres <= 8) ?? 50;
    for (let r = step; r <= reach * 1.5; r += step) {
      const points = Array.from({ length: 129 }, (_, i) => {
        const angle = (i / 64) * Math.PI;
        return new THREE.Vector3(Math.sin(angle) * r, 0, Math.cos(angle) * r);
      });
      const material = new THREE.LineBasicMaterial({
        color: "#808a84",
        transparent: true,
        opacity: 0.3 * Math.max(0.15, 1 - r / (reach * 1.6)),
        depthWrite: false,
      });
      this.rings.add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), material));
    }
  }

  setShadows(on) {
    this.ground.visible = on;
  }
}
