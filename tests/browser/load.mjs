// Loads a GLB as a game in a browser would, says what it became, and draws it.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const WIDTH = 480, HEIGHT = 640;
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(WIDTH, HEIGHT);
document.body.append(renderer.domElement);

window.load = async (name, shown = 0) => {
  const gltf = await new GLTFLoader().loadAsync(`/files/${name}`);
  const tree = gltf.scenes[shown];
  tree.updateMatrixWorld(true);
  const meshes = {};
  tree.traverse((object) => {
    if (!object.isMesh) return;
    const { index, attributes } = object.geometry;
    const triangles = ((index ?? attributes.position).count / 3) * (object.isInstancedMesh ? object.count : 1);
    meshes[object.name] = (meshes[object.name] ?? 0) + triangles;
    if (object.userData.collision) object.visible = false;
  });
  const box = new THREE.Box3().setFromObject(tree, true);
  const middle = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xbfd4e6);
  const sun = new THREE.DirectionalLight(0xfff2dd, 2.5);
  sun.position.set(-1, 2, 1.5);
  scene.add(tree, sun, new THREE.HemisphereLight(0xffffff, 0x6b6250, 2.2));
  const camera = new THREE.PerspectiveCamera(30, WIDTH / HEIGHT, 0.1, 1000);
  const reach = Math.max(size.y, (Math.max(size.x, size.z) * HEIGHT) / WIDTH);
  camera.position.set(middle.x, middle.y, middle.z + 2.25 * reach);
  camera.lookAt(middle);
  renderer.render(scene, camera);
  return {
    meshes,
    bounds: [box.min.toArray(), box.max.toArray()],
    scenes: gltf.scenes.map((each) => each.name),
    animations: gltf.animations.map((each) => each.name),
    picture: renderer.domElement.toDataURL("image/png"),
  };
};
window.ready = true;
