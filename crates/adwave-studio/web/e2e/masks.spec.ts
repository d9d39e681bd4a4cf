/** Random brush strokes: every byte of the page's mask must be that of the server. */

import { expect, type Page, test } from '@playwright/test';
import {
  drag,
  openStudio,
  type Point,
  pictureFrame,
  randomNumbers,
  startPainting,
  strokeCount,
  waitForStrokes,
} from './support/page';

const N_STROKES = Number(process.env['STUDIO_STROKES'] ?? 50);
const SEED = Number(process.env['STUDIO_SEED'] ?? 1);

/** Differences of the masks of the page and of the server for the last layer. */
function compareMasks(page: Page) {
  return page.evaluate(async () => {
    const headers = {
      Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}`,
      'Content-Type': 'application/json',
    };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const { region } = window.studio.state().layers.at(-1)!;
    const body = JSON.stringify(region);
    const response = await fetch(`api/shapes/${shapes[0].id}/weights`, { method: 'POST', headers, body });
    const expected = new Uint8Array(await response.arrayBuffer());
    const mask = await window.studio.mask();
    const wrong: [number, number, number][] = [];
    for (let v = 0; v < expected.length; v++) {
      if (mask[v] !== expected[v]) wrong.push([v, mask[v]!, expected[v]!]);
    }
    return {
      isEqual: mask.length === expected.length && wrong.length === 0,
      wrong: wrong.slice(0, 5),
      nPainted: mask.filter((w) => w).length,
    };
  });
}

test('masks of strokes equal those of the server', async ({ browser }) => {
  const random = randomNumbers(SEED);
  const pick = <T>(list: readonly T[]): T => list[Math.floor(random() * list.length)]!;
  const studio = await openStudio(browser, 'masks');
  const { page } = studio;
  try {
    const { x, y, size } = await pictureFrame(page);
    await page.keyboard.press('l');
    await startPainting(page);
    const setInput = (label: string, value: number, within = page.locator('body')) =>
      within.getByLabel(label, { exact: true }).evaluate((input: HTMLInputElement, to) => {
        input.value = String(to);
        input.dispatchEvent(new Event('input', { bubbles: true }));
      }, value);
    let nStrokes = 0;
    let nDrags = 0;
    let nPainted = 0;
    while (nStrokes < N_STROKES && nDrags < 4 * N_STROKES) {
      nDrags += 1;
      if (random() < 0.2) await page.keyboard.press(pick(['1', '3', '7', 'Shift+1', 'Shift+3']));
      if (random() < 0.3) await page.keyboard.press(pick(['n', 'n', 'j', '[', ']']));
      if (random() < 0.2) await page.getByLabel('Front faces only').click();
      if (random() < 0.2) await page.getByLabel('Mirror in x').click();
      if (random() < 0.3) await setInput('Soft edge', pick([0, 35, 70, 100]));
      if (random() < 0.3) await setInput('Strength', pick([25, 60, 100]), page.locator('#brush'));
      // Mostly over the shape: a drag that begins next to it is not a stroke.
      const point = (): Point => [x + 0.2 * size * (random() - 0.5), y + 0.5 * size * (random() - 0.5)];
      const [from, to] = [point(), point()];
      const steps = 2 + Math.floor(6 * random());
      const along = (k: number): Point => [
        from[0] + ((to[0] - from[0]) / steps) * k,
        from[1] + ((to[1] - from[1]) / steps) * k,
      ];
      const before = nStrokes;
      await drag(
        page,
        Array.from({ length: steps + 1 }, (_, k) => along(k)),
      );
      for (let i = 0; i < 24 && nStrokes === before; i++) {
        await page.waitForTimeout(25);
        nStrokes = await strokeCount(page);
      }
      // The drag rotated the shape.
      if (nStrokes === before) continue;
      const result = await compareMasks(page);
      nPainted = result.nPainted;
      expect.soft(result.wrong, `stroke ${nStrokes}`).toEqual([]);
      expect.soft(result.isEqual, `stroke ${nStrokes}`).toBe(true);
    }
    expect(nStrokes, `strokes in ${nDrags} drags`).toBeGreaterThanOrEqual(N_STROKES);
    expect(nPainted).toBeGreaterThan(0);
    // Undo and redo must give the bytes of the server as well.
    await page.evaluate(() => (document.activeElement as HTMLElement).blur());
    for (const key of ['Control+z', 'Control+Shift+z']) {
      for (let k = 0; k < 10; k++) await page.keyboard.press(key);
      const result = await compareMasks(page);
      expect.soft(result.wrong, `after ${key}`).toEqual([]);
      expect.soft(result.isEqual, `after ${key}`).toBe(true);
    }
    await waitForStrokes(page, nStrokes);
  } finally {
    await studio.end();
  }
});
