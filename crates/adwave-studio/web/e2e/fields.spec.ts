/** The equalizer of a field: live colors, an edit of its own, and files that equal those of `adwave filter`. */

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  chooseRegion,
  currentEdit,
  drag,
  dropFile,
  type OpenStudio,
  openFile,
  openStudio,
  type Point,
  pictureFrame,
  setSlider,
  waitForBands,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { ADWAVE, creature, OUT } from './support/studio-server';

/** Header of a NumPy array of `n` doubles. */
const NPY_HEADER = 128;

/** A NumPy array of doubles as bytes, with rows of `nColumns`. */
function npy(values: Float64Array, nColumns: number | null = null): Buffer {
  const shape = nColumns === null ? `(${values.length},)` : `(${values.length / nColumns}, ${nColumns})`;
  const head = `{'descr': '<f8', 'fortran_order': False, 'shape': ${shape}, }`;
  const file = Buffer.alloc(NPY_HEADER, ' ');
  file.set([0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, NPY_HEADER - 10, 0]);
  file.write(head, 10);
  file[NPY_HEADER - 1] = 10;
  return Buffer.concat([file, Buffer.from(values.buffer)]);
}

const doubles = (file: Buffer) =>
  new Float64Array(file.buffer.slice(file.byteOffset + NPY_HEADER, file.byteOffset + file.length));

/** Displayed values of the field; the longest distance of a value from another list of them, and the number of NaN. */
const fieldValues = (page: Page) => page.evaluate(async () => [...(await window.studio.fieldValues())!]);

/** Downloads the values of the shown field. */
async function downloadValues(page: Page, format: string): Promise<Buffer> {
  await page.getByRole('button', { name: 'File', exact: true }).click();
  await page.getByLabel('Format of values').selectOption(format);
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Download values' }).click(),
  ]);
  expect(download.suggestedFilename()).toBe(`thickness-edited.${format}`);
  await page.keyboard.press('Escape');
  return readFileSync((await download.path())!);
}

test.describe
  .serial('fields', () => {
    const shape = creature(20_000);
    let studio: OpenStudio;
    let folder: string;
    let page: Page;
    let n = 0;

    /** Runs `adwave filter` on the dropped field, and reads its output. */
    const filtered = (gains: number[], name: string, ...more: string[]) => {
      const out = join(folder, name);
      const input = join(folder, 'thickness.npy');
      const args = [
        'filter',
        shape,
        '--signal',
        input,
        '--gains',
        gains.join(),
        '--quiet',
        '-o',
        out,
        ...more,
      ];
      execFileSync(ADWAVE, args);
      return readFileSync(out);
    };

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'fields');
      ({ page, folder } = studio);
      n = await page.evaluate(async () => (await window.studio.positions()).length / 3);
      const values = new Float64Array(n).map((_, v) =>
        v % 1500 < 120 ? Number.NaN : 2.5 + Math.sin(v / 300) + 0.4 * Math.sin(1.7 * v),
      );
      writeFileSync(join(folder, 'thickness.npy'), npy(values));
    });

    test.afterAll(() => studio.end());

    test('a slider changes the colors and no position', async () => {
      const target = page.getByRole('group', { name: 'Edit', exact: true });
      await expect(target, 'there is nothing to choose without a field').toBeHidden();
      await dropFile(page, 'thickness.npy', readFileSync(join(folder, 'thickness.npy')));
      await page.locator('.legend:not([hidden])').waitFor();
      await target.getByRole('button', { name: 'thickness' }).click();
      await waitForBands(page);
      const before = await fieldValues(page);
      await page.waitForTimeout(300);
      const noisy = await page.locator('canvas.picture').screenshot();
      await page.screenshot({ path: join(OUT, '20-field.png') });
      // The slider is held: the colors follow, and no step is made.
      const track = (await page.locator('.band input.gain').first().boundingBox())!;
      await page.mouse.move(track.x + track.width / 2, track.y + track.height / 2);
      await page.mouse.down();
      await page.mouse.move(track.x + track.width / 2, track.y + track.height - 4, { steps: 5 });
      const held = await fieldValues(page);
      await page.mouse.up();
      await waitUntilSaved(page);
      expect(held.filter((x, v) => Math.abs(x - before[v]!) > 0.1).length, 'live').toBeGreaterThan(n / 2);
      expect(
        held.every((x, v) => Number.isNaN(x) === Number.isNaN(before[v]!)),
        'walls stay',
      ).toBe(true);
      await page.waitForTimeout(300);
      expect((await page.locator('canvas.picture').screenshot()).equals(noisy), 'other colors').toBe(false);
      await page.screenshot({ path: join(OUT, '21-field-smooth.png') });
      const edit = await currentEdit(page);
      expect(edit.fields!.map((f) => f.field)).toEqual(['thickness']);
      expect(
        edit.layers[0]!.gains.every((g) => g === 1),
        'positions have their own gains',
      ).toBe(true);
      await expect(page.locator('.readouts')).toContainText('Max change');
    });

    test('values are exported as the command writes them', async () => {
      await setSlider(page, 1, 30);
      await setSlider(page, 6, 130);
      await waitUntilSaved(page);
      const { gains } = (await currentEdit(page)).fields![0]!.layers[0]!;
      expect(new Set(gains).size).toBeGreaterThan(3);
      const exported = await downloadValues(page, 'npy');
      expect(exported.equals(filtered(gains, 'out.npy')), 'equal bytes').toBe(true);
      const shown = await fieldValues(page);
      const far = doubles(exported).filter((x, v) => Math.abs(x - shown[v]!) > 2e-5);
      expect(far.length, 'the picture shows what is exported').toBe(0);
      expect((await downloadValues(page, 'csv')).equals(filtered(gains, 'out.csv')), 'equal text').toBe(true);
      expect((await downloadValues(page, 'gii')).equals(filtered(gains, 'out.gii')), 'equal GIFTI').toBe(
        true,
      );
    });

    test('layers of a field have regions, around its gaps', async () => {
      const { gains } = (await currentEdit(page)).fields![0]!.layers[0]!;
      await chooseRegion(page, 'ball');
      await waitUntilSaved(page);
      const { region } = (await currentEdit(page)).fields![0]!.layers[0]!;
      const { center, radius } = (region as { ball: { center: { vertex: number }; radius: number } }).ball;
      const where = `ball:vertex=${center.vertex},radius=${radius}`;
      const exported = await downloadValues(page, 'npy');
      expect(exported.equals(filtered(gains, 'ball.npy', '--region', where)), 'equal bytes').toBe(true);
      const expected = doubles(exported);
      await expect
        .poll(
          async () => (await fieldValues(page)).filter((x, v) => Math.abs(x - expected[v]!) > 2e-5).length,
        )
        .toBe(0);
    });

    test('undo goes to where the step acts, and a reload keeps both edits', async () => {
      const target = page.getByRole('group', { name: 'Edit', exact: true });
      const chosen = () => target.locator('[aria-pressed="true"]').textContent();
      const smoothed = await fieldValues(page);
      await target.getByRole('button', { name: 'Positions' }).click();
      await setSlider(page, 0, 0);
      await waitUntilSaved(page);
      await page.locator('canvas.picture').focus();
      await page.keyboard.press('Control+z');
      expect(await chosen()).toBe('Positions');
      await page.keyboard.press('Control+z');
      await waitForBands(page);
      expect(await chosen()).toBe('thickness');
      expect((await currentEdit(page)).fields![0]!.layers[0]!.region, 'the region is undone').toBe(null);
      await page.keyboard.press('Control+Shift+z');
      await page.keyboard.press('Control+Shift+z');
      expect(await chosen()).toBe('Positions');
      await target.getByRole('button', { name: 'thickness' }).click();
      await waitForBands(page);
      await waitUntilSaved(page);
      const edit = await currentEdit(page);
      await page.reload();
      await waitUntilReady(page);
      await expect(target.locator('[aria-pressed="true"]')).toHaveText('thickness');
      await waitForBands(page);
      expect(await currentEdit(page)).toEqual(edit);
      await expect
        .poll(
          async () => (await fieldValues(page)).filter((x, v) => Math.abs(x - smoothed[v]!) > 2e-5).length,
        )
        .toBe(0);
      await page.locator('canvas.picture').focus();
      await page.keyboard.press('Control+z');
      await waitUntilSaved(page);
      expect((await currentEdit(page)).layers[0]!.gains[0], 'the last step is undone').toBe(1);
    });

    test('the brush edits a field live, and other bands keep the edit', async () => {
      await page.getByRole('group', { name: 'Edit', exact: true }).getByRole('button').last().click();
      await waitForBands(page);
      await chooseRegion(page, 'everywhere');
      await waitUntilSaved(page);
      const before = await fieldValues(page);
      await page.keyboard.press('b');
      await page.locator('[data-effect="smooth"]').click();
      await expect(page.locator('[data-effect="clone"]'), 'fields have no detail to clone').toBeHidden();
      const { x, y, size } = await pictureFrame(page);
      let during: number[] = [];
      await drag(
        page,
        [0, 1, 2, 3].map((k): Point => [x + 0.03 * size * (k - 1), y + 0.02 * size * k]),
        async () => {
          await page.waitForTimeout(300);
          during = await fieldValues(page);
        },
      );
      await page.keyboard.press('b');
      await waitUntilSaved(page);
      const changed = (values: number[]) => values.filter((v, i) => Math.abs(v - before[i]!) > 1e-3).length;
      expect(changed(during), 'live').toBeGreaterThan(20);
      expect(changed(during), 'where it was painted').toBeLessThan(0.3 * n);
      const { layers } = (await currentEdit(page)).fields![0]!;
      expect(layers.map((l) => l.name)).toEqual(['', 'Smooth']);
      await page.getByRole('button', { name: 'Bands', exact: true }).first().click();
      await page.getByLabel('Choose bands').selectOption('count');
      await page.getByLabel('Number of bands').fill('5');
      await page.getByRole('dialog').getByRole('button', { name: 'Apply' }).click();
      await expect(page.locator('.band')).toHaveCount(5);
      await waitForBands(page, 5);
      await waitUntilSaved(page);
      const five = (await currentEdit(page)).fields![0]!.layers[0]!.gains;
      expect(five).toEqual(layers[0]!.gains.slice(0, 5));
      const { region: _, ...rest } = layers[1]!;
      expect((await currentEdit(page)).fields![0]!.layers[1]).toMatchObject({ name: rest.name });
      await setSlider(page, 4, 40);
      await waitUntilSaved(page);
      expect(changed(await fieldValues(page))).toBeGreaterThan(n / 2);
      await page.locator('canvas.picture').focus();
      // The gain, the bands, and the stroke; there is no step while the server computes bands.
      await page.keyboard.press('Control+z');
      await page.keyboard.press('Control+z');
      await expect(page.locator('.band')).toHaveCount(8);
      await waitForBands(page);
      await page.keyboard.press('Control+z');
      await expect.poll(async () => changed(await fieldValues(page)), 'all is undone').toBe(0);
    });

    test('a recipe of the field is opened on the field, and undo takes it back', async () => {
      const target = page.getByRole('group', { name: 'Edit', exact: true });
      await target.getByRole('button').last().click();
      await waitForBands(page);
      for (const [band, position] of [
        [0, 20],
        [3, 150],
      ] as const)
        await setSlider(page, band, position);
      await waitUntilSaved(page);
      const edited = (await currentEdit(page)).fields![0]!.layers;
      const values = await fieldValues(page);
      await page.getByRole('button', { name: 'File', exact: true }).click();
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('button', { name: 'Recipe of thickness' }).click(),
      ]);
      const recipe = readFileSync((await download.path())!, 'utf8');
      await page.keyboard.press('Escape');
      // The command's recipe of the same gains names the file, and widths instead of steps.
      const saved = join(folder, 'command.toml');
      filtered(edited[0]!.gains, 'recipe.npy', '--save-recipe', saved);
      const gains = async () => (await currentEdit(page)).fields![0]!.layers[0]!.gains;
      for (const content of [recipe, readFileSync(saved, 'utf8')]) {
        await setSlider(page, 5, 60);
        await waitUntilSaved(page);
        const other = await gains();
        expect(other).not.toEqual(edited[0]!.gains);
        await target.getByRole('button', { name: 'Positions' }).click();
        await dropFile(page, 'thickness.toml', content);
        await expect(target.locator('[aria-pressed="true"]')).toHaveText('thickness');
        await waitForBands(page);
        expect(await gains()).toEqual(edited[0]!.gains);
        await expect
          .poll(
            async () => (await fieldValues(page)).filter((x, v) => Math.abs(x - values[v]!) > 2e-5).length,
          )
          .toBe(0);
        await waitUntilSaved(page);
        await page.locator('canvas.picture').focus();
        await page.keyboard.press('Control+z');
        await expect.poll(gains).toEqual(other);
        await waitForBands(page);
        await page.keyboard.press('Control+Shift+z');
        await expect.poll(gains).toEqual(edited[0]!.gains);
        await waitForBands(page);
        await waitUntilSaved(page);
      }
      await dropFile(page, 'age.toml', recipe.replace('"thickness"', '"age"'));
      await expect(page.getByRole('alert')).toContainText(
        "the field 'age', which this shape does not have; drop its file, such as age.npy, on the page",
      );
    });

    test('narrow windows, and a field without values', async () => {
      await page.getByRole('group', { name: 'Edit', exact: true }).getByRole('button').last().click();
      await waitForBands(page);
      await page.setViewportSize({ width: 390, height: 844 });
      await page.waitForTimeout(400);
      await page.screenshot({ path: join(OUT, '22-field-390.png') });
      const scrollWidth = await page.evaluate(() => document.documentElement.scrollWidth);
      expect(scrollWidth, 'nothing is wider than the window').toBeLessThanOrEqual(390);
      await page.setViewportSize({ width: 1200, height: 900 });
      await openFile(page, creature(2000));
      await page.locator('.tab.here', { hasText: 'creature-2000.ply' }).waitFor();
      await waitForBands(page, 3);
      await page.waitForTimeout(300);
      await expect(page.locator('.toasts .error'), 'another tab has no such field').toHaveCount(0);
      await page.locator('.tab', { hasText: 'creature-20000' }).getByRole('button').first().click();
      await waitForBands(page);
      await expect(
        page.getByRole('group', { name: 'Edit', exact: true }).locator('[aria-pressed="true"]'),
        'the field is edited again',
      ).toHaveText('thickness');
      await dropFile(page, 'nothing.npy', npy(new Float64Array(n).fill(Number.NaN)));
      await expect(page.locator('.legend')).toContainText('No values');
      await expect(
        page.getByRole('group', { name: 'Edit', exact: true }).locator('[aria-pressed="true"]'),
      ).toHaveText('Positions');
      await page.getByRole('tab', { name: 'Layers', exact: true }).click();
      await page.getByLabel('Where').first().selectOption('field');
      await page.waitForTimeout(300);
      await expect(page.locator('.toasts')).toContainText(/no value/);
    });
  });

test.describe
  .serial('values over time', () => {
    let studio: OpenStudio;
    let page: Page;
    const nFrames = 80;
    const bar = () => page.locator('.frame-bar');
    const legendNumbers = () => page.locator('.legend-numbers').textContent();
    const at = async () => Number((await bar().locator('output').textContent())!.split(' ')[0]);

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'frames', creature(5000));
      ({ page } = studio);
      await expect(bar(), 'a shape without series has no frames').toBeHidden();
      const positions = await page.evaluate(async () => [...(await window.studio.positions())]);
      const n = positions.length / 3;
      // A wave that runs up the body and grows, so that frames have other ranges.
      const values = new Float64Array(n * nFrames);
      for (let v = 0; v < n; v++) {
        for (let t = 0; t < nFrames; t++) {
          values[v * nFrames + t] = (1 + t / nFrames) * Math.sin(4 * positions[3 * v + 1]! - t / 6);
        }
      }
      await dropFile(page, 'wave.npy', npy(values, nFrames));
      await bar().waitFor();
    });

    test.afterAll(() => studio.end());

    test('a slider chooses a frame, and all frames have the same colors', async () => {
      await expect(page.locator('.toasts')).toContainText('a field of 80 frames');
      expect(await at()).toBe(1);
      await expect(page.locator('.legend')).toBeVisible();
      const numbers = await legendNumbers();
      const first = await page.locator('canvas.picture').screenshot();
      await bar().getByRole('slider').fill('39');
      await expect(page.locator('.legend-title')).toContainText('wave 40');
      await page.waitForTimeout(300);
      expect((await page.locator('canvas.picture').screenshot()).equals(first), 'other colors').toBe(false);
      expect(await legendNumbers(), 'the colors keep their meaning').toBe(numbers);
      await page.screenshot({ path: join(OUT, '23-frames.png') });
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      const entries = await page.getByLabel('Colors').locator('option').allInnerTexts();
      expect(entries.filter((entry) => entry.startsWith('wave'))).toEqual(['wave (80 frames)']);
    });

    test('frames play, and the one on which they rest can be edited', async () => {
      const numbers = await legendNumbers();
      await bar().getByRole('button', { name: 'Play the frames' }).click();
      await expect.poll(at).toBeGreaterThan(45);
      await expect.poll(at, 'they begin again').toBeLessThan(40);
      await bar().getByRole('button', { name: 'Pause' }).click();
      const rest = await at();
      expect(await legendNumbers()).toBe(numbers);
      await expect(page.locator('.legend-title')).toContainText(`wave ${rest}`);
      await page.waitForTimeout(400);
      expect(await at(), 'nothing plays on').toBe(rest);
      const target = page.getByRole('group', { name: 'Edit', exact: true });
      await target.getByRole('button', { name: `wave ${rest}`, exact: true }).click();
      await waitForBands(page);
      await setSlider(page, 0, 0);
      await waitUntilSaved(page);
      expect((await currentEdit(page)).fields!.map((f) => f.field)).toEqual([`wave ${rest}`]);
    });

    test('a reload and a narrow window keep the frames', async () => {
      const rest = await at();
      await page.reload();
      await waitUntilReady(page);
      await expect.poll(at).toBe(rest);
      await page.setViewportSize({ width: 390, height: 844 });
      await page.waitForTimeout(400);
      await page.screenshot({ path: join(OUT, '24-frames-390.png') });
      const boxes = await Promise.all(
        ['.frame-bar', '.legend', '.scale-bar'].map((name) => page.locator(name).boundingBox()),
      );
      const [frames, legend, scale] = boxes.map((box) => box!);
      expect(legend!.y + legend!.height, 'the legend is above').toBeLessThanOrEqual(frames!.y);
      expect(scale!.y + scale!.height, 'so is the scale').toBeLessThanOrEqual(frames!.y);
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      await page.getByLabel('Colors').selectOption('none');
      await expect(bar()).toBeHidden();
    });
  });
