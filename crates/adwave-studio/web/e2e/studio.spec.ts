/**
 * A tour of the studio: sliders, undo, brush, views, dark mode and a reload, with screenshots of each state. It runs on the
 * real server and on the mock server, and relies on PROTOCOL.md only.
 */

import { mkdirSync } from 'node:fs';
import { writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { type Browser, expect, type Page, test } from '@playwright/test';
import type { Edit } from '../src/protocol';
import { startMockServer } from './support/mock-server';
import {
  collectErrors,
  currentEdit,
  expectNoFailures,
  startPainting,
  useTestBuild,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { type Box, decodePng, deviation } from './support/png';
import { creature, killStudio, OUT, startStudio, TEST_BUILD } from './support/studio-server';

declare global {
  interface Window {
    /** Positions that were stored by `store`. */
    stored: Record<string, Float32Array>;
  }
}

/** Smallest standard deviation of a picture that is not blank. */
const MIN_DEVIATION = 5;
/** Positions of equal documents are equal to the bit. */
const EQUAL = 0;

interface SentRequest {
  method: string;
  path: string;
  nBytes: number;
}

interface Tour {
  page: Page;
  url: string;
  folder: string;
  failures: string[];
  requests: SentRequest[];
}

/** Edit without its revision, which the page and the server count separately. */
function withoutRevision({ revision: _, ...rest }: Edit): Omit<Edit, 'revision'> {
  return rest;
}

async function startTour(browser: Browser, url: string, folder: string): Promise<Tour> {
  mkdirSync(folder, { recursive: true });
  const failures: string[] = [];
  const requests: SentRequest[] = [];
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 }, colorScheme: 'light' });
  await useTestBuild(page);
  page.setDefaultTimeout(60_000);
  page.on('console', (m) => {
    if (m.type() === 'error' || /content security policy/i.test(m.text()))
      failures.push(`console: ${m.text()}`);
  });
  collectErrors(page, failures);
  const { origin } = new URL(url);
  page.on('request', (r) => {
    const { pathname, origin: target } = new URL(r.url());
    requests.push({ method: r.method(), path: pathname, nBytes: r.postDataBuffer()?.length ?? 0 });
    if (target !== origin && !/^(blob|data):/.test(r.url())) failures.push(`a request to ${r.url()}`);
  });
  await page.goto(url);
  await waitUntilReady(page);
  return { page, url, folder, failures, requests };
}

/** Takes a screenshot and asserts that the stage, or `box`, is not blank. */
async function takePicture({ page, folder }: Tour, name: string, box?: Box): Promise<void> {
  await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 250)));
  const bytes = await page.screenshot({ path: join(folder, `${name}.png`) });
  const area = box ?? (await page.locator('main.stage').boundingBox())!;
  expect.soft(deviation(decodePng(bytes), area), `picture ${name}`).toBeGreaterThan(MIN_DEVIATION);
}

/** Stores the displayed positions in the page under a name. */
const store = (page: Page, name: string) =>
  page.evaluate(async (n) => {
    window.stored ??= {};
    window.stored[n] = await window.studio.positions();
  }, name);

/** Largest absolute difference of the coordinates of two stored positions. */
const difference = (page: Page, a: string, b: string) =>
  page.evaluate(
    ([p, q]) => {
      const other = window.stored[q]!;
      return window.stored[p]!.reduce((most, x, i) => Math.max(most, Math.abs(x - other[i]!)), 0);
    },
    [a, b] as const,
  );

const timings = (page: Page) => page.evaluate(() => structuredClone(window.studio.timings));

const clearTimings = (page: Page) =>
  page.evaluate(() => {
    for (const list of Object.values(window.studio.timings)) if (Array.isArray(list)) list.length = 0;
  });

/** Moves a slider like a hand does: many values in one gesture, one undo step, no request during motion. */
async function dragSlider(tour: Tour): Promise<{ slider: number[]; settle: number | undefined }> {
  const { page, requests } = tour;
  const sliders = page.locator('.band input.gain');
  expect(await sliders.count(), 'there are sliders').toBeGreaterThan(0);
  await clearTimings(page);
  const before = requests.length;
  const track = (await sliders.nth(1).boundingBox())!;
  const [x, y] = [track.x + track.width / 2, track.y + track.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 0; i <= 20; i++) {
    await page.mouse.move(x, y - (0.4 * track.height * i) / 20);
    await page.waitForTimeout(16);
  }
  expect.soft(requests.length - before, 'requests while a slider moves').toBe(0);
  const { slider } = await timings(page);
  await page.mouse.up();
  await waitUntilSaved(page);
  await store(page, 'slid');
  expect.soft(await difference(page, 'opened', 'slid'), 'the slider moves the shape').toBeGreaterThan(0);
  const settle = (await timings(page)).settle.at(-1);
  await takePicture(tour, '2-slider');
  return { slider, settle };
}

/** Keys move a focused slider; undo restores the original to the bit, redo the edit. */
async function useKeysAndUndo({ page }: Tour): Promise<void> {
  await page.locator('.band input.gain').nth(0).focus();
  await page.keyboard.press('ArrowDown');
  await page.keyboard.press('PageDown');
  expect.soft((await currentEdit(page)).layers[0]!.gains[0], 'keys move a slider').toBeLessThan(1);
  await page.evaluate(() => window.studio.positions().then(() => {}));
  await page.evaluate(() => (document.activeElement as HTMLElement).blur());
  for (let i = 0; i < 3; i++) await page.keyboard.press('Control+z');
  await store(page, 'undone');
  expect.soft(await difference(page, 'opened', 'undone'), 'undo').toBeLessThanOrEqual(EQUAL);
  for (let i = 0; i < 3; i++) await page.keyboard.press('Control+Shift+z');
  await store(page, 'redone');
  expect.soft(await difference(page, 'opened', 'redone'), 'redo').toBeGreaterThan(0);
  await waitUntilSaved(page);
}

/** A stroke over the middle of the shape creates a layer, whose sliders act there alone. */
async function paintStroke(tour: Tour): Promise<{ pick: number[]; stamp: number[] }> {
  const { page, requests } = tour;
  await clearTimings(page);
  await startPainting(page);
  const box = (await page.locator('canvas.picture').boundingBox())!;
  const [cx, cy] = [box.x + box.width / 2, box.y + box.height / 2];
  const nLayers = (await currentEdit(page)).layers.length;
  const before = requests.length;
  await page.mouse.move(cx - 60, cy);
  await page.waitForTimeout(300);
  await page.mouse.down();
  for (let i = 0; i <= 24; i++) {
    await page.mouse.move(cx - 60 + 5 * i, cy + 20 * Math.sin(i / 4));
    await page.waitForTimeout(16);
  }
  expect.soft(requests.length - before, 'requests while the brush paints').toBe(0);
  await page.mouse.up();
  // The stroke ends in the worker, which takes a moment for a large one.
  await page.evaluate(async () => {
    const nStrokes = () => {
      const region = window.studio.state().layers.at(-1)!.region;
      return region && 'painted' in region ? region.painted.length : 0;
    };
    for (let i = 0; i < 200 && nStrokes() === 0; i++) await new Promise((resolve) => setTimeout(resolve, 50));
  });
  await waitUntilSaved(page);
  const { layers } = await currentEdit(page);
  expect.soft(layers.length, 'a stroke creates a layer').toBe(nLayers + 1);
  const region = layers.at(-1)!.region!;
  const stroke = 'painted' in region ? region.painted[0] : undefined;
  const stamps = stroke && 'add' in stroke && 'vertices' in stroke.add ? stroke.add.vertices.indices : [];
  expect.soft(stamps.length, 'with its stamped vertices').toBeGreaterThan(3);
  const { pick, stamp } = await timings(page);
  await takePicture(tour, '3-brush');
  await page.evaluate(async () => {
    for (const j of [0, 1, 2]) {
      const input = document.querySelectorAll<HTMLInputElement>('.band input.gain')[j];
      if (!input) continue;
      input.value = '0';
      input.dispatchEvent(new Event('input', { bubbles: true }));
      input.dispatchEvent(new Event('change', { bubbles: true }));
    }
    await window.studio.saved();
  });
  await store(page, 'smoothed');
  const movedPart = await page.evaluate(() => {
    const [a, b] = [window.stored['redone']!, window.stored['smoothed']!];
    let nMoved = 0;
    for (let i = 0; i < a.length; i += 3)
      if (a[i] !== b[i] || a[i + 1] !== b[i + 1] || a[i + 2] !== b[i + 2]) nMoved++;
    return nMoved / (a.length / 3);
  });
  expect.soft(movedPart, 'the layer acts where it was painted').toBeGreaterThan(0);
  expect.soft(movedPart, 'and only there').toBeLessThan(0.5);
  await page.keyboard.press('Escape');
  await takePicture(tour, '4-smoothed');
  return { pick, stamp };
}

/** Compares edit and positions of the page with those of the server; returns the largest difference per diagonal. */
async function compareWithServer({ page }: Tour): Promise<number> {
  const exact = await page.evaluate(async () => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const path = `api/shapes/${shapes[0].id}`;
    const shape = await (await fetch(path, { headers })).json();
    const stored: Edit = await (await fetch(`${path}/edit`, { headers })).json();
    const expected = new Float32Array(await (await fetch(`${path}/exact`, { headers })).arrayBuffer());
    const shown = await window.studio.positions();
    let most = 0;
    for (let i = 0; i < shown.length; i++) most = Math.max(most, Math.abs(shown[i]! - expected[i]!));
    return { stored, part: most / shape.diagonal };
  });
  const edit = withoutRevision(await currentEdit(page));
  expect.soft(withoutRevision(exact.stored), 'the stored edit is that of the page').toEqual(edit);
  return exact.part;
}

/** Takes pictures of all views: wipe, before, colors, features, shading styles, shortcuts, dark. */
async function visitViews(tour: Tour): Promise<void> {
  const { page, folder } = tour;
  await page.keyboard.press('s');
  await takePicture(tour, '5-split');
  await page.keyboard.press('s');
  await page.keyboard.down('\\');
  await page.waitForTimeout(200);
  await page.screenshot({ path: join(folder, '6-before.png') });
  await page.keyboard.up('\\');
  await page.keyboard.press('c');
  await page.waitForTimeout(500);
  await takePicture(tour, '7-displacement');
  await page.keyboard.press('c');
  await page.locator('.side-tabs [data-tab=look]').click();
  const colors = page.locator('#look select').first();
  const names = await colors
    .locator('option')
    .evaluateAll((options) => options.map((option) => (option as HTMLOptionElement).value));
  const field = names.length > 2 && names.find((name) => name.startsWith('field-'));
  if (field) {
    await colors.selectOption(field);
    await page.waitForTimeout(1000);
    await takePicture(tour, '8-field');
    await colors.selectOption('none');
  }
  await page.locator('.side-tabs [data-tab=look]').click();
  await page.getByLabel('Features', { exact: true }).check();
  await page.waitForTimeout(1500);
  await takePicture(tour, '9-features');
  await page.getByLabel('Features', { exact: true }).uncheck();
  for (const name of ['matcap', 'flat', 'edges', 'shaded']) {
    await page.keyboard.press('m');
    await page.waitForTimeout(300);
    await takePicture(tour, `10-${name}`);
  }
  await page.keyboard.press('?');
  await takePicture(tour, '11-keys', (await page.locator('dialog').boundingBox())!);
  await page.keyboard.press('Escape');
  await page.getByRole('button', { name: 'Light or dark' }).click();
  await takePicture(tour, '12-dark');
}

/** Durations of frames while the shape is rotated, in milliseconds. */
const orbit = (page: Page) =>
  page.evaluate(async () => {
    const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
    const r = canvas.getBoundingClientRect();
    const send = (type: string, x: number, y: number) =>
      canvas.dispatchEvent(
        new PointerEvent(type, { pointerId: 1, button: 0, clientX: x, clientY: y, bubbles: true }),
      );
    canvas.setPointerCapture = () => {};
    const [x, y] = [r.left + r.width / 2, r.top + r.height / 2];
    send('pointerdown', x, y);
    const frames: number[] = [];
    for (let i = 0; i < 12; i++) {
      const began = performance.now();
      send('pointermove', x + 3 * i, y);
      await new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve)));
      frames.push(performance.now() - began);
    }
    send('pointerup', x + 36, y);
    return frames;
  });

/** Loses and restores the WebGL context. */
async function loseContext(tour: Tour): Promise<void> {
  await tour.page.evaluate(async () => {
    const gl = document.querySelector<HTMLCanvasElement>('canvas.picture')!.getContext('webgl2')!;
    const extension = gl.getExtension('WEBGL_lose_context')!;
    extension.loseContext();
    await new Promise((resolve) => setTimeout(resolve, 300));
    extension.restoreContext();
    await new Promise((resolve) => setTimeout(resolve, 800));
  });
  await takePicture(tour, '13-restored');
}

/** Visits all tabs on a narrow touch screen, light and dark. */
async function visitNarrow(browser: Browser, { url, folder, failures }: Tour): Promise<void> {
  for (const colorScheme of ['light', 'dark'] as const) {
    const viewport = { width: 390, height: 844 };
    const context = await browser.newContext({ viewport, hasTouch: true, isMobile: true, colorScheme });
    await useTestBuild(context);
    const phone = await context.newPage();
    collectErrors(phone, failures);
    await phone.goto(url);
    await waitUntilReady(phone);
    await phone.waitForTimeout(400);
    for (const tab of ['equalizer', 'layers', 'brush', 'look']) {
      await phone.locator(`.sheet-tabs [data-tab=${tab}]`).tap();
      await phone.waitForTimeout(150);
      await phone.screenshot({ path: join(folder, `14-narrow-${colorScheme}-${tab}.png`) });
    }
    const scrollWidth = await phone.evaluate(() => document.documentElement.scrollWidth);
    expect.soft(scrollWidth, 'nothing is wider than a narrow window').toBeLessThanOrEqual(390);
    await context.close();
  }
}

function median(list: readonly number[]): number | null {
  const sorted = [...list].sort((a, b) => a - b);
  return sorted.length ? Number(sorted[sorted.length >> 1]!.toFixed(2)) : null;
}

async function runTour(browser: Browser, url: string, folder: string): Promise<void> {
  const tour = await startTour(browser, url, folder);
  const { page, requests, failures } = tour;
  const renderer = await page.evaluate(() => window.studio.renderer);
  expect.soft(renderer, 'the renderer is known').not.toBe('');
  expect.soft(renderer, 'the renderer is not SwiftShader').not.toMatch(/swiftshader/i);
  const loading = await timings(page);
  await page.evaluate(() => window.studio.measure(true));
  await takePicture(tour, '1-opened');
  await store(page, 'opened');

  const { slider, settle } = await dragSlider(tour);
  await useKeysAndUndo(tour);
  const { pick, stamp } = await paintStroke(tour);
  const part = await compareWithServer(tour);
  const edit = withoutRevision(await currentEdit(page));
  await visitViews(tour);
  const frames = await orbit(page);
  await loseContext(tour);

  await page.reload();
  await waitUntilReady(page);
  expect.soft(withoutRevision(await currentEdit(page)), 'a reload restores the edit').toEqual(edit);
  await visitNarrow(browser, tour);

  const summary = {
    renderer,
    'first pixels ms': loading.firstPixels,
    'first slider live ms': loading.firstSlider,
    'all sliders live ms': loading.slidersLive,
    'slider to pixels ms': median(slider),
    'exact after release, computing ms': settle,
    'pick ms': median(pick),
    'stamp ms': median(stamp),
    'orbit frame ms': median(frames),
    'page against exact, part of the diagonal': part,
    'bytes sent for the stroke': requests.filter((r) => r.method === 'PUT').at(1)?.nBytes ?? null,
  };
  await writeFile(join(folder, 'times.json'), `${JSON.stringify(summary, null, 2)}\n`);
  await page.close();
  expectNoFailures(failures);
}

test('tour on the real server', async ({ browser }) => {
  const server = await startStudio(creature(20_000), `${OUT}/studio-${Date.now()}`);
  try {
    await runTour(browser, server.url, join(OUT, 'studio'));
  } finally {
    await killStudio(server);
  }
});

test('tour on the mock server', async ({ browser }) => {
  const { url, server } = await startMockServer({ nVertices: 20_000, dist: TEST_BUILD });
  try {
    await runTour(browser, url, join(OUT, 'mock'));
  } finally {
    server.closeAllConnections();
    server.close();
  }
});
