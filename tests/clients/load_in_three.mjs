// Loads each GLB with three.js and prints what it became as one JSON list. Run in the folder of node_modules.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

// What a browser has and Node does not, as far as GLTFLoader asks for it. A picture is decoded as far as its size.
globalThis.self = globalThis;
globalThis.createImageBitmap = async (blob) => {
  const bytes = new DataView(await blob.arrayBuffer());
  if (bytes.getUint32(0) === 0x89504e47) return { width: bytes.getUint32(16), height: bytes.getUint32(20), close() {} };
  for (let at = 2; at < bytes.byteLength; at += 2 + bytes.getUint16(at + 2)) {
    const marker = bytes.getUint16(at);
    if (marker >= 0xffc0 && marker <= 0xffc2) {
      return { width: bytes.getUint16(at + 7), height: bytes.getUint16(at + 5), close() {} };
    }
  }
  throw new Error("neither PNG nor JPEG");
};

const modules = pathToFileURL(process.cwd() + "/node_modules/three/").href;
const { Box3 } = await import(modules + "build/three.module.js");
const { GLTFLoader } = await import(modules + "examples/jsm/loaders/GLTFLoader.js");

const picture = (map) => (map ? [map.image.width, map.image.height] : null);
const reports = [];
for (const path of process.argv.slice(2)) {
  const data = readFileSync(path);
  const bytes = data.buffer.slice(data.byteOffset, data.byteOffset + data.byteLength);
  const { scene } = await new GLTFLoader().parseAsync(bytes, "");
  const box = new Box3().setFromObject(scene, true);
  const meshes = {};
  const nodes = [];
  scene.traverse((object) => {
    nodes.push(object.name);
    if (!object.isMesh) return;
    const { geometry, material } = object;
    meshes[object.name] = {
      triangles: (geometry.index ?? geometry.attributes.position).count / 3,
      attributes: Object.keys(geometry.attributes).sort(),
      material: material.name,
      map: picture(material.map),
      normalMap: picture(material.normalMap),
      vertexColors: material.vertexColors,
      alphaTest: material.alphaTest,
      doubleSided: material.side === 2,
      metalness: material.metalness,
      roughness: material.roughness,
    };
  });
  reports.push({ nodes, meshes, bounds: [box.min.toArray(), box.max.toArray()] });
}
console.log(JSON.stringify(reports));
