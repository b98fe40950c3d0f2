// node tools/tint.mjs PACKAGE FOLDER: compiles the WGSL files of a folder with Tint, by the npm package webgpu (Dawn),
// and fails where it reports an error.
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

const [dawn, folder] = process.argv.slice(2);
const { create } = await import(pathToFileURL(join(dawn, "index.js")));
// The null backend parses and validates shaders without a graphics driver.
globalThis.gpu = create(["backend=null"]); // the device ends with it
const adapter = await gpu.requestAdapter();
const requiredFeatures = ["primitive-index"].filter((name) => adapter.features.has(name));
const device = await adapter.requestDevice({ requiredFeatures });
const files = readdirSync(folder).filter((name) => name.endsWith(".wgsl"));
let failed = 0;
for (const name of files) {
  device.pushErrorScope("validation");
  const shader = device.createShaderModule({ code: readFileSync(join(folder, name), "utf8") });
  const { messages } = await shader.getCompilationInfo();
  const refused = await device.popErrorScope();
  const errors = messages.filter(({ type }) => type === "error");
  for (const { lineNum, linePos, message } of errors) {
    console.error(`${join(folder, name)}:${lineNum}:${linePos}: ${message}`);
  }
  failed += errors.length > 0 || refused !== null ? 1 : 0;
}
console.log(failed > 0 ? `${failed} of ${files.length} shaders do not compile` : `${files.length} shaders compile`);
process.exit(failed > 0 ? 1 : 0);
