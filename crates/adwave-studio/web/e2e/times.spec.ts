/**
 * Measurements of docs/STUDIO.md, as medians, each size with its own server. Use a quiet machine and a release build:
 *
 * `ADWAVE=…/target/release/adwave npx playwright test --project=times`
 */

import { execFileSync } from 'node:child_process';
import { mkdirSync } from 'node:fs';
import { cpus } from 'node:os';
import { join } from 'node:path';
import { type Browser, expect, type Page, type Request, test } from '@playwright/test';
import type { Edit } from '../src/protocol';
import {
  collectErrors,
  drag,
  expectNoFailures,
  openStudio,
  type Point,
  pictureFrame,
  startPainting,
  useTestBuild,
  waitForBands,
  waitForStrokes,
  waitUntilReady,
} from './support/page';
import { ADWAVE, creature, killStudio, OUT, startStudio } from './support/studio-server';

declare global {
  interface Window {
    /** Bytes in WebGL buffers, now and at most. */
    gpu: { bytes: number; most: number };
  }
}

const SIZES = (process.env['STUDIO_SIZES'] ?? '50000,500000,1000000').split(',').map(Number);
const N_LOADS = 7;
const N_REQUESTS = 5;

type Row = Record<string, number | string | null | undefined>;

const rounded = (x: number, digits: number) => Number(x.toFixed(digits));

function median(list: readonly number[], digits = 1): number | null {
  const sorted = [...list].sort((a, b) => a - b);
  return sorted.length ? rounded(sorted[sorted.length >> 1]!, digits) : null;
}

/** Init script: counts the bytes of WebGL buffers. */
function countBuffers(): void {
  const sizes = new WeakMap<WebGLBuffer, number>();
  const bound = new Map<number, WebGLBuffer | null>();
  window.gpu = { bytes: 0, most: 0 };
  const gl = WebGL2RenderingContext.prototype;
  const { bindBuffer, bufferData, deleteBuffer } = gl;
  const add = (n: number) => {
    window.gpu.bytes += n;
    window.gpu.most = Math.max(window.gpu.most, window.gpu.bytes);
  };
  gl.bindBuffer = function (target, buffer) {
    bound.set(target, buffer);
    bindBuffer.call(this, target, buffer);
  };
  gl.bufferData = function (this: WebGL2RenderingContext, target: number, ...args: unknown[]) {
    const buffer = bound.get(target)!;
    const [content] = args as [number | ArrayBufferView];
    const size = typeof content === 'number' ? content : content.byteLength;
    add(size - (sizes.get(buffer) ?? 0));
    sizes.set(buffer, size);
    (bufferData as (...all: unknown[]) => void).call(this, target, ...args);
  } as typeof gl.bufferData;
  gl.deleteBuffer = function (buffer) {
    if (buffer) {
      add(-(sizes.get(buffer) ?? 0));
      sizes.delete(buffer);
    }
    deleteBuffer.call(this, buffer);
  };
}

/** Init script: the page takes the code paths of a GPU, slowly, so that its buffers can be counted. */
function pretendHardware(): void {
  const UNMASKED_RENDERER_WEBGL = 0x9246;
  const { getParameter } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    return name === UNMASKED_RENDERER_WEBGL ? 'a GPU' : getParameter.call(this, name);
  };
}

interface Target {
  browser: Browser;
  url: string;
  failures: string[];
}

/** Opens a page with empty caches. */
async function openFresh({ browser, url, failures }: Target, scripts: (() => void)[] = []): Promise<Page> {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  page.setDefaultTimeout(60_000);
  collectErrors(page, failures);
  await useTestBuild(page);
  for (const script of scripts) await page.addInitScript(script);
  await page.goto(url);
  await waitUntilReady(page);
  return page;
}

const timings = (page: Page) => page.evaluate(() => structuredClone(window.studio.timings));

/** Waits until all triangles are drawn again after the last movement. */
async function waitUntilStill(page: Page): Promise<void> {
  await page.evaluate(async () => {
    await window.studio.saved();
    await window.studio.positions();
  });
  await page.waitForTimeout(700);
}

/** From navigation to the picture and to the last slider. */
async function measureLoading(target: Target): Promise<Row> {
  const pixels: number[] = [];
  const first: number[] = [];
  const live: number[] = [];
  for (let k = 0; k < N_LOADS; k++) {
    const page = await openFresh(target);
    const { firstPixels, firstSlider, slidersLive } = await timings(page);
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

/** Dragged sliders, the computation after release, and undo. */
async function measureSliders(page: Page, requests: Request[]): Promise<Row> {
  await page.evaluate(() => window.studio.measure(true));
  const sliders = page.locator('.band input.gain');
  const n = await sliders.count();
  const settled: (number | undefined)[] = [];
  const undo: number[] = [];
  let nSent = 0;
  for (let k = 0; k < n; k++) {
    const track = (await sliders.nth(k).boundingBox())!;
    const value = await sliders.nth(k).evaluate((s: HTMLInputElement) => s.valueAsNumber / Number(s.max));
    const [x, y] = [track.x + track.width / 2, track.y + track.height * (1 - value)];
    const before = requests.length;
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let i = 0; i < 24; i++) {
      await page.mouse.move(x, y - 0.012 * track.height * i);
      await page.waitForTimeout(30);
    }
    nSent += requests.length - before;
    await page.mouse.up();
    await waitUntilStill(page);
    const { slider, settle } = await timings(page);
    settled.push(settle.at(-1));
    await page.evaluate(() => (document.activeElement as HTMLElement).blur());
    await page.keyboard.press('Control+z');
    await waitUntilStill(page);
    undo.push(...(await timings(page)).slider.slice(slider.length));
  }
  const { slider } = await timings(page);
  const all: (number | undefined)[] = [];
  for (const position of [20, 80, 30, 70, 25, 75]) {
    await page.evaluate((to) => {
      const inputs = document.querySelectorAll<HTMLInputElement>('.band input.gain');
      for (const input of inputs) {
        input.value = String((Number(input.max) * to) / 100);
        input.dispatchEvent(new Event('input', { bubbles: true }));
      }
      inputs[0]!.dispatchEvent(new Event('change', { bubbles: true }));
    }, position);
    await waitUntilStill(page);
    all.push((await timings(page)).settle.at(-1));
  }
  await page.evaluate(() => window.studio.measure(false));
  const defined = (list: (number | undefined)[]) => list.filter((x) => x !== undefined);
  return {
    'slider to pixels': median(slider),
    'movements and undo steps': `${slider.length - undo.length}, ${undo.length}`,
    'requests during motion': nSent,
    'exact after release': median(defined(settled)),
    'exact after release, all bands': median(defined(all)),
    'undo to pixels': median(undo),
  };
}

/** Picking under the cursor, and stamps of the brush. */
async function measureBrush(page: Page, requests: Request[], nVertices: number): Promise<Row> {
  const { x, y, size } = await pictureFrame(page);
  const along = (k: number): Point => [x + 0.16 * size * (k / 30 - 0.5), y + 0.12 * size * Math.sin(k / 5)];
  const hover = async () => {
    const n = (await timings(page)).pick.length;
    for (let k = 0; k < 40; k++) {
      await page.mouse.move(...along(k));
      await page.waitForTimeout(30);
    }
    return (await timings(page)).pick.slice(n);
  };
  const picks = await hover();
  await startPainting(page);
  const picksWithCircle = await hover();
  // A single stamp tells how much of the shape it covers.
  await page.mouse.click(x, y);
  await waitForStrokes(page, 1);
  const nCovered = await page.evaluate(async () => (await window.studio.mask()).filter((w) => w > 0).length);
  await waitUntilStill(page);
  const nStamps = (await timings(page)).stamp.length;
  let nSent = 0;
  for (let round = 0; round < 4; round++) {
    const before = requests.length;
    const points = Array.from({ length: 31 }, (_, k) => along(k).map((a) => a + 7 * round) as Point);
    await drag(page, points, async () => {
      await page.waitForTimeout(500);
      nSent += requests.length - before;
    });
    await waitForStrokes(page, 2 + round);
    await waitUntilStill(page);
  }
  const stamps = (await timings(page)).stamp.slice(nStamps);
  const lastEdit = requests.filter((r) => r.method() === 'PUT').at(-1);
  return {
    pick: median(picks, 2),
    'pick with the circle of the brush': median(picksWithCircle, 2),
    stamp: median(stamps, 2),
    'vertices in a stamp, %': rounded((100 * nCovered) / nVertices, 2),
    stamps: stamps.length,
    'requests while painting': nSent,
    'bytes of the edit after four strokes': lastEdit?.postDataBuffer()?.length,
  };
}

/** A pulled handle: from its motion to the picture of the bent shape, and until it rests. */
async function measurePull(page: Page): Promise<Row> {
  const { x, y, size } = await pictureFrame(page);
  await page.keyboard.press('p');
  const started = Date.now();
  await page.mouse.move(x, y);
  await page.mouse.down();
  const nHandles = () => page.evaluate(() => window.studio.state().pose?.handle.length ?? 0);
  await page.mouse.move(x + 5, y);
  await expect.poll(nHandles, { timeout: 60_000 }).toBe(1);
  const bound = Date.now() - started;
  await page.evaluate(() => window.studio.measure(true));
  for (let k = 1; k <= 40; k++) {
    await page.mouse.move(x + 0.004 * size * k, y - 0.005 * size * k);
    await page.waitForTimeout(60);
  }
  await page.evaluate(() => window.studio.measure(false));
  const released = Date.now();
  await page.mouse.up();
  await page.evaluate(async () => {
    await window.studio.saved();
    await window.studio.positions();
  });
  const rested = Date.now() - released;
  const { pull } = await timings(page);
  await page.keyboard.press('Control+z');
  await waitUntilStill(page);
  return {
    'first pull, with binding': rounded(bound, 0),
    'handle to pixels': median(pull, 0),
    'updates of 40 motions': pull.length,
    'at rest after release': rounded(rested, 0),
  };
}

/** Computations of the server after an edit. */
async function measureServer(page: Page): Promise<Row> {
  const lists = await page.evaluate(async (nRequests) => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const root = `api/shapes/${shapes[0].id}/`;
    const time = async (path: string) => {
      const started = performance.now();
      const response = await fetch(root + path, { headers });
      await response.arrayBuffer();
      if (!response.ok) throw new Error(`${path}: ${response.status}`);
      return performance.now() - started;
    };
    const timeEdit = async (gain: number) => {
      const stored: Edit = await (await fetch(`${root}edit`, { headers })).json();
      const [layer] = stored.layers;
      const body = JSON.stringify({
        ...stored,
        revision: stored.revision + 1,
        layers: [{ ...layer, gains: layer!.gains.with(2, gain), region: null }],
      });
      const started = performance.now();
      const response = await fetch(`${root}edit`, { method: 'PUT', headers, body });
      if (!response.ok) throw new Error(await response.text());
      await response.arrayBuffer();
      return performance.now() - started;
    };
    const out = {
      edit: [] as number[],
      exact: [] as number[],
      ply: [] as number[],
      saliency: [] as number[],
    };
    for (let k = 0; k < nRequests; k++) {
      out.edit.push(await timeEdit(0.5 + 0.3 * k));
      out.exact.push(await time('exact'));
      out.ply.push(await time('download?format=ply'));
      out.saliency.push(await time('field?name=saliency'));
    }
    return out;
  }, N_REQUESTS);
  return {
    'edit in double precision, stored': median(lists.edit, 0),
    'exact positions': median(lists.exact, 0),
    'exact export, PLY': median(lists.ply, 0),
    'saliency after an edit': median(lists.saliency, 0),
  };
}

async function measureSize(browser: Browser, nVertices: number, failures: string[]): Promise<Row> {
  const server = await startStudio(creature(nVertices), `${OUT}/times-${nVertices}-${Date.now()}`);
  const target = { browser, url: server.url, failures };
  try {
    // The first visit waits for the bands, which the server computes once.
    const first = await openFresh(target);
    const renderer = await first.evaluate(() => window.studio.renderer);
    const firstVisit = await timings(first);
    await first.close();
    const loading = await measureLoading(target);
    const pretending = await openFresh(target, [countBuffers, pretendHardware]);
    await pretending.evaluate(
      () => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve))),
    );
    const hardware = await pretending.evaluate(() => window.gpu.most);
    await pretending.close();
    const page = await openFresh(target, [countBuffers]);
    const requests: Request[] = [];
    page.on('request', (r) => requests.push(r));
    const sliders = await measureSliders(page, requests);
    const software = await page.evaluate(() => window.gpu.most);
    const brush = await measureBrush(page, requests, nVertices);
    const pulls = await measurePull(page);
    const answers = await measureServer(page);
    await page.close();
    return {
      renderer,
      'first visit, first pixels': rounded(firstVisit.firstPixels, 0),
      'first visit, every slider': rounded(firstVisit.slidersLive, 0),
      ...loading,
      ...sliders,
      ...brush,
      ...pulls,
      ...answers,
      'MB in buffers, software': rounded(software / 1e6, 1),
      'MB in buffers, GPU': rounded(hardware / 1e6, 1),
    };
  } finally {
    await killStudio(server);
  }
}

test('measurements', async ({ browser }) => {
  const failures: string[] = [];
  const columns: [number, Row][] = [];
  for (const nVertices of SIZES) columns.push([nVertices, await measureSize(browser, nVertices, failures)]);
  const [, first] = columns[0]!;
  console.log(
    `Chromium ${browser.version()}, ${first['renderer']}, ${cpus().length} × ${cpus()[0]?.model}; milliseconds\n`,
  );
  console.log(`| | ${columns.map(([n]) => n).join(' | ')} |\n|---|${'---|'.repeat(columns.length)}`);
  for (const name of Object.keys(first).filter((key) => key !== 'renderer'))
    console.log(`| ${name} | ${columns.map(([, column]) => column[name]).join(' | ')} |`);
  expectNoFailures(failures);
});

/** Longest time from a slider to the pixels of an image of 512² and of the slices of a volume of 256³, in milliseconds. */
const SLIDER_OF_GRID = 50;

/** Milliseconds from a movement of a slider to the pixels of an image or a volume: median of 40. */
async function measureGrid(browser: Browser, name: string, arguments_: string[]): Promise<number> {
  mkdirSync(OUT, { recursive: true });
  const path = join(OUT, name);
  execFileSync(ADWAVE, ['sample', ...arguments_, '--quiet', '-o', path]);
  const studio = await openStudio(browser, 'grid-times', path);
  const { page } = studio;
  await waitForBands(page, 3);
  await page.evaluate(() => window.studio.measure(true));
  for (let k = 0; k < 40; k++) {
    await page.evaluate(async (k) => {
      const input = document.querySelectorAll<HTMLInputElement>('.band input.gain')[2]!;
      input.value = String(20 + 4 * k);
      input.dispatchEvent(new Event('input', { bubbles: true }));
      await window.studio.planes();
    }, k);
  }
  const { slider } = await timings(page);
  expect(slider.length).toBeGreaterThan(30);
  await studio.end();
  return slider.sort((a, b) => a - b)[slider.length >> 1]!;
}

test('a slider of an image or a volume reaches the pixels soon', async ({ browser }) => {
  const image = await measureGrid(browser, 'hills-512.tif', ['hills', '--vertices', `${512 ** 2}`]);
  const volume = await measureGrid(browser, 'head-256.nii', ['head', '--vertices', `${256 ** 3}`]);
  console.log(
    `slider to pixels: image of 512² ${rounded(image, 1)} ms, volume of 256³ ${rounded(volume, 1)} ms`,
  );
  expect(image).toBeLessThan(SLIDER_OF_GRID);
  expect(volume).toBeLessThan(SLIDER_OF_GRID);
});
