// Shows a tree in the wind: by its joints as three.js plays them, or by the shader recipe.
import * as THREE from "three";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";

const WIDTH = 480, HEIGHT = 640;
const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
renderer.setSize(WIDTH, HEIGHT);
document.body.append(renderer.domElement);
const scene = new THREE.Scene();
scene.background = new THREE.Color(0xbfd4e6);
scene.add(new THREE.HemisphereLight(0xffffff, 0x6b6250, 2.2));
const sun = new THREE.DirectionalLight(0xfff2dd, 2.5);
sun.position.set(-1, 2, 1.5);
scene.add(sun);
const camera = new THREE.PerspectiveCamera(30, WIDTH / HEIGHT, 0.1, 1000);
const clock = { value: 0 };
let tree, mixer, action;

window.load = async (name) => {
  const gltf = await new GLTFLoader().loadAsync(`/files/${name}`);
  if (tree) scene.remove(tree);
  tree = gltf.scene;
  scene.add(tree);
  mixer = action = undefined;
  if (gltf.animations.length) {
    mixer = new THREE.AnimationMixer(tree);
    action = mixer.clipAction(gltf.animations[0]);
    action.setLoop(THREE.LoopOnce);
    action.clampWhenFinished = true;
    action.play();
  }
  const box = new THREE.Box3().setFromObject(tree);
  const middle = box.getCenter(new THREE.Vector3()), size = box.getSize(new THREE.Vector3());
  const reach = Math.max(size.y, (Math.max(size.x, size.z) * HEIGHT) / WIDTH);
  camera.position.set(middle.x, middle.y, middle.z + 2.25 * reach);
  camera.lookAt(middle);
  return { seconds: gltf.animations[0]?.duration ?? 0, meshes: meshes().map((mesh) => mesh.name) };
};

window.look = (from, at) => {
  camera.position.set(...from);
  camera.lookAt(...at);
};

const meshes = () => {
  const found = [];
  tree.traverse((object) => object.isMesh && found.push(object));
  return found;
};

const turnTo = (time) => {
  clock.value = time;
  if (action) {
    action.time = 0;
    action.paused = action.enabled = false;
    action.reset().play();
    mixer.setTime(time);
  }
  scene.updateMatrixWorld(true);
};

// Where three.js puts every vertex of a mesh, in the world, as [x, y, z, x, …].
window.places = (name, time) => {
  turnTo(time);
  const mesh = meshes().find((each) => each.name === name);
  const place = new THREE.Vector3(), all = [];
  for (let k = 0; k < mesh.geometry.attributes.position.count; k++) {
    mesh.getVertexPosition(k, place).applyMatrix4(mesh.matrixWorld);
    all.push(place.x, place.y, place.z);
  }
  return all;
};

window.picture = (time) => {
  turnTo(time);
  renderer.render(scene, camera);
  return renderer.domElement.toDataURL("image/png");
};

// The recipe's attributes as three.js calls them, and what GLSL calls them.
const NAMES = { _wind_limb: "vec3", _wind_branch: "vec3", _wind_extent: "vec4", _wind_phase: "vec4" };
const DECLARED = Object.entries(NAMES).map(([name, type]) => `attribute ${type} ${name};`).join("\n");
const CALL = "_wind_limb, _wind_branch, _wind_extent, _wind_phase, wind, windTime, flutter)";

// Lets three.js' own materials follow the recipe.
window.follow = (recipe, wind, flutter) => {
  const uniforms = { wind: { value: new THREE.Vector3(...wind) }, windTime: clock, flutter: { value: flutter } };
  for (const mesh of meshes()) {
    mesh.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, uniforms);
      const head = `${DECLARED}\nuniform vec3 wind;\nuniform float windTime, flutter;\n${recipe}\n`;
      const moved = `vec3 transformed = sway(position, normal, ${CALL};`;
      shader.vertexShader = head + shader.vertexShader.replace("#include <begin_vertex>", moved);
    };
    mesh.material.needsUpdate = true;
  }
};

// What the recipe itself computes on the graphics card, read back: [x, y, z, x, …].
window.compute = (name, recipe, wind, time, flutter) => {
  const gl = document.createElement("canvas").getContext("webgl2");
  const types = { position: "vec3", normal: "vec3", ...NAMES };
  const inputs = Object.entries(types).map(([key, type]) => `in ${type} ${key};`).join("\n");
  const source = `#version 300 es\n${inputs}\nuniform vec3 wind;\nuniform float windTime, flutter;\nout vec3 moved;
${recipe}\nvoid main() { moved = sway(position, normal, ${CALL}; }`;
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, source],
    [gl.FRAGMENT_SHADER, "#version 300 es\nvoid main() {}"],
  ]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    gl.attachShader(program, shader);
  }
  gl.transformFeedbackVaryings(program, ["moved"], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const { attributes } = meshes().find((each) => each.name === name).geometry;
  const count = attributes.position.count;
  const kinds = new Map([[Float32Array, gl.FLOAT], [Uint16Array, gl.UNSIGNED_SHORT], [Uint8Array, gl.UNSIGNED_BYTE]]);
  for (const key of Object.keys(types)) {
    const at = gl.getAttribLocation(program, key), { array, itemSize, normalized } = attributes[key];
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, itemSize, kinds.get(array.constructor), normalized, 0, 0);
  }
  gl.bindBuffer(gl.ARRAY_BUFFER, null);
  gl.uniform3fv(gl.getUniformLocation(program, "wind"), wind);
  gl.uniform1f(gl.getUniformLocation(program, "windTime"), time);
  gl.uniform1f(gl.getUniformLocation(program, "flutter"), flutter);
  const out = gl.createBuffer();
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, out);
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, count * 12, gl.STREAM_READ);
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, null);
  gl.bindTransformFeedback(gl.TRANSFORM_FEEDBACK, gl.createTransformFeedback());
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, out);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, count);
  gl.endTransformFeedback();
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, out);
  const moved = new Float32Array(count * 3);
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, moved);
  return Array.from(moved);
};

window.ready = true;
