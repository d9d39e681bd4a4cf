/**
 * Undo and redo on a large shape, with a mock server that responds immediately: after each step the picture must show
 * the present document before the key press is over.
 */

import { expect, test } from '@playwright/test';
import { startMockServer } from './support/mock-server';
import { expectNoFailures, openPage } from './support/page';
import { TEST_BUILD } from './support/studio-server';

declare global {
  interface Window {
    pictures: {
      /** Sends Ctrl+Z, or Ctrl+Shift+Z, and takes the picture when the event is over; returns the canvas width. */
      step(shiftKey: boolean, name: string): number;
      /** Takes the picture of the next frame. */
      nextFrame(name: string): Promise<void>;
      /** Mean difference of two pictures per byte, in the part of the width from `from` to `to`. */
      difference(a: string, b: string, from?: number, to?: number): number;
    };
  }
}

/** More triangles than are drawn during motion without a GPU. */
const N_VERTICES = 40_000;
/** The coarse version, with flat shading, differs from the full one by less than this part of the effect of a step. */
const TOLERANCE = 0.5;

/** Installs `window.pictures` in the page. */
function installPictures(): void {
  const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
  const small = new OffscreenCanvas(200, 150);
  const context = small.getContext('2d', { willReadFrequently: true })!;
  const pictures: Record<string, Uint8ClampedArray> = {};
  const press = (key: string, init: KeyboardEventInit = {}, type = 'keydown') =>
    document.body.dispatchEvent(new KeyboardEvent(type, { key, bubbles: true, cancelable: true, ...init }));
  const take = (name: string) => {
    context.drawImage(canvas, 0, 0, small.width, small.height);
    pictures[name] = context.getImageData(0, 0, small.width, small.height).data;
  };
  window.pictures = {
    step(shiftKey, name) {
      press('z', { ctrlKey: true, shiftKey });
      take(name);
      return canvas.width;
    },
    nextFrame(name) {
      press('\\');
      press('\\', {}, 'keyup');
      return new Promise((resolve) => requestAnimationFrame(() => resolve(take(name))));
    },
    difference(a, b, from = 0, to = 1) {
      const [p, q] = [pictures[a]!, pictures[b]!];
      let sum = 0;
      for (let i = 0; i < p.length; i++) {
        const x = ((i >> 2) % small.width) / small.width;
        if (x >= from && x < to) sum += Math.abs(p[i]! - q[i]!);
      }
      return sum / p.length;
    },
  };
}

test('steps are drawn within their key press', async ({ browser }) => {
  const failures: string[] = [];
  const { url, server } = await startMockServer({ nVertices: N_VERTICES, dist: TEST_BUILD });
  const page = await openPage(browser, url, failures);
  try {
    const waitUntilStill = async () => {
      await page.evaluate(() => window.studio.positions().then(() => {}));
      // The full version is drawn again a moment after the last movement.
      await page.waitForTimeout(400);
    };
    const slide = (position: number, release = true) =>
      page.evaluate(
        ([to, isReleased]) => {
          const input = [...document.querySelectorAll<HTMLInputElement>('.band input.gain')].at(-1)!;
          input.value = String(to);
          for (const type of isReleased ? ['input', 'change'] : ['input'])
            input.dispatchEvent(new Event(type, { bubbles: true }));
        },
        [position, release] as const,
      );
    const takeAtRest = async (name: string) => {
      await waitUntilStill();
      await page.evaluate((n) => window.pictures.nextFrame(n), name);
    };
    const step = (redo: boolean, name: string) =>
      page.evaluate(([r, n]) => window.pictures.step(r, n), [redo, name] as const);
    const difference = (a: string, b: string, from = 0, to = 1) =>
      page.evaluate((args) => window.pictures.difference(...args), [a, b, from, to] as [
        string,
        string,
        number,
        number,
      ]);
    /** Asserts that a picture shows one document and not another. */
    const expectShows = async (what: string, name: string, is: string, not: string, from = 0, to = 1) => {
      const near = await difference(name, is, from, to);
      const far = await difference(name, not, from, to);
      expect.soft(near, what).toBeLessThan(TOLERANCE * far);
    };
    const canvasWidth = () =>
      page.evaluate(() => document.querySelector<HTMLCanvasElement>('canvas.picture')!.width);

    await page.evaluate(installPictures);
    await takeAtRest('opened');
    await slide(0);
    await takeAtRest('flat');
    await slide(190);
    await takeAtRest('bumpy');
    const width = await canvasWidth();
    expect.soft(await difference('flat', 'bumpy'), 'a slider changes the picture').toBeGreaterThan(1);

    // At rest: immediately, at the same resolution, and after a moment bit-identical to the earlier picture.
    expect.soft(await step(false, 'back'), 'a step keeps the resolution').toBe(width);
    await expectShows('undo is drawn immediately', 'back', 'flat', 'bumpy');
    await takeAtRest('back at rest');
    expect.soft(await difference('back at rest', 'flat'), 'undo restores the picture').toBe(0);
    await step(true, 'forth');
    await expectShows('redo is drawn immediately', 'forth', 'bumpy', 'flat');

    // Two steps within a frame.
    await takeAtRest('forth at rest');
    await step(false, 'one');
    await step(false, 'two');
    await expectShows('the second of two steps is drawn', 'two', 'opened', 'bumpy');
    await step(true, 'one');
    await step(true, 'two');

    // While a slider is held, at reduced resolution: the gesture is ended and undone.
    await waitUntilStill();
    await slide(0, false);
    await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => setTimeout(resolve))));
    expect.soft(await canvasWidth(), 'fewer pixels during motion').toBeLessThan(width);
    await step(false, 'held');
    await expectShows('undo within a gesture', 'held', 'bumpy', 'flat');
    await page.setViewportSize({ width: 1100, height: 900 });
    await takeAtRest('narrower');
    const missing = await page.evaluate(() => {
      const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
      return canvas.width - canvas.clientWidth;
    });
    expect.soft(missing, 'full resolution after resizing the window').toBe(0);
    await page.setViewportSize({ width: 1200, height: 900 });

    // Wipe before/after: only the right half shows the edit.
    await takeAtRest('whole');
    await page.keyboard.press('s');
    await takeAtRest('split');
    await step(false, 'split back');
    await expectShows('the left half shows the original', 'split back', 'opened', 'bumpy', 0, 0.48);
    await expectShows('the right half is undone', 'split back', 'flat', 'bumpy', 0.52, 1);
    await takeAtRest('split back at rest');
    await expectShows('and stays so', 'split back at rest', 'flat', 'bumpy', 0.52, 1);
    expectNoFailures(failures);
  } finally {
    await page.close();
    server.closeAllConnections();
    server.close();
  }
});
