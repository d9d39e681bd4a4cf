/** First contact with a shape: its colors, facts about places, and gains that are refused. */

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  askServer,
  coverage,
  currentEdit,
  dropFile,
  type OpenStudio,
  openFile,
  openStudio,
  pictureFrame,
  saveShape,
  setSlider,
  startPainting,
  waitForBands,
  waitForStrokes,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { decodePng } from './support/png';
import { ADWAVE, creature, OUT } from './support/studio-server';

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

/** Three copies of a mesh beside each other as a binary PLY, of which the second and the third are inside out. */
function threeParts(path: string): Buffer {
  const copies = [readFileSync(path), insideOut(path), insideOut(path)];
  const end = copies[0]!.indexOf('end_header\n') + 'end_header\n'.length;
  const head = copies[0]!.toString('latin1', 0, end);
  const [n, m] = ['vertex', 'face'].map((what) =>
    Number(head.match(new RegExp(`element ${what} (\\d+)`))![1]),
  );
  const vertices = copies.map((bytes, k) => {
    const rows = Buffer.from(bytes.subarray(end, end + 24 * n!));
    for (let v = 0; v < n!; v++) rows.writeDoubleLE(rows.readDoubleLE(24 * v) + 1.4 * (k - 1), 24 * v);
    return rows;
  });
  const faces = copies.map((bytes, k) => {
    const rows = Buffer.from(bytes.subarray(end + 24 * n!, end + 24 * n! + 13 * m!));
    for (let f = 0; f < m!; f++)
      for (const at of [1, 5, 9]) rows.writeUInt32LE(rows.readUInt32LE(13 * f + at) + k * n!, 13 * f + at);
    return rows;
  });
  const counts = head.replace(`vertex ${n}`, `vertex ${3 * n!}`).replace(`face ${m}`, `face ${3 * m!}`);
  return Buffer.concat([Buffer.from(counts, 'latin1'), ...vertices, ...faces]);
}

/** Corners of the triangles of a binary PLY, from the smallest one on. */
function facesOf(bytes: Buffer): number[][] {
  const start = bytes.indexOf('end_header\n') + 'end_header\n'.length;
  const head = bytes.toString('latin1', 0, start);
  const count = (what: string) => Number(head.match(new RegExp(`element ${what} (\\d+)`))![1]);
  return Array.from({ length: count('face') }, (_, f) => {
    const at = start + 24 * count('vertex') + 13 * f + 1;
    const corners = [0, 4, 8].map((byte) => bytes.readUInt32LE(at + byte));
    const first = corners.indexOf(Math.min(...corners));
    return [...corners.slice(first), ...corners.slice(0, first)];
  });
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
      await page.getByRole('button', { name: 'Turn them outward' }).click();
      await expect(page.locator('.readouts')).toContainText('Volume0.3');
      await page.waitForTimeout(500);
      expect((await brightness(page)) / outside).toBeCloseTo(1, 1);
      await waitUntilSaved(page);
      expect((await currentEdit(page)).turned).toEqual([0]);
      await page.screenshot({ path: join(OUT, '51-turned.png') });
      // The saved file has the triangles of the creature itself, each begun at the same corner.
      const saved = await saveShape(page, 'turned.ply');
      const command = join(studio.folder, 'turned-by-command.ply');
      execFileSync(ADWAVE, ['convert', path, '-o', command, '--turn-faces', 'inward']);
      expect(readFileSync(saved).equals(readFileSync(command)), 'the bytes of the command').toBe(true);
      expect(facesOf(readFileSync(saved))).toEqual(facesOf(readFileSync(creature(5000))));
      await page.reload();
      await waitUntilReady(page);
      await page.getByRole('tab', { name: 'View' }).click();
      await expect(page.getByLabel('Turn faces outward'), 'the edit is kept').toBeChecked();
      await undo().click();
      await expect(page.getByLabel('Turn faces outward')).not.toBeChecked();
      await expect(page.locator('.readouts')).toContainText('Volume (faces point inward)−0.3');
      await waitUntilSaved(page);
      const unturned = await saveShape(page, 'unturned.ply');
      expect(readFileSync(unturned).equals(readFileSync(path)), 'as it was').toBe(true);
      await page.getByRole('button', { name: 'File', exact: true }).click();
      await expect(page.getByRole('dialog')).toContainText('Its faces point inward');
      await page.keyboard.press('Escape');
      // The brush paints the side that is seen.
      await page.getByRole('tab', { name: 'Brush' }).click();
      await page.getByLabel('Front faces only').check();
      await startPainting(page);
      const { x, y } = await pictureFrame(page);
      await page.mouse.click(x, y);
      expect(await waitForStrokes(page, 1)).toBe(true);
      expect(await coverage(page), 'something is painted').toBeGreaterThan(255);
    });

    test('inward parts of a shape are named, and turned one by one or together', async () => {
      const path = join(studio.folder, 'three-parts.ply');
      writeFileSync(path, threeParts(creature(5000)));
      await openFile(page, path);
      await page.locator('.tab.here', { hasText: 'three-parts.ply' }).waitFor();
      await waitForBands(page);
      await expect(page.locator('.toasts')).toContainText('The faces of 2 of 3 parts point inward');
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      const faces = page.getByRole('group', { name: 'Faces that point inward' });
      const first = faces.getByLabel(/^Turn the part at vertex 4948 /);
      const second = faces.getByLabel(/^Turn the part at vertex 9896 /);
      await expect(first).not.toBeChecked();
      await page.waitForTimeout(500);
      await page.screenshot({ path: join(OUT, '52-three-parts.png') });
      await second.check();
      await waitUntilSaved(page);
      expect((await currentEdit(page)).turned).toEqual([9896]);
      const one = facesOf(readFileSync(await saveShape(page, 'one.ply')));
      const plain = facesOf(readFileSync(path));
      const n = plain.length / 3;
      expect(one.slice(0, 2 * n), 'the others stay').toEqual(plain.slice(0, 2 * n));
      const asFirst = plain.slice(0, n).map((corners) => corners.map((v) => v + 9896));
      expect(one.slice(2 * n)).toEqual(asFirst);
      await faces.getByRole('button', { name: 'Turn all outward' }).click();
      await expect(first).toBeChecked();
      await waitUntilSaved(page);
      await page.waitForTimeout(500);
      await page.screenshot({ path: join(OUT, '53-three-parts-turned.png') });
      const both = await saveShape(page, 'both.ply');
      const command = join(studio.folder, 'both-by-command.ply');
      execFileSync(ADWAVE, ['convert', path, '-o', command, '--turn-faces', 'inward']);
      expect(readFileSync(both).equals(readFileSync(command)), 'the bytes of the command').toBe(true);
      // With gains too, the recipe gives the bytes of the saved file.
      await setSlider(page, 0, 40);
      await waitUntilSaved(page);
      const edited = await saveShape(page, 'edited.ply');
      const recipe = join(studio.folder, 'turned.toml');
      writeFileSync(recipe, await askServer(page, 'recipe'));
      const replayed = join(studio.folder, 'replayed.ply');
      execFileSync(ADWAVE, ['filter', path, '-o', replayed, '--recipe', recipe]);
      expect(readFileSync(edited).equals(readFileSync(replayed)), 'the bytes of the recipe').toBe(true);
      await undo().click();
      await undo().click();
      await expect(first).not.toBeChecked();
      await expect(second).toBeChecked();
      await undo().click();
      await expect(second).not.toBeChecked();
      await waitUntilSaved(page);
      // The part of a clicked place, after the brush is turned off.
      await page.keyboard.press('Escape');
      const { x, y } = await pictureFrame(page);
      await page.mouse.click(x, y);
      await card().getByRole('button', { name: 'Turn faces of this part' }).click();
      await waitUntilSaved(page);
      expect((await currentEdit(page)).turned?.length).toBe(1);
      await undo().click();
      await waitUntilSaved(page);
      expect((await currentEdit(page)).turned).toEqual([]);
    });
  });
