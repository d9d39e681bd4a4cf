/** Pictures for papers: any size, transparent ground, turns as frames and as a video, and the recipe of a picture. */

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  currentEdit,
  dropFile,
  type OpenStudio,
  openFile,
  openStudio,
  setSlider,
  waitForBands,
  waitUntilSaved,
} from './support/page';
import { decodePng, type PngImage } from './support/png';
import { ADWAVE, creature, OUT } from './support/studio-server';

/** Chooses sizes in the dialog of pictures, presses a button, and returns the downloaded file. */
async function make(
  page: Page,
  label: string,
  name: string,
  choices: Record<string, string> = {},
): Promise<string> {
  await page.getByRole('button', { name: 'File', exact: true }).click();
  await page.getByRole('button', { name: 'Picture for print…' }).click();
  const box = page.getByRole('dialog');
  for (const [field, value] of Object.entries(choices)) await box.getByLabel(field).fill(value);
  const downloading = page.waitForEvent('download', { timeout: 240_000 });
  await box.getByRole('button', { name: label }).click();
  const path = join(OUT, name);
  await (await downloading).saveAs(path);
  return path;
}

const sides = (width: number, height: number) => ({
  'Width (pixels)': `${width}`,
  'Height (pixels)': `${height}`,
});

const picture = async (page: Page, name: string, width: number, height: number): Promise<PngImage> =>
  decodePng(readFileSync(await make(page, 'Save picture (PNG)', name, sides(width, height))));

/** Pixel of a picture: red, green, blue, opacity. */
function pixel({ width, channels, pixels }: PngImage, x: number, y: number): number[] {
  const at = channels * (y * width + x);
  return [...pixels.subarray(at, at + channels)];
}

/** Mean difference of opacity-weighted colors between a picture and one of half the size; and the largest of a row or column. */
function differenceOfHalf(large: PngImage, small: PngImage): { mean: number; worstLine: number } {
  const rows = new Float64Array(small.height);
  const columns = new Float64Array(small.width);
  for (let y = 0; y < small.height; y++) {
    for (let x = 0; x < small.width; x++) {
      const sums = [0, 0, 0, 0];
      for (const [dx, dy] of [
        [0, 0],
        [1, 0],
        [0, 1],
        [1, 1],
      ] as const) {
        const p = pixel(large, 2 * x + dx, 2 * y + dy);
        for (let c = 0; c < 3; c++) sums[c]! += (p[c]! * p[3]!) / 255 / 4;
        sums[3]! += p[3]! / 4;
      }
      const q = pixel(small, x, y);
      let d = Math.abs(sums[3]! - q[3]!);
      for (let c = 0; c < 3; c++) d += Math.abs(sums[c]! - (q[c]! * q[3]!) / 255);
      rows[y]! += d / 4 / small.width;
      columns[x]! += d / 4 / small.height;
    }
  }
  const mean = rows.reduce((sum, d) => sum + d, 0) / small.height;
  return { mean, worstLine: Math.max(...rows, ...columns) };
}

/** Names and contents of the files of an archive without compression. */
function unpack(bytes: Buffer): Map<string, Buffer> {
  const end = bytes.length - 22;
  expect(bytes.readUInt32LE(end)).toBe(0x06054b50);
  const files = new Map<string, Buffer>();
  let at = bytes.readUInt32LE(end + 16);
  for (let k = 0; k < bytes.readUInt16LE(end + 10); k++) {
    const size = bytes.readUInt32LE(at + 24);
    const length = bytes.readUInt16LE(at + 28);
    const name = bytes.toString('utf8', at + 46, at + 46 + length);
    const start = bytes.readUInt32LE(at + 42) + 30 + length;
    files.set(name, bytes.subarray(start, start + size));
    at += 46 + length;
  }
  return files;
}

test.describe
  .serial('pictures for print', () => {
    let studio: OpenStudio;
    let page: Page;

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'paper', creature(5000));
      ({ page } = studio);
    });

    test.afterAll(() => studio.end());

    test('a picture larger than the canvas has no seams and a transparent ground', async () => {
      test.setTimeout(300_000);
      const large = await picture(page, '60-picture-2600.png', 2600, 1900);
      expect([large.width, large.height, large.channels]).toEqual([2600, 1900, 4]);
      const small = await picture(page, '61-picture-1300.png', 1300, 950);
      expect(pixel(large, 0, 0)).toEqual([0, 0, 0, 0]);
      expect(pixel(large, 1300, 950)[3]).toBe(255);
      const covered =
        large.pixels.filter((_, i) => i % 4 === 3 && large.pixels[i]! > 0).length / (2600 * 1900);
      expect(covered).toBeGreaterThan(0.1);
      expect(covered).toBeLessThan(0.8);
      // The large one has tile borders where the small one has none.
      const { mean, worstLine } = differenceOfHalf(large, small);
      expect(mean).toBeLessThan(1);
      expect(worstLine).toBeLessThan(6 * mean + 1);
    });

    test('a picture of 4000 × 3000 on a ground, with the legend', async () => {
      test.setTimeout(300_000);
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      await page.getByLabel('Colors').selectOption({ label: 'Mean curvature' });
      await page.locator('.legend').waitFor();
      const box = (await page.locator('canvas.picture').boundingBox())!;
      const legend = (await page.locator('.legend').boundingBox())!;
      const print = await picture(page, '62-print.png', 4000, 3000);
      expect([print.width, print.height]).toEqual([4000, 3000]);
      // The panel of the legend is opaque.
      const scale = 3000 / box.height;
      const x = Math.round((legend.x - box.x + 8) * scale);
      const y = Math.round((legend.y - box.y + legend.height / 2) * scale);
      expect(pixel(print, x, y)[3]).toBeGreaterThan(200);
      expect(pixel(print, 3999, 0)[3]).toBe(0);
      await page.getByLabel('Colors').selectOption({ index: 0 });
    });

    test('numbers that are no sizes are refused with the range', async () => {
      await page.getByRole('button', { name: 'File', exact: true }).click();
      await page.getByRole('button', { name: 'Picture for print…' }).click();
      const box = page.getByRole('dialog');
      await box.getByLabel('Width (pixels)').fill('5');
      await box.getByRole('button', { name: 'Save picture (PNG)' }).click();
      await expect(box.getByRole('alert')).toHaveText(
        'Width (pixels): must be a whole number from 16 to 20000, got “5”.',
      );
      await page.screenshot({ path: join(OUT, '63-picture-dialog.png') });
      await page.keyboard.press('Escape');
    });

    test('a turn is an archive of numbered frames, and a video', async () => {
      test.setTimeout(300_000);
      const choices = { ...sides(160, 120), 'Frames of a turn': '12', 'Seconds of the video': '1' };
      const archive = await make(page, 'Save frames (PNG in a ZIP)', 'turn.zip', choices);
      const frames = unpack(readFileSync(archive));
      expect([...frames.keys()]).toEqual(
        Array.from({ length: 12 }, (_, k) => `creature-5000-${String(k).padStart(2, '0')}.png`),
      );
      const first = readFileSync(await make(page, 'Save picture (PNG)', 'first.png'));
      expect(frames.get('creature-5000-00.png')!.equals(first), 'the first frame is the view').toBe(true);
      expect(new Set([...frames.values()].map((frame) => frame.toString('base64'))).size).toBe(12);
      const video = readFileSync(await make(page, 'Save video (WebM)', 'turn.webm'));
      expect(video.readUInt32BE(0)).toBe(0x1a45dfa3);
      expect(video.includes('V_VP9') || video.includes('V_VP8')).toBe(true);
    });

    test('the recipe makes the same picture again', async () => {
      test.setTimeout(300_000);
      await setSlider(page, 1, 160);
      await waitUntilSaved(page);
      const edit = await currentEdit(page);
      const before = readFileSync(await make(page, 'Save picture (PNG)', 'again-1.png', sides(400, 300)));
      const recipe = readFileSync(
        await make(page, 'Save recipe of the picture', 'again.picture.json'),
        'utf8',
      );
      await setSlider(page, 1, 20);
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      await page.getByRole('button', { name: 'Right', exact: true }).click();
      await waitUntilSaved(page);
      const other = readFileSync(await make(page, 'Save picture (PNG)', 'again-2.png', sides(300, 300)));
      expect(other.equals(before)).toBe(false);
      await dropFile(page, 'again.picture.json', recipe);
      const box = page.getByRole('dialog');
      await expect(box.getByLabel('Height (pixels)')).toHaveValue('300');
      await expect(box.getByLabel('Width (pixels)')).toHaveValue('400');
      await page.keyboard.press('Escape');
      await waitUntilSaved(page);
      expect((await currentEdit(page)).layers[0]!.gains).toEqual(edit.layers[0]!.gains);
      const after = readFileSync(await make(page, 'Save picture (PNG)', 'again-3.png'));
      expect(after.equals(before), 'the same bytes').toBe(true);
      await dropFile(page, 'bad.picture.json', '{"picture": 1}');
      await expect(page.locator('.toasts')).toContainText('bad.picture.json must be the recipe of a picture');
      const foreign = recipe.replace(/"n_vertices": \d+/, '"n_vertices": 7');
      await dropFile(page, 'other.picture.json', foreign);
      await expect(page.locator('.toasts')).toContainText('with 7 vertices, and the open shape has 4948');
    });

    test('a cloud has no seams between its tiles', async () => {
      test.setTimeout(300_000);
      const rows: string[] = [];
      for (let i = 0; i < 90; i++)
        for (let j = 0; j < 90; j++) rows.push(`${i / 45 - 1} ${j / 45 - 1} ${0.2 * Math.sin(i / 9)}`);
      const path = join(studio.folder, 'sheet.xyz');
      writeFileSync(path, `${rows.join('\n')}\n`);
      await openFile(page, path);
      await page.locator('.tab.here', { hasText: 'sheet.xyz' }).waitFor();
      await waitForBands(page, 3);
      const large = await picture(page, '64-cloud-2400.png', 2400, 1800);
      const small = await picture(page, '65-cloud-1200.png', 1200, 900);
      const { mean, worstLine } = differenceOfHalf(large, small);
      expect(mean).toBeLessThan(4);
      expect(worstLine).toBeLessThan(6 * mean + 2);
    });

    test('the panes of a volume are enlarged', async () => {
      const path = join(studio.folder, 'head.nii.gz');
      execFileSync(ADWAVE, ['sample', 'head', '--quiet', '-o', path]);
      await openFile(page, path);
      await page.locator('.tab.here', { hasText: 'head.nii.gz' }).waitFor();
      await page.waitForTimeout(1500);
      const choices = { 'Width (pixels)': '3000' };
      const panes = decodePng(readFileSync(await make(page, 'Save picture (PNG)', '66-panes.png', choices)));
      expect(panes.width).toBe(3000);
      expect(pixel(panes, 2, 2)[3]).toBe(0);
      const values = new Set(panes.pixels.filter((_, i) => i % 4 === 0));
      expect(values.size, 'many gray values').toBeGreaterThan(50);
    });
  });
