/** Actions and queries on a page of the studio that several tests share. */

import { mkdirSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { join } from 'node:path';
import { type Browser, type BrowserContext, expect, type FileChooser, type Page } from '@playwright/test';
import type { Edit } from '../../src/protocol';
import { creature, killStudio, OUT, type StudioServer, startStudio, TEST_BUILD } from './studio-server';

export type Point = [number, number];

/** Serves the files of the page from the test build instead of the bundle that the server embeds. */
export async function useTestBuild(target: Page | BrowserContext): Promise<void> {
  await target.route(/\/(index\.js|main\.js|worker\.js|studio\.css)$/, async (route) => {
    const name = new URL(route.request().url()).pathname.slice(1);
    const body = await readFile(join(TEST_BUILD, name));
    await route.fulfill({ response: await route.fetch(), body });
  });
}

/** Waits until every slider is enabled. Polls in one call, because the page's policy forbids `waitForFunction`. */
export async function waitUntilReady(page: Page): Promise<void> {
  await page.evaluate(async () => {
    while (!window.studio) await new Promise((resolve) => setTimeout(resolve, 10));
    await window.studio.ready;
  });
}

/** Collects uncaught errors of a page. */
export function collectErrors(page: Page, failures: string[], name = 'page'): void {
  page.on('pageerror', (e) => failures.push(`${name}: ${e.message}`));
}

/** Opens a page of its own in a new context. */
export async function openPage(browser: Browser, url: string, failures: string[]): Promise<Page> {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  page.setDefaultTimeout(60_000);
  await useTestBuild(page);
  collectErrors(page, failures);
  await page.goto(url);
  await waitUntilReady(page);
  return page;
}

/** Asserts that nothing was collected; repeated messages are listed once. */
export function expectNoFailures(failures: readonly string[]): void {
  expect([...new Set(failures)]).toEqual([]);
}

/** A studio of its own with one page, for the tests of a file. */
export interface OpenStudio {
  page: Page;
  server: StudioServer;
  /** Folder of its own, which the server stores edits in. */
  folder: string;
  /** Uncaught errors of the page. */
  failures: string[];
  /** Closes the page, kills the server, and asserts that no error was uncaught. */
  end(): Promise<void>;
}

/** Starts a studio on a shape, by default a creature of 20 000 vertices, and opens a page. */
export async function openStudio(browser: Browser, name: string, shape?: string): Promise<OpenStudio> {
  const folder = join(OUT, `${name}-${Date.now()}`);
  mkdirSync(folder, { recursive: true });
  const failures: string[] = [];
  const server = await startStudio(shape ?? creature(20_000), folder);
  try {
    const page = await openPage(browser, server.url, failures);
    const end = async () => {
      await page.close();
      await killStudio(server);
      expectNoFailures(failures);
    };
    return { page, server, folder, failures, end };
  } catch (error) {
    await killStudio(server);
    throw error;
  }
}

/** Drops a file on the page. */
export async function dropFile(page: Page, name: string, content: Buffer | string): Promise<void> {
  await page.evaluate(
    ([name, base64]) => {
      const bytes = Uint8Array.from(atob(base64!), (c) => c.charCodeAt(0));
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([bytes], name!));
      document.getElementById('app')!.dispatchEvent(new DragEvent('drop', { dataTransfer }));
    },
    [name, Buffer.from(content).toString('base64')],
  );
}

/** Opens a file with the file dialog of the page. */
export async function openFile(page: Page, file: Parameters<FileChooser['setFiles']>[0]): Promise<void> {
  // A page in the background opens no file chooser.
  await page.bringToFront();
  const choosing = page.waitForEvent('filechooser');
  // The browser takes a moment to intercept file choosers.
  await page.waitForTimeout(500);
  await page.keyboard.press('Control+o');
  await (await choosing).setFiles(file);
}

/** Waits until the sliders of `n` bands are enabled. */
export const waitForBands = (page: Page, n = 8): Promise<void> =>
  page
    .locator('.band input.gain:enabled')
    .nth(n - 1)
    .waitFor();

/** Takes a step back by the button. */
export const clickUndo = (page: Page): Promise<void> => page.getByRole('button', { name: /^Undo/ }).click();

/** Chooses how the region of the first layer is given. */
export async function chooseRegion(page: Page, kind: string): Promise<void> {
  await page.locator('#layers select').first().selectOption(kind);
}

/** Sum of the mask of the last layer, 255 per fully covered vertex. */
export const coverage = (page: Page): Promise<number> =>
  page.evaluate(async () => (await window.studio.mask()).reduce((sum, w) => sum + w, 0));

/** Mulberry32: deterministic pseudorandom numbers in [0, 1). */
export function randomNumbers(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Drags over the picture along `points`; `beforeRelease` is awaited before the pointer is lifted. */
export async function drag(page: Page, points: Point[], beforeRelease = async () => {}): Promise<void> {
  const [first, ...rest] = points;
  await page.mouse.move(...first!);
  await page.mouse.down();
  for (const point of rest) await page.mouse.move(...point);
  await beforeRelease();
  await page.mouse.up();
}

/** Center of the picture, and the smaller of its width and height. */
export async function pictureFrame(page: Page): Promise<{ x: number; y: number; size: number }> {
  const box = (await page.locator('canvas.picture').boundingBox())!;
  return { x: box.x + box.width / 2, y: box.y + box.height / 2, size: Math.min(box.width, box.height) };
}

/** Turns the brush on, with which the next strokes paint a region and have no effect of their own. */
export async function startPainting(page: Page): Promise<void> {
  await page.keyboard.press('b');
  await page.locator('[data-effect="region"]').evaluate((button: HTMLButtonElement) => button.click());
}

/** Current edit of the page. */
export const currentEdit = (page: Page): Promise<Edit> => page.evaluate(() => window.studio.state());

/** Resolves when the server has stored every step. */
export const waitUntilSaved = (page: Page): Promise<void> => page.evaluate(() => window.studio.saved());

/** Number of strokes of the last layer. */
export const strokeCount = (page: Page): Promise<number> =>
  page.evaluate(() => {
    const region = window.studio.state().layers.at(-1)!.region;
    return region && 'painted' in region ? region.painted.length : 0;
  });

/** Waits until the last layer has `n` strokes; returns false after ten seconds. */
export async function waitForStrokes(page: Page, n: number): Promise<boolean> {
  for (let i = 0; i < 200 && (await strokeCount(page)) < n; i++) await page.waitForTimeout(50);
  return (await strokeCount(page)) >= n;
}

/** Moves the gain slider of a band (counted from 0) to a position and releases it. */
export async function setSlider(page: Page, band: number, position: number): Promise<void> {
  await page.evaluate(
    ([j, value]) => {
      const input = document.querySelectorAll<HTMLInputElement>('.band input.gain')[j!]!;
      input.value = String(value);
      for (const type of ['input', 'change']) input.dispatchEvent(new Event(type, { bubbles: true }));
    },
    [band, position],
  );
}

/** Response of the server to a request of the shown shape, as text; with a body, a POST. */
export const askServer = (page: Page, path: string, body?: object): Promise<string> =>
  page.evaluate(
    async ([path, body]) => {
      const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
      const init = body === undefined ? { headers } : { headers, method: 'POST', body: JSON.stringify(body) };
      const response = await fetch(`api/shapes/${sessionStorage.getItem('adwave-shape')}/${path}`, init);
      return response.text();
    },
    [path, body] as const,
  );

/** Saves the shown shape under a name next to the opened file, and returns its path. */
export async function saveShape(page: Page, name: string): Promise<string> {
  return (JSON.parse(await askServer(page, 'save', { name, replace: true })) as { path: string }).path;
}
