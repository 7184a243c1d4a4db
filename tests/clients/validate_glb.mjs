// Prints what Khronos' glTF validator says of each file as one JSON list. Run in the folder of node_modules.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const { validateBytes } = createRequire(process.cwd() + "/")("gltf-validator");
const reports = [];
for (const path of process.argv.slice(2)) {
  const report = await validateBytes(new Uint8Array(readFileSync(path)), { maxIssues: 100 });
  reports.push({ issues: report.issues, info: report.info });
}
console.log(JSON.stringify(reports));
