/** First contact with a shape: its colors, facts about places, and gains that are refused. */

import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  currentEdit,
  dropFile,
  type OpenStudio,
  openFile,
  openStudio,
  pictureFrame,
  setSlider,
  waitForBands,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
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
  });
