/** The objects of the viewer's scene, by the layer that each shows; a new one takes the place of the one before. */

import { GLTFLoader, THREE } from "nicegui-scene";
import { arrangedAnew } from "flowtree-studio/arranging.mjs";
import { fieldArrows, flowParticles, skeletonRibbons, voxelCloud } from "flowtree-studio/layer_objects.mjs";
import { readField, readFlow, readSkeleton, readVoxels } from "flowtree-studio/read_layers.mjs";

/** Layers of numbers, and what a person calls each. */
export const SHOWN_AS = { voxels: "density", field: "field", flow: "flow", skeleton: "skeleton" };
const READERS = { voxels: readVoxels, field: readField, flow: readFlow, skeleton: readSkeleton };

export class ViewerLayers {
  constructor(scene) {
    this.scene = scene;
    this.urls = {}; // of the newest layer of each name
    this.objects = {};
    this.data = {}; // name -> {url, values}
    this.treeRevision = -1;
    this.views = []; // that what comes now is made from
    this.arranged = [];
  }

  /** @param {object[]} views as the layer "cameras" lists them */
  setViews(views) {
    for (const object of Object.values(this.objects)) if (object && !object.userData.views) object.userData.views = views;
    this.views = views;
  }

  /**
   * Has everything stand as the photos are being arranged (`arranging.mjs`): as wide, and as far aside, as its photo
   * is moved and scaled. It is as high as before, for all photos show the same height.
   */
  arrange(photos) {
    this.arranged = photos;
    for (const object of Object.values(this.objects)) if (object) this.#arrange(object);
  }

  #arrange(object) {
    const matrix = new THREE.Matrix4();
    for (const view of object.userData.views ?? []) {
      const photo = this.arranged[view.photo];
      if (!photo || view.mirrored) continue;
      const { scale, aside } = arrangedAnew(view, photo);
      const turn = new THREE.Matrix4().makeRotationY((view.yaw * Math.PI) / 180);
      const moved = new THREE.Matrix4().makeScale(scale, 1, 1).setPosition(aside, 0, 0);
      matrix.premultiply(turn.clone().multiply(moved).multiply(turn.invert()));
    }
    object.matrixAutoUpdate = false;
    object.matrix.copy(matrix);
    object.matrixWorldNeedsUpdate = true;
  }

  /**
   * Loads a tree, coarse or full.
   *
   * @returns {Promise<THREE.Group | null>} null where a newer one is shown, or on its way
   */
  async loadTree(name, url) {
    const revision = Number(url.split("/")[2]);
    const { scene } = await new GLTFLoader().loadAsync(url);
    if (this.urls[name] !== url || revision < this.treeRevision) {
      dispose(scene);
      return null;
    }
    this.treeRevision = revision;
    scene.traverse((node) => {
      if (!node.isMesh) return;
      node.castShadow = node.receiveShadow = true;
      if (node.material.map) node.material.map.anisotropy = 4;
    });
    this.replace("tree", scene);
    return scene;
  }

  /** Fetches a layer of numbers. @returns {Promise<boolean>} whether there is something new to show */
  async fetch(name) {
    const url = this.urls[name];
    if (!url || this.data[name]?.url === url) return false;
    const answer = await fetch(url);
    if (!answer.ok) return false;
    const values = READERS[name](await answer.arrayBuffer());
    if (this.urls[name] !== url) return false;
    this.data[name] = { url, values };
    return true;
  }

  /** Makes a layer's object anew, of the numbers that are there. */
  build(name, { height, skeletonBy }) {
    const { values } = this.data[name];
    const makers = {
      voxels: () => voxelCloud(values),
      field: () => fieldArrows(values, height * 0.03),
      flow: () => flowParticles(values),
      skeleton: () => skeletonRibbons(values, skeletonBy),
    };
    this.replace(name, makers[name]());
  }

  replace(name, object) {
    const before = this.objects[name];
    if (before) {
      this.scene.remove(before);
      dispose(before);
    }
    this.objects[name] = object;
    if (!object) return;
    if (this.views.length > 0) object.userData.views = this.views;
    this.#arrange(object);
    this.scene.add(object);
  }

  remove(name) {
    delete this.urls[name];
    delete this.data[name];
    this.replace(name, null);
  }

  /** Tells the layers how large a pixel is. */
  setScale(width, height, ratio) {
    const { voxels, flow, skeleton } = this.objects;
    if (voxels) voxels.material.uniforms.scale.value = (height * ratio) / 2;
    flow?.setScale(ratio);
    skeleton?.material.uniforms.resolution.value.set(width * ratio, height * ratio);
  }
}

function dispose(object) {
  object.traverse((node) => {
    node.geometry?.dispose();
    for (const material of [node.material ?? []].flat()) {
      material.map?.dispose();
      material.normalMap?.dispose();
      material.dispose();
    }
  });
}
