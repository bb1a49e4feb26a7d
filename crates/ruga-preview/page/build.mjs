/**
 * Bundles the page's scripts and three.js into `bundle.js`, which is committed: `cargo build` needs no npm.
 *
 *     npm install && npm run build        what `cargo xtask page` does
 *
 * The first line of the bundle holds a hash of the sources; a test of the crate compares it.
 */

import { readFile, readdir, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { build } from 'esbuild';

const here = import.meta.dirname;

/** FNV-1a of 64 bits over the names and texts of the sources in alphabetical order. */
async function hashOfSources() {
  const names = (await readdir(here)).filter((name) => /\.mjs$|^package\.json$/.test(name)).sort();
  let hash = 0xcbf29ce484222325n;
  for (const name of names) {
    const text = (await readFile(path.join(here, name), 'utf8')).replaceAll('\r\n', '\n');
    for (const byte of new TextEncoder().encode(`${name}\n${text}`)) {
      hash = ((hash ^ BigInt(byte)) * 0x100000001b3n) & 0xffffffffffffffffn;
    }
  }
  return hash.toString(16).padStart(16, '0');
}

const three = path.join(here, 'node_modules', 'three');
const { version } = JSON.parse(await readFile(path.join(three, 'package.json'), 'utf8'));
const licence = (await readFile(path.join(three, 'LICENSE'), 'utf8')).trim();
const { outputFiles } = await build({
  entryPoints: [path.join(here, 'main.mjs')],
  bundle: true,
  minify: true,
  format: 'iife',
  target: 'es2022',
  charset: 'ascii',
  legalComments: 'none',
  write: false,
});
const [{ text }] = outputFiles;
if (/<\/script|<!--/i.test(text)) throw new Error('the bundle would end the script element it stands in');
const header = `/* sources ${await hashOfSources()}; made by \`cargo xtask page\`\n\n`
  + `Contains parts of three.js ${version} (https://threejs.org):\n\n${licence}\n*/\n`;
await writeFile(path.join(here, 'bundle.js'), header + text);
console.log(`bundle.js: ${Math.round((header.length + text.length) / 1000)} kB, three.js ${version}`);
