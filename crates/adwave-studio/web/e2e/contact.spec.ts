/** First contact with a shape: its colors, facts about places, and gains that are refused. */

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  coverage,
  currentEdit,
  dropFile,
  type OpenStudio,
  openFile,
  openStudio,
  pictureFrame,
  setSlider,
  startPainting,
  waitForBands,
  waitForStrokes,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { decodePng } from './support/png';
import { creature, OUT } from './support/studio-server';

/** A wavy sheet of points, red on one half and blue on the other, as a PLY of text. */
function coloredCloud(): string {
  const rows: string[] = [];
  for (let i = 0; i < 60; i++) {
    for (let j = 0; j < 60; j++) {
      const [x, y] = [i / 30 - 1, j / 30 - 1];
      rows.push(`${x} ${y} ${0.2 * Math.sin(3 * x)} ${i < 30 ? '255 0 0' : '0 0 255'}`);
    }
  }
  const numbers = ['x', 'y', 'z'].map((name) => `property double ${name}`);
  const colors = ['red', 'green', 'blue'].map((name) => `property uchar ${name}`);
  const head = ['ply', 'format ascii 1.0', `element vertex ${rows.length}`, ...numbers, ...colors];
  return [...head, 'end_header', ...rows, ''].join('\n');
}

/** A binary PLY whose triangles are turned inside out. */
function insideOut(path: string): Buffer {
  const bytes = readFileSync(path);
  const start = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const head = bytes.toString('latin1', 0, start);
  const count = (what: string) => Number(head.match(new RegExp(`element ${what} (\\d+)`))![1]);
  for (let f = 0; f < count('face'); f++) {
    // Behind three coordinates of 64 bits per vertex: a byte and three numbers of 32 bits per face.
    const at = start + 24 * count('vertex') + 13 * f + 1;
    bytes.subarray(at, at + 8).set([...bytes.subarray(at + 4, at + 8), ...bytes.subarray(at, at + 4)]);
  }
  return bytes;
}

/** Mean brightness of the middle of the picture. */
async function brightness(page: Page): Promise<number> {
  const { width, height, channels, pixels } = decodePng(await page.locator('canvas.picture').screenshot());
  let sum = 0;
  for (let y = -20; y < 20; y++)
    for (let x = -20; x < 20; x++)
      sum += pixels[((y + (height >> 1)) * width + x + (width >> 1)) * channels]!;
  return sum / 1600;
}

test.describe
  .serial('first contact', () => {
    let studio: OpenStudio;
    let page: Page;
    const card = () => page.locator('.card');
    const undo = () => page.getByRole('button', { name: /^Undo/ });

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'contact', creature(5000));
      ({ page } = studio);
    });

    test.afterAll(() => studio.end());

    test('a click tells about the place, whatever panel is open, until the shape moves', async () => {
      await expect(page.locator('.saving'), 'nothing is saved before the first step').toBeHidden();
      const { x, y } = await pictureFrame(page);
      const before = await page.locator('canvas.picture').screenshot();
      await page.mouse.click(x, y);
      await expect(card()).toContainText(/Vertex \d+At /);
      await page.waitForTimeout(300);
      expect((await page.locator('canvas.picture').screenshot()).equals(before), 'a mark').toBe(false);
      await page.screenshot({ path: join(OUT, '40-card.png') });
      await card().getByRole('button', { name: 'Close' }).click();
      await expect(card()).toBeHidden();
      await page.waitForTimeout(300);
      expect((await page.locator('canvas.picture').screenshot()).equals(before), 'no mark').toBe(true);
      await page.mouse.click(x, y);
      await expect(card()).toBeVisible();
      await page.locator('.band input.gain').first().focus();
      await page.keyboard.press('PageDown');
      await expect(card(), 'the place has moved').toBeHidden();
      await waitUntilSaved(page);
      await expect(page.locator('.saving')).toHaveText('Edit saved');
      await page.keyboard.press('Control+z');
      await waitUntilSaved(page);
    });

    test('a gain that is refused goes back to the one that holds', async () => {
      const number = page.locator('.band input.number').first();
      for (const typed of ['-1', 'loud', '1e9', '']) {
        await number.fill(typed);
        await number.press('Enter');
        await expect(number).toHaveValue('1.00');
        await expect(page.getByRole('alert')).toContainText('100');
      }
      expect((await currentEdit(page)).layers[0]!.gains[0]).toBe(1);
    });

    test('a drag that ends where it began is no step, and one that a reload ends is', async () => {
      await expect(undo()).toBeDisabled();
      const track = (await page.locator('.band input.gain').first().boundingBox())!;
      const [x, y] = [track.x + track.width / 2, track.y + track.height / 2];
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.mouse.move(x, y + 30, { steps: 4 });
      await page.mouse.move(x, y, { steps: 4 });
      await page.mouse.up();
      expect((await currentEdit(page)).layers[0]!.gains[0]).toBe(1);
      await expect(undo()).toBeDisabled();
      await page.mouse.down();
      await page.mouse.move(x, y + 30, { steps: 4 });
      const held = (await currentEdit(page)).layers[0]!.gains[0];
      expect(held).toBeLessThan(1);
      await page.reload();
      await page.mouse.up();
      await waitUntilReady(page);
      await waitForBands(page);
      expect((await currentEdit(page)).layers[0]!.gains[0]).toBe(held);
      await undo().click();
      expect((await currentEdit(page)).layers[0]!.gains[0]).toBe(1);
      await waitUntilSaved(page);
    });

    test('the recipe that is offered is that of what is edited', async () => {
      const { length } = await page.evaluate(async () => await window.studio.positions());
      const ages = Array.from({ length: length / 3 }, (_, v) => Math.sin(v / 40) + 0.1 * (v % 3));
      await dropFile(page, 'age.csv', ages.join('\n'));
      await page
        .getByRole('group', { name: 'Edit', exact: true })
        .getByRole('button', { name: 'age' })
        .click();
      await waitForBands(page);
      const offered = async () => {
        await page.getByRole('button', { name: 'File', exact: true }).click();
        const names = await page.getByRole('dialog').getByRole('button').allTextContents();
        await page.keyboard.press('Escape');
        return names.filter((name) => /^Download$|^Recipe of/.test(name));
      };
      const all = await offered();
      await setSlider(page, 0, 20);
      await waitUntilSaved(page);
      const ofField = await offered();
      expect(ofField.filter((name) => name === 'Recipe of age').length).toBe(1);
      expect(ofField.length, 'none of the positions').toBe(all.length - 1);
    });

    test('a cloud with colors opens in these', async () => {
      const path = join(studio.folder, 'colored.ply');
      writeFileSync(path, coloredCloud());
      await openFile(page, path);
      await page.locator('.tab.here', { hasText: 'colored.ply' }).waitFor();
      await waitForBands(page, 3);
      await expect(page.locator('.readouts')).toContainText('Points');
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      await expect(page.getByLabel('Colors')).toHaveValue('field-color');
      await page.waitForTimeout(400);
      await page.screenshot({ path: join(OUT, '41-colored-cloud.png') });
    });

    test('a shape that is inside out is named, lit, and turned in the view', async () => {
      const name = 'inside-out.ply';
      await openFile(page, creature(5000));
      await waitForBands(page);
      await page.waitForTimeout(500);
      const outside = await brightness(page);
      const path = join(studio.folder, name);
      writeFileSync(path, insideOut(creature(5000)));
      await openFile(page, path);
      await page.locator('.tab.here', { hasText: name }).waitFor();
      await waitForBands(page);
      await expect(page.locator('.toasts')).toContainText('point inward');
      await expect(page.locator('.readouts')).toContainText('Volume (faces point inward)−0.3');
      await page.waitForTimeout(500);
      expect((await brightness(page)) / outside).toBeCloseTo(1, 1);
      await page.screenshot({ path: join(OUT, '50-inside-out.png') });
      await page.getByRole('button', { name: 'Turn them in this view' }).click();
      await expect(page.locator('.toasts')).toContainText('files keep them');
      await expect(page.locator('.readouts')).toContainText('Volume0.3');
      expect((await brightness(page)) / outside).toBeCloseTo(1, 1);
      await page.getByRole('button', { name: 'File', exact: true }).click();
      await expect(page.getByRole('dialog')).toContainText('Its faces point inward');
      await page.screenshot({ path: join(OUT, '51-turned.png') });
      await page.keyboard.press('Escape');
      await page.reload();
      await waitUntilReady(page);
      await page.getByRole('tab', { name: 'View' }).click();
      await expect(page.getByLabel('Turn faces outward'), 'the view is remembered').toBeChecked();
      // The brush paints the side that is seen.
      await page.getByRole('tab', { name: 'Brush' }).click();
      await page.getByLabel('Front faces only').check();
      await startPainting(page);
      const { x, y } = await pictureFrame(page);
      await page.mouse.click(x, y);
      expect(await waitForStrokes(page, 1)).toBe(true);
      expect(await coverage(page), 'something is painted').toBeGreaterThan(255);
    });
  });
