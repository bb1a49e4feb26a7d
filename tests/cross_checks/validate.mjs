/**
 * Runs the Khronos glTF validator on every GLB below the given folders.
 *
 *     node validate.mjs FOLDER...
 *
 * Prints what it finds; the exit code is 1 on an error or a warning, or if there is no GLB.
 */

import { readdir, readFile } from 'node:fs/promises';
import path from 'node:path';
import validator from 'gltf-validator';

/** The validator's report of one file; images beside it are read too. */
async function report(file) {
  const beside = (uri) => readFile(path.join(path.dirname(file), decodeURIComponent(uri)));
  return validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) => new Uint8Array(await beside(uri)),
  });
}

let files = 0;
let faults = 0;
for (const folder of process.argv.slice(2)) {
  for (const name of await readdir(folder, { recursive: true })) {
    if (!name.endsWith('.glb')) continue;
    const { issues, info } = await report(path.join(folder, name));
    const { numErrors, numWarnings, numInfos, messages } = issues;
    console.log(`${path.join(folder, name)}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes,`
      + ` ${info.resources.filter((r) => r.image).length} images, ${info.totalTriangleCount} triangles`);
    for (const { severity, code, message, pointer } of messages) {
      console.log(`  ${['error', 'warning', 'note', 'hint'][severity]} ${code} ${pointer ?? ''}: ${message}`);
    }
    files += 1;
    faults += numErrors + numWarnings;
  }
}
console.log(`${files} files, validator ${validator.version()}`);
process.exit(files > 0 && faults === 0 ? 0 : 1);
