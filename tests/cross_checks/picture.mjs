/**
 * Draws a baked mesh in a headless browser with three.js: poses blended as wrinkles.json says,
 * light grazing from the upper left.
 *
 *     node picture.mjs BAKED OUT.png POSE=WEIGHT...
 *     node picture.mjs BAKED OUT.png --skin SKIN.obj      simulated geometry, same light, no maps
 *
 * Between keys the maps of a pose are blended linearly, those of several poses are laid over each
 * other by reoriented normal mapping. The exit code is 1 if the page reports an error.
 */

import { readFile } from 'node:fs/promises';
import path from 'node:path';
import chromium from '@sparticuz/chromium';
import puppeteer from 'puppeteer-core';

const here = import.meta.dirname;
const [baked, output, ...rest] = process.argv.slice(2);
const skin = rest[0] === '--skin' ? rest[1] : null;
const weights = skin ? {} : Object.fromEntries(rest.map((p) => p.split('=')).map(([p, w]) => [p, Number(w)]));

/** What the page may ask for: itself, three.js, the baked folder, the skin. */
function fileOf(url) {
  const name = decodeURIComponent(new URL(url).pathname.slice(1));
  if (name === 'skin.obj') return skin;
  if (name.startsWith('three/')) return path.join(here, 'node_modules', name);
  return name === 'page.html' || name === 'page.mjs' ? path.join(here, name) : path.join(baked, name);
}

const types = { '.html': 'text/html', '.js': 'text/javascript', '.mjs': 'text/javascript', '.png': 'image/png' };

async function answer(request) {
  const file = fileOf(request.url());
  try {
    const contentType = types[path.extname(file)] ?? 'application/octet-stream';
    await request.respond({ body: await readFile(file), contentType });
  } catch {
    await request.respond({ status: 404, body: file });
  }
}

const browser = await puppeteer.launch({
  args: [...chromium.args, '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
  executablePath: await chromium.executablePath(),
  headless: 'shell',
});
let faults = 0;
try {
  const page = await browser.newPage();
  await page.setViewport({ width: 1024, height: 1024 });
  await page.setRequestInterception(true);
  page.on('request', answer);
  page.on('console', (message) => {
    console.log(`  page: ${message.text()}`);
    faults += Number(message.type() === 'error');
  });
  page.on('pageerror', (error) => {
    console.log(`  page: ${error.message}`);
    faults += 1;
  });
  await page.goto('http://baked.invalid/page.html');
  const drawn = await page.evaluate((wishes) => window.draw(wishes), { weights, skin: skin !== null });
  await page.screenshot({ path: output });
  console.log(`${output}: ${drawn}; ${await browser.version()}`);
} finally {
  await browser.close();
}
process.exit(faults === 0 ? 0 : 1);
