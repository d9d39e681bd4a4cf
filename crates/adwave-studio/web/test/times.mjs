/**
 * How long things take on a quiet machine, with a server of its own for each size: `node test/times.mjs ADWAVE FOLDER [VERTICES …]` takes the
 * built-in creature and prints the table of docs/STUDIO.md. Use a release build; every number is a median.
 */

import { spawnSync } from 'node:child_process';
import { mkdirSync, rmSync } from 'node:fs';
import { cpus } from 'node:os';
import { drag, fromDisk, launch, report, serve, stage, untilReady, untilStrokes } from './browser.mjs';

const [adwave, folder, ...sizes] = process.argv.slice(2);
if (!folder) {
  console.error('usage: node test/times.mjs ADWAVE FOLDER [VERTICES …]');
  process.exit(2);
}
/** Times the page is opened, and that a thing is asked of the server. */
const LOADS = 7;
const ASKED = 5;

const failures = [];
const rounded = (x, digits) => Number(x.toFixed(digits));
const median = (list, digits = 1) => {
  const sorted = [...list].sort((a, b) => a - b);
  return sorted.length ? rounded(sorted[sorted.length >> 1], digits) : null;
};

/** Sums the bytes that a page asks the graphics to keep in buffers. */
function countBuffers() {
  const sizes = new WeakMap();
  const bound = new Map();
  window.gpu = { bytes: 0, most: 0 };
  const gl = WebGL2RenderingContext.prototype;
  const { bindBuffer, bufferData, deleteBuffer } = gl;
  const add = (n) => {
    window.gpu.bytes += n;
    window.gpu.most = Math.max(window.gpu.most, window.gpu.bytes);
  };
  gl.bindBuffer = function (target, buffer) {
    bound.set(target, buffer);
    bindBuffer.call(this, target, buffer);
  };
  gl.bufferData = function (target, what, ...rest) {
    const buffer = bound.get(target);
    const size = typeof what === 'number' ? what : what.byteLength;
    add(size - (sizes.get(buffer) ?? 0));
    sizes.set(buffer, size);
    bufferData.call(this, target, what, ...rest);
  };
  gl.deleteBuffer = function (buffer) {
    add(-(sizes.get(buffer) ?? 0));
    sizes.delete(buffer);
    deleteBuffer.call(this, buffer);
  };
}

/** The page then takes the ways of a graphics processor, slowly: for counting bytes. */
function pretendHardware() {
  const { getParameter } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    // UNMASKED_RENDERER_WEBGL
    return name === 0x9246 ? 'a graphics processor' : getParameter.call(this, name);
  };
}

/** A page with nothing in any cache. */
async function fresh(browser, url, ...scripts) {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  page.setDefaultTimeout(60_000);
  page.on('pageerror', (e) => failures.push(`page: ${e.message}`));
  await fromDisk(page);
  for (const script of scripts) await page.addInitScript(script);
  await page.goto(url);
  await untilReady(page);
  return page;
}

const times = (page) => page.evaluate(() => structuredClone(window.studio.timings));
const rest = (page) =>
  page.evaluate(() =>
    window.studio
      .kept()
      .then(() => window.studio.positions())
      .then(() => {}),
  );

/** From the address to the picture and to the last slider. */
async function loading(browser, url) {
  const pixels = [];
  const live = [];
  const first = [];
  for (let k = 0; k < LOADS; k++) {
    const page = await fresh(browser, url);
    const { firstPixels, firstSlider, slidersLive } = await times(page);
    pixels.push(firstPixels);
    first.push(firstSlider - firstPixels);
    live.push(slidersLive - firstPixels);
    await page.close();
  }
  return {
    'first pixels': median(pixels, 0),
    '+ first slider': median(first, 0),
    '+ every slider': median(live, 0),
  };
}

/** Until all triangles are drawn again after the last movement. */
const still = async (page) => {
  await rest(page);
  await page.waitForTimeout(700);
};

/** A slider that a hand drags, what is computed after it is let go, and the step back. */
async function sliding(page, requests) {
  await page.evaluate(() => window.studio.measure(true));
  const sliders = page.locator('.band input.gain');
  const n = await sliders.count();
  const settled = [];
  const undo = [];
  let sent = 0;
  for (let k = 0; k < n; k++) {
    const track = await sliders.nth(k).boundingBox();
    const value = await sliders.nth(k).evaluate((s) => s.valueAsNumber / Number(s.max));
    const [x, y] = [track.x + track.width / 2, track.y + track.height * (1 - value)];
    const before = requests.length;
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 0; i < 24; i++) {
      await page.mouse.move(x, y - 0.012 * track.height * i);
      await page.waitForTimeout(30);
    }
    sent += requests.length - before;
    await page.mouse.up();
    await still(page);
    const { slider, settle } = await times(page);
    settled.push(settle.at(-1));
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('Control+z');
    await still(page);
    undo.push(...(await times(page)).slider.slice(slider.length));
  }
  const { slider } = await times(page);
  const moves = slider.length - undo.length;
  const all = [];
  for (const value of [20, 80, 30, 70, 25, 75]) {
    await page.evaluate((to) => {
      for (const input of document.querySelectorAll('.band input.gain')) {
        input.value = String((Number(input.max) * to) / 100);
        input.dispatchEvent(new Event('input', { bubbles: true }));
      }
      document.querySelector('.band input.gain').dispatchEvent(new Event('change', { bubbles: true }));
    }, value);
    await still(page);
    all.push((await times(page)).settle.at(-1));
  }
  await page.evaluate(() => window.studio.measure(false));
  return {
    'slider to pixels': median(slider),
    'moves and steps back': `${moves}, ${undo.length}`,
    'requests while it moves': sent,
    'exact after release': median(settled),
    'exact after release, all bands': median(all),
    'undo to pixels': median(undo),
  };
}

/** What is under the cursor, and stamps. */
async function brushing(page, requests, n) {
  const { x, y, size } = await stage(page);
  const along = (k) => [x + 0.16 * size * (k / 30 - 0.5), y + 0.12 * size * Math.sin(k / 5)];
  const hover = async () => {
    const had = (await times(page)).pick.length;
    for (let k = 0; k < 40; k++) {
      await page.mouse.move(...along(k));
      await page.waitForTimeout(30);
    }
    return (await times(page)).pick.slice(had);
  };
  const picked = await hover();
  await page.keyboard.press('b');
  const ringed = await hover();
  // One stamp says how much of the shape it covers.
  await page.mouse.click(x, y);
  await untilStrokes(page, 1);
  const covered = await page.evaluate(async () => (await window.studio.mask()).filter((w) => w > 0).length);
  await still(page);
  const had = (await times(page)).stamp.length;
  let sent = 0;
  for (let round = 0; round < 4; round++) {
    const before = requests.length;
    const places = Array.from({ length: 31 }, (_, k) => along(k).map((a) => a + 7 * round));
    await drag(page, places, async () => {
      await page.waitForTimeout(500);
      sent += requests.length - before;
    });
    await untilStrokes(page, 2 + round);
    await still(page);
  }
  const stamps = (await times(page)).stamp.slice(had);
  const bytes = requests
    .filter((r) => r.method() === 'PUT')
    .at(-1)
    ?.postDataBuffer()?.length;
  return {
    pick: median(picked, 2),
    'pick with the circle of the brush': median(ringed, 2),
    stamp: median(stamps, 2),
    'vertices in a stamp, %': rounded((100 * covered) / n, 2),
    stamps: stamps.length,
    'requests while it paints': sent,
    'bytes of the edit after four strokes': bytes,
  };
}

/** What the server computes after an edit. */
async function asking(page) {
  const lists = await page.evaluate(async (asked) => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const at = `api/shapes/${shapes[0].id}/`;
    const timed = async (path) => {
      const started = performance.now();
      const answer = await fetch(at + path, { headers });
      await answer.arrayBuffer();
      if (!answer.ok) throw new Error(`${path}: ${answer.status}`);
      return performance.now() - started;
    };
    const edit = async (gain) => {
      const kept = await (await fetch(`${at}edit`, { headers })).json();
      const [layer] = kept.layers;
      const body = JSON.stringify({
        ...kept,
        revision: kept.revision + 1,
        layers: [{ ...layer, gains: layer.gains.with(2, gain), region: null }],
      });
      const started = performance.now();
      const answer = await fetch(`${at}edit`, { method: 'PUT', headers, body });
      if (!answer.ok) throw new Error(await answer.text());
      await answer.arrayBuffer();
      return performance.now() - started;
    };
    const out = { edit: [], exact: [], ply: [], saliency: [] };
    for (let k = 0; k < asked; k++) {
      out.edit.push(await edit(0.5 + 0.3 * k));
      out.exact.push(await timed('exact'));
      out.ply.push(await timed('download?format=ply'));
      out.saliency.push(await timed('field?name=saliency'));
    }
    return out;
  }, ASKED);
  return {
    'edit in double precision, kept': median(lists.edit, 0),
    'exact positions': median(lists.exact, 0),
    'exact export, PLY': median(lists.ply, 0),
    'saliency after an edit': median(lists.saliency, 0),
  };
}

async function measured(browser, n) {
  const shape = `${folder}/creature-${n}.ply`;
  spawnSync(adwave, ['sample', 'creature', '--vertices', String(n), '--quiet', '-o', shape]);
  const { server, url } = await serve(adwave, shape, `${folder}/${n}`);
  try {
    // The first one waits for the bands, which the server makes once.
    const first = await fresh(browser, url);
    const renderer = await first.evaluate(() => window.studio.renderer);
    const once = (await times(first)).slidersLive;
    await first.close();
    const loads = await loading(browser, url);
    const pretending = await fresh(browser, url, countBuffers, pretendHardware);
    await pretending.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done))));
    const hardware = await pretending.evaluate(() => window.gpu.most);
    await pretending.close();
    const page = await fresh(browser, url, countBuffers);
    const requests = [];
    page.on('request', (r) => requests.push(r));
    const slid = await sliding(page, requests);
    const software = await page.evaluate(() => window.gpu.most);
    const painted = await brushing(page, requests, n);
    const answered = await asking(page);
    await page.close();
    const megabytes = (x) => rounded(x / 1e6, 1);
    return {
      renderer,
      'first visit, every slider': rounded(once, 0),
      ...loads,
      ...slid,
      ...painted,
      ...answered,
      'MB in buffers, software': megabytes(software),
      'MB in buffers, graphics processor': megabytes(hardware),
    };
  } finally {
    server.kill();
  }
}

rmSync(folder, { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
const results = {};
const browser = await launch();
for (const n of sizes.length ? sizes : [50_000, 500_000, 1_000_000]) {
  try {
    results[n] = await measured(browser, n);
  } catch (error) {
    failures.push(`${n}: ${error.message}`);
  }
}
const version = browser.version();
await browser.close();
const { renderer } = Object.values(results)[0] ?? {};
const rows = new Set(Object.values(results).flatMap(Object.keys));
rows.delete('renderer');
console.log(`Chromium ${version}, ${renderer}, ${cpus().length} × ${cpus()[0]?.model}; milliseconds\n`);
console.log(`| | ${Object.keys(results).join(' | ')} |\n|---|${'---|'.repeat(Object.keys(results).length)}`);
for (const row of rows)
  console.log(
    `| ${row} | ${Object.values(results)
      .map((r) => r[row])
      .join(' | ')} |`,
  );
report(failures);
