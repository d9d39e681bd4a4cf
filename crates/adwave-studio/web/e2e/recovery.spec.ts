/** Recovery: two tabs on one edit, and a server that is killed during a stroke. Only that stroke may be lost. */

import { expect, type Page, test } from '@playwright/test';
import type { Edit } from '../src/protocol';
import {
  currentEdit,
  drag,
  expectNoFailures,
  openFile,
  openPage,
  type Point,
  pictureFrame,
  setSlider,
  startPainting,
  strokeCount,
  waitForStrokes,
  waitUntilSaved,
} from './support/page';
import { creature, killStudio, OUT, startStudio } from './support/studio-server';

const gains = async (page: Page) => (await currentEdit(page)).layers[0]!.gains;

/** Gains of the first layer as stored by the server. */
const storedGains = (page: Page): Promise<number[]> =>
  page.evaluate(async () => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const edit: Edit = await (await fetch(`api/shapes/${shapes[0].id}/edit`, { headers })).json();
    return edit.layers[0]!.gains;
  });

const clickBanner = (page: Page, name: string) => page.getByRole('button', { name }).click();
const waitForBanner = (page: Page) => page.locator('.banner:not([hidden])').waitFor();

test('edits survive a second tab and a killed server', async ({ browser }) => {
  const failures: string[] = [];
  const shape = creature(20_000);
  const state = `${OUT}/recovery-${Date.now()}`;
  let server = await startStudio(shape, state);
  try {
    let first: Page;
    await test.step('two tabs: the later one is told, and loses nothing', async () => {
      first = await openPage(browser, server.url, failures);
      const second = await openPage(browser, server.url, failures);
      await setSlider(first, 0, 0);
      await waitUntilSaved(first);
      expect((await storedGains(first))[0], 'the first tab is saved').toBe(0);
      await setSlider(second, 1, 150);
      await waitForBanner(second);
      expect((await gains(second))[1], 'the second tab keeps its edit').toBeGreaterThan(1);
      expect((await gains(second))[0], 'the second tab keeps its edit').toBe(1);
      expect((await storedGains(second))[0], 'the server keeps the edit of the first').toBe(0);
      await clickBanner(second, 'Keep mine');
      await waitUntilSaved(second);
      expect((await storedGains(second))[1], 'the second tab replaces the edit').toBeGreaterThan(1);
      expect((await storedGains(second))[0], 'the second tab replaces the edit').toBe(1);
      await setSlider(first, 2, 0);
      await waitForBanner(first);
      await clickBanner(first, 'Take theirs');
      await waitUntilSaved(first);
      expect(await gains(first), 'the first tab accepts the edit').toEqual(await gains(second));
      await setSlider(first, 3, 120);
      await waitUntilSaved(first);
      expect((await storedGains(first))[3], 'and goes on from it').toBeGreaterThan(1);
      expect((await storedGains(first))[1], 'and goes on from it').toBeGreaterThan(1);
      await second.close();
    });

    let file = '';
    await test.step('the server dies during a stroke', async () => {
      const { x, y, size } = await pictureFrame(first);
      const line = (dy: number) =>
        Array.from({ length: 8 }, (_, k): Point => [x + size * 0.01 * (k - 4), y + size * dy]);
      await first.keyboard.press('l');
      await startPainting(first);
      for (const [n, dy] of [0, 0.04, -0.04].entries()) {
        await drag(first, line(dy));
        expect(await waitForStrokes(first, n + 1), `stroke ${n + 1}`).toBe(true);
      }
      await waitUntilSaved(first);
      await drag(first, line(0.08), () => killStudio(server));
      expect(await waitForStrokes(first, 4), 'the stroke goes on without the server').toBe(true);
      await waitForBanner(first);
      // Further work is not lost either: it can be saved as a file.
      const [download] = await Promise.all([
        first.waitForEvent('download'),
        clickBanner(first, 'Save edit as file'),
      ]);
      file = `${OUT}/${download.suggestedFilename()}`;
      await download.saveAs(file);
    });

    await test.step('a new server restores the edit, and the file the rest', async () => {
      const before = (await currentEdit(first)).layers;
      server = await startStudio(shape, state);
      const again = await openPage(browser, server.url, failures);
      expect(await strokeCount(again), 'at most one stroke is lost').toBeGreaterThanOrEqual(3);
      expect(await gains(again), 'the gains are restored').toEqual(await gains(first));
      await openFile(again, file);
      expect(await waitForStrokes(again, 4), 'the file restores the rest').toBe(true);
      await waitUntilSaved(again);
      expect((await currentEdit(again)).layers, 'all of it').toEqual(before);
    });

    await test.step('a built-in shape, which has no format, can be saved', async () => {
      await killStudio(server);
      server = await startStudio('sample:sphere', state);
      const sample = await openPage(browser, server.url, failures);
      await sample.getByRole('button', { name: 'File', exact: true }).click();
      expect(await sample.locator('dialog[open] select').first().isVisible()).toBe(true);
    });
    expectNoFailures(failures);
  } finally {
    await killStudio(server);
  }
});
