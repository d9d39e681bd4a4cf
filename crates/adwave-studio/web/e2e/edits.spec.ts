/** An edit is never lost: other bands, solo, a reload, a pick and a change of layer, and a file that exists. */

import { mkdtempSync, writeFileSync } from 'node:fs';
import { copyFile } from 'node:fs/promises';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  chooseRegion,
  clickUndo,
  currentEdit,
  drag,
  dropFile,
  expectNoFailures,
  openPage,
  type Point,
  pictureFrame,
  setSlider,
  waitForStrokes,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { creature, killStudio, type StudioServer, startStudio } from './support/studio-server';

let server: StudioServer;
let page: Page;
let folder: string;
const failures: string[] = [];

const gains = async () => (await currentEdit(page)).layers[0]!.gains;

/** Sets the number of bands and of bands per octave in the dialog. */
async function chooseBands(count: number, voices: number): Promise<void> {
  await page.getByRole('button', { name: 'Bands', exact: true }).click();
  await page.getByLabel('Choose bands').selectOption('count');
  await page.getByLabel('Number of bands').fill(String(count));
  await page.getByLabel('Bands per octave').fill(String(voices));
  await page.getByRole('button', { name: 'Apply', exact: true }).click();
}

/** Sum of the displayed coordinates with weights, which tells two pictures apart. */
const positionSum = (target: Page) =>
  target.evaluate(async () => {
    const positions = await window.studio.positions();
    return positions.reduce((sum, x, i) => sum + x * (i % 101), 0);
  });

test.beforeAll(async ({ browser }) => {
  folder = mkdtempSync(join(tmpdir(), 'adwave-edits-'));
  const shape = join(folder, 'creature.ply');
  await copyFile(creature(20_000), shape);
  server = await startStudio(shape, join(folder, 'state'));
  page = await openPage(browser, server.url, failures);
});

test.afterAll(async () => {
  await page.close();
  await killStudio(server);
});

test('other bands keep the edit, also what is changed meanwhile, and undo brings the old bands back', async () => {
  await setSlider(page, 0, 0);
  await waitUntilSaved(page);
  const before = await gains();
  await chooseBands(30, 1);
  await expect(page.getByRole('alert')).toContainText('whole number of bands from 1 to 24');
  await page.keyboard.press('Escape');
  await chooseBands(8, 2);
  // A step while the server computes.
  await setSlider(page, 7, 200);
  await expect(page.locator('.band')).toHaveCount(15);
  await expect(page.locator('.band.waiting')).toHaveCount(0);
  const mapped = await gains();
  expect([mapped.length, mapped[0], mapped[14], mapped[7]]).toEqual([15, 0, 4, 1]);
  await waitUntilSaved(page);
  await clickUndo(page);
  await expect(page.locator('.band')).toHaveCount(8);
  await expect(page.locator('.band.waiting')).toHaveCount(0);
  expect(await gains()).toEqual([...before.slice(0, 7), 4]);
  await clickUndo(page);
  expect(await gains()).toEqual(before);
  await page.getByRole('button', { name: /^Redo/ }).click();
  await waitUntilSaved(page);
});

test('solo shows one band and leaves the edit, and a reload keeps the steps', async () => {
  const before = await gains();
  const figures = await page.locator('.readouts').textContent();
  await page.locator('.band input.gain').nth(2).press('s');
  await expect(page.locator('.band.unheard')).toHaveCount(7);
  expect(await gains()).toEqual(before);
  await page.reload();
  await waitUntilReady(page);
  expect(await gains()).toEqual(before);
  await expect(page.locator('.band.unheard')).toHaveCount(0);
  await expect(page.locator('.readouts')).toHaveText(figures!);
  await clickUndo(page);
  expect((await gains())[7]).toBe(1);
  await page.getByRole('button', { name: /^Redo/ }).click();
  expect(await gains()).toEqual(before);
  await waitUntilSaved(page);
});

test('a band has two tab stops, and its buttons are 24 pixels', async () => {
  const stops = await page
    .locator('.band')
    .first()
    .locator('input, button')
    .evaluateAll((all) => [
      all.filter((e) => (e as HTMLElement).tabIndex >= 0).length,
      ...all.filter((e) => e.tagName === 'BUTTON').map((e) => Math.min(e.clientWidth, e.clientHeight) + 2),
    ]);
  expect(stops).toEqual([2, 24, 24]);
});

test('a pick ends with a change of layer, and a file that exists can be replaced', async () => {
  await page.keyboard.press('l');
  await chooseRegion(page, 'ball');
  const before = await currentEdit(page);
  await page.getByRole('button', { name: 'Choose center' }).click();
  await page.keyboard.press(',');
  const { x, y } = await pictureFrame(page);
  await page.mouse.click(x, y);
  await page.waitForTimeout(300);
  expect(await currentEdit(page)).toEqual(before);
  writeFileSync(join(folder, 'creature-edited.ply'), 'mine');
  await page.keyboard.press('Control+s');
  await page.getByRole('button', { name: 'Replace it' }).click();
  await expect(page.locator('.toasts')).toContainText('Saved as');
  expectNoFailures(failures);
});

test('a first stroke has a live effect, on a layer of its own', async () => {
  await page.keyboard.press('b');
  const { x, y, size } = await pictureFrame(page);
  const layers = (await currentEdit(page)).layers.length;
  const path: Point[] = [0, 1, 2, 3].map((k) => [x + 0.02 * k * size, y]);
  const before = await positionSum(page);
  await drag(page, path, () => expect.poll(() => positionSum(page)).not.toBe(before));
  expect(await waitForStrokes(page, 1)).toBe(true);
  await drag(
    page,
    path.map(([u, v]) => [u, v + 20] as Point),
  );
  expect(await waitForStrokes(page, 2)).toBe(true);
  const { layers: after } = await currentEdit(page);
  expect([after.length, after.at(-1)!.name, after.at(-1)!.gains[0]]).toEqual([layers + 1, 'Smooth', 0]);
  // The region is seen beside a color map, and not on its own.
  await page.keyboard.press('c');
  await page.waitForTimeout(300);
  await page.getByRole('button', { name: 'Enhance', exact: true }).click();
  await drag(page, path);
  await expect.poll(async () => (await currentEdit(page)).layers.length).toBe(layers + 2);
  expectNoFailures(failures);
});

test('a deleted layer frees its mask, and undo brings both back', async () => {
  await waitUntilSaved(page);
  const masks = () => page.evaluate(() => window.studio.maskCount());
  const mask = () => page.evaluate(async () => Array.from(await window.studio.mask()));
  // The end of the last stroke may still be on its way.
  const weights = async () => (await mask()).reduce((total, w) => total + w, 0);
  await expect
    .poll(async () => {
      const total = await weights();
      await page.waitForTimeout(300);
      return (await weights()) === total;
    })
    .toBe(true);
  const [before, painted, sum] = [await masks(), await mask(), await positionSum(page)];
  expect(painted.filter((w) => w > 0).length).toBeGreaterThan(20);
  const { layers } = await currentEdit(page);
  await page.getByRole('tab', { name: 'Layers', exact: true }).click();
  for (const step of ['deleted', 'undone', 'deleted again', 'undone again']) {
    if (step.startsWith('deleted')) {
      await page
        .getByRole('button', { name: `Delete ${layers.at(-1)!.name}` })
        .last()
        .click();
      expect((await currentEdit(page)).layers.length, step).toBe(layers.length - 1);
      expect(await masks(), step).toBe(before - 1);
      expect(await positionSum(page), step).not.toBe(sum);
    } else {
      await clickUndo(page);
      expect(await mask(), step).toEqual(painted);
      expect(await masks(), step).toBe(before);
      expect(await positionSum(page), step).toBe(sum);
    }
  }
  // The other way round: what is undone has no mask, and redo gives it one.
  await clickUndo(page);
  expect(await masks()).toBe(before - 1);
  await page.getByRole('button', { name: /^Redo/ }).click();
  expect(await mask()).toEqual(painted);
  expectNoFailures(failures);
});

test('a file of values dropped on the shape colors it, also after a reload', async () => {
  await page.keyboard.press('Escape');
  const n = await page.evaluate(async () => (await window.studio.positions()).length / 3);
  await dropFile(page, 'short.csv', '1\n2\n');
  await expect(page.getByRole('alert')).toContainText('one row per vertex');
  await dropFile(page, 'Wärme.csv', Array.from({ length: n }, (_, v) => `${v / n}\n`).join(''));
  await expect(page.locator('.legend-title')).toHaveText('Wärme');
  // Whole numbers are classes.
  await dropFile(page, 'label.csv', Array.from({ length: n }, (_, v) => `${v % 3}\n`).join(''));
  await expect(page.locator('.swatches li')).toHaveText(['0', '1', '2']);
  await page.keyboard.press('3');
  await waitUntilSaved(page);
  await page.reload();
  await waitUntilReady(page);
  await expect(page.locator('.swatches li')).toHaveCount(3);
  expectNoFailures(failures);
});

test('the denoised copy is compared with the shape before', async () => {
  await page.getByRole('button', { name: 'Tools', exact: true }).click();
  await page.getByRole('button', { name: 'Denoise', exact: true }).click();
  // A debug build on a busy machine takes a while.
  await expect(page.locator('.comparison')).toContainText('before denoising', { timeout: 120_000 });
  await expect(page.locator('.divider')).toContainText('With noise');
  await page.getByRole('button', { name: 'End comparison' }).click();
  expectNoFailures(failures);
});
