/** Grab and pin: the shape bends live, sliders stay live, and nothing is lost: on surfaces, sheets, parts and clouds. */

import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  clickUndo,
  currentEdit,
  drag,
  expectNoFailures,
  type OpenStudio,
  openStudio,
  type Point,
  pictureFrame,
  setSlider,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { OUT } from './support/studio-server';

const pose = async (page: Page) => (await currentEdit(page)).pose ?? { handle: [] };
const nHandles = async (page: Page) => (await pose(page)).handle.length;

/** Displayed positions. */
const positions = (page: Page) => page.evaluate(async () => Array.from(await window.studio.positions()));

/** Largest distance of a vertex between two lists of positions. */
function largestMove(a: readonly number[], b: readonly number[]): number {
  let most = 0;
  for (let i = 0; i < a.length; i += 3) {
    most = Math.max(most, Math.hypot(a[i]! - b[i]!, a[i + 1]! - b[i + 1]!, a[i + 2]! - b[i + 2]!));
  }
  return most;
}

/** Positions of the stored edit, from the server. */
const storedPositions = (page: Page): Promise<number[]> =>
  page.evaluate(async () => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const id = sessionStorage.getItem('adwave-shape') ?? shapes[0].id;
    const response = await fetch(`api/shapes/${id}/exact`, { headers });
    return Array.from(new Float32Array(await response.arrayBuffer()));
  });

/** Turns the tool on. */
async function startGrabbing(page: Page): Promise<void> {
  const pullMode = page.getByRole('button', { name: 'Pull', exact: true });
  if (!(await pullMode.isVisible())) await page.keyboard.press('p');
  await pullMode.click();
}

/** Pulls the surface from a place of the picture by some pixels, step by step. */
async function pull(page: Page, from: Point, by: Point, beforeRelease = async () => {}): Promise<void> {
  const path: Point[] = Array.from({ length: 7 }, (_, k) => [
    from[0] + (by[0] * k) / 6,
    from[1] + (by[1] * k) / 6,
  ]);
  const before = await nHandles(page);
  await drag(page, path, async () => {
    await expect.poll(() => nHandles(page), { timeout: 60_000 }).toBeGreaterThan(before);
    await page.mouse.move(from[0] + by[0] + 1, from[1] + by[1]);
    await page.waitForTimeout(100);
    await beforeRelease();
  });
}

test.describe('a surface', () => {
  let studio: OpenStudio;
  let page: Page;

  test.beforeAll(async ({ browser }) => {
    studio = await openStudio(browser, 'grab');
    ({ page } = studio);
  });

  test.afterEach(() => expectNoFailures(studio.failures));

  test.afterAll(() => studio.end());

  test('bends while a handle is pulled, and the far end stays', async () => {
    const rest = await positions(page);
    await startGrabbing(page);
    const { x, y, size } = await pictureFrame(page);
    let during: number[] = [];
    await pull(page, [x, y], [0.1 * size, -0.15 * size], async () => {
      during = await positions(page);
    });
    expect(largestMove(rest, during)).toBeGreaterThan(0.05);
    expect(await nHandles(page)).toBe(1);
    await waitUntilSaved(page);
    const bent = await positions(page);
    // The handle is where it was pulled to, and pinned vertices are where they were.
    const { handle, fixed } = await pose(page);
    const vertexOf = (region: object) => (region as { vertices: { indices: number[] } }).vertices.indices[0]!;
    const at = (list: number[], v: number) => list.slice(3 * v, 3 * v + 3);
    const v = vertexOf(handle[0]!.region);
    for (const [c, value] of at(bent, v).entries()) {
      expect(value - at(rest, v)[c]!).toBeCloseTo(handle[0]!.by[c]!, 4);
    }
    const pin = vertexOf((fixed as { any: object[] }).any[0]!);
    expect(at(bent, pin)).toEqual(at(rest, pin));
    // The page shows what the server stores.
    expect(largestMove(bent, await storedPositions(page))).toBeLessThan(1e-4);
  });

  test('keeps its sliders live, and the bend survives other bands and a reload', async () => {
    const bent = await positions(page);
    await setSlider(page, 0, 0);
    await setSlider(page, 1, 0);
    await waitUntilSaved(page);
    const smooth = await positions(page);
    expect(largestMove(bent, smooth)).toBeGreaterThan(1e-4);
    expect(largestMove(smooth, await storedPositions(page))).toBeLessThan(1e-4);
    await page.reload();
    await waitUntilReady(page);
    expect(largestMove(smooth, await positions(page))).toBeLessThan(1e-5);
    expect(await nHandles(page)).toBe(1);
    for (let k = 0; k < 2; k++) await clickUndo(page);
    await waitUntilSaved(page);
    expect(largestMove(bent, await positions(page))).toBeLessThan(1e-5);
    await clickUndo(page);
    await waitUntilSaved(page);
    expect(await nHandles(page)).toBe(0);
    await page.getByRole('button', { name: /^Redo/ }).click();
    await waitUntilSaved(page);
    expect(largestMove(bent, await positions(page))).toBeLessThan(1e-5);
  });

  test('a click pins, pins are painted and released, and the shape is straightened', async () => {
    await startGrabbing(page);
    // The surface is in the middle of the picture again.
    await page.getByRole('button', { name: 'Straighten' }).click();
    await waitUntilSaved(page);
    const { x, y, size } = await pictureFrame(page);
    const pins = async () => {
      const { fixed } = await pose(page);
      return fixed && 'any' in fixed ? fixed.any : [];
    };
    const before = (await pins()).length;
    const spot: Point = [x + 0.03 * size, y + 0.03 * size];
    await page.mouse.click(...spot);
    await expect.poll(async () => (await pins()).length).toBe(before + 1);
    await page.getByRole('button', { name: 'Unpin', exact: true }).click();
    await page.mouse.click(...spot);
    await expect.poll(async () => (await pins()).length).toBe(before);
    await page.getByRole('button', { name: 'Pin', exact: true }).click();
    await drag(page, [spot, [spot[0] + 15, spot[1]], [spot[0] + 30, spot[1]]], () =>
      page.waitForTimeout(300),
    );
    await expect.poll(async () => (await pins()).length).toBe(before + 1);
    await page.getByRole('button', { name: 'Straighten' }).click();
    await expect.poll(() => nHandles(page)).toBe(0);
    await waitUntilSaved(page);
    expect(await page.evaluate(() => window.studio.state().pose)).toBeNull();
  });

  test('no click and no pull is lost, however soon it is released', async () => {
    await startGrabbing(page);
    const { x, y, size } = await pictureFrame(page);
    const nPins = async () => {
      const { fixed } = await pose(page);
      return fixed && 'any' in fixed ? fixed.any.length : 0;
    };
    for (let k = 0; k < 8; k++) {
      const before = await nPins();
      await page.mouse.click(x + 0.01 * (k % 3) * size, y + 0.01 * k * size, { delay: 6 * k });
      await expect.poll(nPins).toBe(before + 1);
    }
    const before = await nHandles(page);
    await drag(page, [
      [x, y],
      [x + 0.05 * size, y],
    ]);
    await expect.poll(() => nHandles(page), { timeout: 60_000 }).toBe(before + 1);
    expect(Math.hypot(...(await pose(page)).handle.at(-1)!.by)).toBeGreaterThan(0.01);
    await waitUntilSaved(page);
    await page.getByRole('button', { name: 'Straighten' }).click();
    await waitUntilSaved(page);
  });

  test('a click that is cancelled leaves nothing, and a lost picture ends the pull', async () => {
    await startGrabbing(page);
    const before = await currentEdit(page);
    const { x, y, size } = await pictureFrame(page);
    await pull(page, [x, y], [0.1 * size, 0], async () => {
      await page.keyboard.press('Escape');
    });
    expect(await currentEdit(page)).toEqual(before);
    await pull(page, [x, y], [0.1 * size, 0], async () => {
      await page.evaluate(() => {
        const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
        const lose = canvas.getContext('webgl2')!.getExtension('WEBGL_lose_context')!;
        lose.loseContext();
        setTimeout(() => lose.restoreContext(), 300);
      });
      await page.waitForTimeout(800);
    });
    expect(await nHandles(page)).toBe(1);
    await waitUntilSaved(page);
    expect(largestMove(await positions(page), await storedPositions(page))).toBeLessThan(1e-4);
  });
});

test('the brush clones detail to where it is dragged, live, and undo takes it back', async ({ browser }) => {
  const studio = await openStudio(browser, 'clone');
  const { page } = studio;
  try {
    const rest = await positions(page);
    await page.keyboard.press('b');
    await page.locator('[data-effect="clone"]').click();
    const { x, y, size } = await pictureFrame(page);
    await page.mouse.click(x + 0.06 * size, y);
    await expect(page.locator('.toasts')).toContainText('Spot picked');
    const path: Point[] = [0, 1, 2, 3, 4].map((k) => [x - 0.03 * size, y + 0.03 * k * size]);
    let during: number[] = [];
    await drag(page, path, async () => {
      await expect.poll(async () => (await currentEdit(page)).clones?.length).toBe(1);
      await page.waitForTimeout(300);
      during = await positions(page);
    });
    expect(largestMove(rest, during)).toBeGreaterThan(1e-4);
    await waitUntilSaved(page);
    const { clones } = await currentEdit(page);
    expect(clones!.length).toBe(1);
    expect(clones![0]!.targets.length).toBeGreaterThan(1);
    const cloned = await positions(page);
    expect(largestMove(cloned, await storedPositions(page))).toBeLessThan(1e-4);
    // Detail elsewhere stays, and clones bend with the shape.
    const nMoved = cloned.filter((value, i) => Math.abs(value - rest[i]!) > 1e-6).length / 3;
    expect(nMoved).toBeLessThan(0.2 * (rest.length / 3));
    await startGrabbing(page);
    await pull(page, [x, y], [0, -0.1 * size]);
    await waitUntilSaved(page);
    expect(largestMove(await positions(page), await storedPositions(page))).toBeLessThan(1e-4);
    for (let k = 0; k < 2; k++) await clickUndo(page);
    await waitUntilSaved(page);
    expect((await currentEdit(page)).clones).toEqual([]);
    expect(largestMove(rest, await positions(page))).toBe(0);
  } finally {
    await studio.end();
  }
});

/** Writes a square sheet of n × n vertices, in one part or two, without faces as a cloud, or with strays. */
function writeSheet(path: string, n: number, kind: 'sheet' | 'two parts' | 'cloud' | 'strays'): void {
  const vertices: string[] = [];
  const faces: string[] = [];
  for (let part = 0; part < (kind === 'two parts' ? 2 : 1); part++) {
    const first = vertices.length;
    for (let i = 0; i < n; i++)
      for (let j = 0; j < n; j++) {
        const height = 0.05 * Math.sin(9 * (i / n)) * Math.cos(7 * (j / n));
        vertices.push(`v ${i / n - 0.5 + 1.2 * part} ${j / n - 0.5} ${height}`);
      }
    for (let i = 0; i + 1 < n; i++)
      for (let j = 0; j + 1 < n; j++) {
        const a = first + i * n + j + 1;
        faces.push(`f ${a} ${a + n} ${a + n + 1} ${a + 1}`);
      }
  }
  if (kind === 'strays') vertices.push('v 0 0 0.3', 'v 0.2 0.1 -0.3');
  if (kind === 'cloud') faces.length = 0;
  writeFileSync(path, `${[...vertices, ...faces].join('\n')}\n`);
}

for (const kind of ['sheet', 'two parts', 'cloud', 'strays'] as const) {
  test(`${kind}: a pull bends what is under the pointer`, async ({ browser }) => {
    const file = join(OUT, `${kind.replace(' ', '-')}.obj`);
    mkdirSync(OUT, { recursive: true });
    writeSheet(file, 60, kind);
    const studio = await openStudio(browser, `grab-${kind.replace(' ', '-')}`, file);
    const { page } = studio;
    try {
      const rest = await positions(page);
      await startGrabbing(page);
      const { x, y, size } = await pictureFrame(page);
      const from: Point = kind === 'two parts' ? [x + 0.2 * size, y] : [x + 0.05 * size, y + 0.05 * size];
      await pull(page, from, [0, -0.15 * size]);
      await waitUntilSaved(page);
      const bent = await positions(page);
      expect(bent.every(Number.isFinite)).toBe(true);
      expect(largestMove(rest, bent)).toBeGreaterThan(0.05);
      // With the last bit of single precision about the center.
      expect(largestMove(bent, await storedPositions(page))).toBeLessThan(1e-4);
      if (kind === 'strays') {
        const n = rest.length;
        expect(bent.slice(n - 6)).toEqual(rest.slice(n - 6));
      }
    } finally {
      await studio.end();
    }
  });
}
