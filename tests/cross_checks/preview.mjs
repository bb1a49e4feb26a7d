/**
 * Opens the preview page of a baked folder from disk in a headless browser, and tests it.
 *
 *     node preview.mjs BAKED [REFERENCE] [--shots FOLDER]
 *     node preview.mjs PLAN.html [--shots FOLDER]
 *
 * - The page loads without an error, asks for no other file, and a slider changes the picture.
 * - REFERENCE is a folder of `cargo run --release -p ruga-preview --example blend -- BAKED REFERENCE`: the
 *   blended normals of the page are within 2/255 of each of its pictures.
 * - Tangents at rest are those of the GLB (median and 99th percentile of their angle, degrees).
 * - PLAN.html is a page of `ruga plan --preview`: the mesh has the colours of the legend where the plan of a pose
 *   has them, each pose its own, and there are notes on it.
 * - Frame time with all poses on, bytes of the page, of the heap and of the maps on the graphics card.
 *
 * The browser draws in software (SwiftShader): times are those of processors, not of a graphics card. The exit
 * code is 1 when something is not as it should be.
 */

import { mkdir, readFile, readdir, stat } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import chromium from '@sparticuz/chromium';
import puppeteer from 'puppeteer-core';

const words = process.argv.slice(2);
const at = words.indexOf('--shots');
const shots = at < 0 ? null : words.splice(at, 2)[1];
const [baked, reference] = words;
if (shots) await mkdir(shots, { recursive: true });
const isPlan = baked.endsWith('.html');
const file = isPlan ? path.resolve(baked) : path.resolve(baked, 'preview.html');

/** Largest difference from the reference, in steps of 1/255. */
const LIMIT = 2;

const browser = await puppeteer.launch({
  args: [...chromium.args, '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--enable-precise-memory-info'],
  executablePath: await chromium.executablePath(),
  headless: 'shell',
  protocolTimeout: 600_000,
});
let faults = 0;
const check = (holds, text) => {
  console.log(`${holds ? 'ok   ' : 'WRONG'} ${text}`);
  faults += Number(!holds);
};

async function open() {
  const page = await browser.newPage();
  await page.setViewport({ width: 1280, height: 800 });
  page.on('console', (message) => {
    if (['error', 'warn'].includes(message.type())) check(false, `console: ${message.text()}`);
  });
  page.on('pageerror', (error) => check(false, `page: ${error.message}`));
  page.on('request', (request) => {
    if (!/^(data|blob):/.test(request.url()) && request.url() !== pathToFileURL(file).href) check(false, `asks for ${request.url()}`);
  });
  const start = performance.now();
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector('body[data-ready]', { timeout: 120_000 });
  check(true, `loaded in ${Math.round(performance.now() - start)} ms`);
  return page;
}

/** Weights as in `smile=0.5+frown=1`. */
const parsed = (name) => Object.fromEntries(name.split('+').map((part) => part.split('=')).map(([pose, weight]) => [pose, Number(weight)]));

async function pose(page, weights) {
  return page.evaluate(async (wanted) => {
    const { controls, preview } = window.ruga;
    preview.poses.forEach(({ name }, number) => { controls.sliders[number].input.value = wanted[name] ?? 0; });
    return controls.apply();
  }, weights);
}

/** Largest and mean difference of the page's normals from a picture of the reference, in steps of 1/255. */
async function difference(page, picture) {
  const bytes = (await readFile(picture)).toString('base64');
  return page.evaluate(async (data) => {
    const blob = new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: 'image/png' });
    const image = await createImageBitmap(blob, { colorSpaceConversion: 'none' });
    const canvas = new OffscreenCanvas(image.width, image.height);
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    const wanted = context.getImageData(0, 0, image.width, image.height).data;
    const found = window.ruga.stage.texels();
    if (found.length !== wanted.length) return { largest: Infinity };
    let [largest, sum, tilted] = [0, 0, 0];
    for (let i = 0; i < found.length; i += 1) {
      if (i % 4 === 3) continue;
      const apart = Math.abs(found[i] - wanted[i]);
      largest = Math.max(largest, apart);
      sum += apart;
      tilted += Number(i % 4 === 0 && Math.abs(wanted[i] - 128) > 3);
    }
    return { largest, mean: sum / found.length, tilted };
  }, bytes);
}

async function sliderChangesPixels(page) {
  const picture = () => page.evaluate(() => { window.ruga.stage.draw(); return window.ruga.stage.canvas.toDataURL(); });
  // Of a plan there are no maps to be blended.
  const on = (count) => {
    const { weights, slots, preview } = window.ruga.stage;
    return weights.filter((weight) => weight > 0).length === count && (preview.about.plan || slots.active === count);
  };
  await pose(page, {});
  const rest = await picture();
  await page.focus('#pose0');
  for (let press = 0; press < 3; press += 1) await page.keyboard.press('PageUp');
  await page.waitForFunction(on, {}, 1);
  const value = await page.$eval('#pose0', (input) => Number(input.value));
  check(value > 0 && (await picture()) !== rest, `a slider, moved by the keyboard to ${value}, changes the picture`);
  await page.click('#reset');
  await page.waitForFunction(on, {}, 0);
  check((await picture()) === rest, 'Reset brings back the picture of rest');
}

/** Angles between the page's tangents at rest and those of the GLB. */
async function tangents(page, glb) {
  const length = glb.readUInt32LE(12);
  const json = JSON.parse(glb.subarray(20, 20 + length));
  const binary = glb.subarray(28 + length);
  const { mesh: name } = JSON.parse(await readFile(path.join(baked, 'wrinkles.json'), 'utf8'));
  const { primitives } = json.meshes.find((mesh) => mesh.name === name) ?? json.meshes[0];
  if (primitives.length > 1) return console.log(`not checked: tangents of ${primitives.length} primitives`);
  const accessor = json.accessors[primitives[0].attributes.TANGENT];
  const view = json.bufferViews[accessor.bufferView];
  const start = (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0);
  const values = Array.from({ length: 4 * accessor.count }, (_, i) => binary.readFloatLE(start + 4 * i));
  await pose(page, {});
  const found = await page.evaluate(() => Array.from(window.ruga.stage.posed.tangents));
  if (found.length !== values.length) return check(false, `tangents: ${found.length} values, the GLB has ${values.length}`);
  const angles = [];
  let signs = 0;
  for (let v = 0; v < values.length; v += 4) {
    const cosine = values[v] * found[v] + values[v + 1] * found[v + 1] + values[v + 2] * found[v + 2];
    angles.push((Math.acos(Math.min(1, Math.max(-1, cosine))) * 180) / Math.PI);
    signs += Number(values[v + 3] !== found[v + 3]);
  }
  angles.sort((a, b) => a - b);
  const [median, high] = [0.5, 0.99].map((share) => angles[Math.floor(share * (angles.length - 1))]);
  check(high < 1 && signs === 0, `tangents at rest: median ${median.toFixed(3)}, 99 % ${high.toFixed(3)} degrees off the GLB's, ${signs} signs differ`);
}

/** What the page of a plan shows: pictures of poses in the legend's colours. */
async function plan(page) {
  const { poses, about } = await page.evaluate(() => window.ruga.preview.about).then((about) => ({ poses: about.poses, about }));
  check(await page.$eval('#legend', ({ hidden }) => !hidden), 'the legend is there');
  check(await page.$eval('#view-map', ({ hidden }) => hidden), 'there is no view of maps');
  const seen = new Set();
  for (const [number, { name, plan: { notes, overlays } }] of poses.entries()) {
    await pose(page, { [name]: 1 });
    const wanted = overlays[0];
    await page.waitForFunction((picture) => window.ruga.stage.overlay.shown === picture, {}, wanted);
    const words = await page.$eval('#notes', ({ textContent }) => textContent);
    check(words.startsWith(name) && notes.every((note) => words.includes(note)), `${name}: ${notes.join('; ') || 'nothing wrinkles'}`);
    // The share of the picture whose hue is one of the ramp's, which is all warm: red at least 40 above blue.
    const { warm, picture } = await page.evaluate(() => {
      const { stage } = window.ruga;
      stage.draw();
      const { width, height } = stage.canvas;
      const context = new OffscreenCanvas(width, height).getContext('2d');
      context.drawImage(stage.canvas, 0, 0);
      const { data } = context.getImageData(0, 0, width, height);
      let warm = 0;
      for (let i = 0; i < data.length; i += 4) warm += Number(data[i] > data[i + 2] + 40);
      return { warm: warm / (width * height), picture: stage.canvas.toDataURL() };
    });
    check((warm > 0.001) === (wanted !== null), `${name}: ${(100 * warm).toFixed(1)} % of the picture has a colour of wrinkles`);
    check(!seen.has(picture), `${name}: unlike the ${number} before`);
    seen.add(picture);
    if (shots) await page.screenshot({ path: path.join(shots, `plan-${name}.png`) });
  }
  const layers = about.plan.layers.length;
  check((await page.$eval('#layer-row', ({ hidden }) => hidden)) === (layers < 2), `${layers} layers to choose from`);
  if (layers > 1) {
    const before = await page.evaluate(() => window.ruga.stage.overlay.shown);
    await page.select('#layer', '1');
    await page.waitForFunction((picture) => window.ruga.stage.overlay.shown !== picture, {}, before);
    check(true, `the second is ${about.plan.layers[1]}`);
  }
}

async function measure(page) {
  const all = await page.evaluate(() => window.ruga.preview.poses.map(({ name }) => name));
  for (const count of [...new Set([1, all.length])]) {
    await pose(page, Object.fromEntries(all.slice(0, count).map((name) => [name, 0.7])));
    const times = await page.evaluate(async () => {
      const { stage } = window.ruga;
      const gl = stage.renderer.getContext();
      const pixel = new Uint8Array(4);
      const timed = (work) => { const start = performance.now(); work(); return performance.now() - start; };
      // A pixel that is read waits for the picture.
      const draw = () => { stage.draw(); gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); };
      draw();
      const median = (list) => list.sort((a, b) => a - b)[list.length >> 1];
      return {
        draw: median(Array.from({ length: 9 }, () => timed(draw))),
        pose: median(Array.from({ length: 9 }, () => timed(() => stage.posed.take(stage.weights)))),
        heap: performance.memory.usedJSHeapSize,
        maps: stage.slots.bytes,
        slot: `${stage.slots.layers.length} of ${stage.slots.width} x ${stage.slots.height}`,
      };
    });
    console.log(`      ${count} poses on: ${times.draw.toFixed(1)} ms a picture of 1008 x 800 in software, ${times.pose.toFixed(1)} ms to pose the mesh; heap ${(times.heap / 1e6).toFixed(0)} MB, maps on the card ${(times.maps / 1e6).toFixed(0)} MB (${times.slot})`);
  }
  console.log(`      ${file}: ${((await stat(file)).size / 1e6).toFixed(2)} MB`);
}

async function takeShots(page) {
  const names = await page.evaluate(() => window.ruga.preview.poses.map(({ name }) => name));
  const shot = async (name) => page.screenshot({ path: path.join(shots, `${name}.png`) });
  for (const name of names.slice(0, 3)) {
    await pose(page, { [name]: 1 });
    await shot(`skin-${name}`);
  }
  await pose(page, { [names[0]]: 1 });
  for (const [key, name] of [['2', 'clay'], ['3', 'map'], ['4', 'strain']]) {
    await page.keyboard.press(key);
    await shot(name);
  }
  await page.keyboard.press('1');
  await page.keyboard.press('m');
  await shot('edges');
  await page.keyboard.press('m');
  await page.keyboard.press('a');
  await shot('whole');
  await page.keyboard.press('f');
}

try {
  const page = await open();
  await sliderChangesPixels(page);
  if (isPlan) {
    await plan(page);
  } else {
    const { glb } = JSON.parse(await readFile(path.join(baked, 'wrinkles.json'), 'utf8'));
    await tangents(page, await readFile(path.join(baked, glb.file)));
    const pictures = reference ? (await readdir(reference)).filter((name) => name.endsWith('.png')) : [];
    let wrinkled = 0;
    for (const picture of pictures.sort()) {
      const name = picture.slice(0, -4);
      check(await pose(page, parsed(name)), `${name}: all its maps are loaded`);
      const { largest, mean, tilted } = await difference(page, path.join(reference, picture));
      check(largest <= LIMIT, `${name}: largest difference ${largest}/255, mean ${mean.toFixed(3)}, ${tilted} texels tilted`);
      wrinkled += Number(tilted > 0);
    }
    if (pictures.length > 0) check(wrinkled > 0, `${wrinkled} of ${pictures.length} blends wrinkle`);
    await measure(page);
    if (shots) await takeShots(page);
  }
  console.log(`      ${await browser.version()}`);
} finally {
  await browser.close();
}
process.exit(faults === 0 ? 0 : 1);
