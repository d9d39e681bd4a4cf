/** The view of images and volumes: what is remembered over a reload, and the wipe between before and after. */

import { execFileSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import { collectErrors, expectNoFailures, setSlider, useTestBuild, waitUntilReady } from './support/page';
import { decodePng, encodePng, type PngImage } from './support/png';
import { ADWAVE, killStudio, OUT, type StudioServer, startStudio } from './support/studio-server';

async function open(page: Page, path: string, folder: string, failures: string[]): Promise<StudioServer> {
  const server = await startStudio(path, folder);
  await useTestBuild(page);
  collectErrors(page, failures);
  await page.goto(server.url);
  await waitUntilReady(page);
  await page.evaluate(() => window.studio.planes());
  return server;
}

/** Standard deviation of the differences of neighboring gray values, left and right of a column. */
function roughness({ width, height, channels, pixels }: PngImage, column: number): [number, number] {
  const sums = [0, 0];
  const counts = [0, 0];
  for (let y = 80; y < height - 80; y += 2) {
    for (let x = 40; x < width - 40; x++) {
      if (Math.abs(x - column) < 30) continue;
      const at = channels * (y * width + x);
      const side = x < column ? 0 : 1;
      sums[side]! += Math.abs(pixels[at]! - pixels[at + channels]!);
      counts[side]!++;
    }
  }
  return [sums[0]! / counts[0]!, sums[1]! / counts[1]!];
}

test('window, shading, place and zoom of a volume are there after a reload', async ({ page }) => {
  const folder = join(OUT, `grid-view-${Date.now()}`);
  mkdirSync(folder, { recursive: true });
  const path = join(folder, 'head.nii.gz');
  execFileSync(ADWAVE, ['sample', 'head', '--quiet', '-o', path]);
  const failures: string[] = [];
  const server = await open(page, path, folder, failures);
  try {
    const panel = page.getByRole('tabpanel', { name: 'View' });
    await panel.getByRole('button', { name: 'Color map', exact: true }).click();
    const numbers = panel.locator('input[type="text"]');
    await numbers.first().fill('12');
    await numbers.first().press('Enter');
    const pane = page.locator('.pane canvas').first();
    await pane.focus();
    for (let k = 0; k < 5; k++) await page.keyboard.press('ArrowRight');
    for (let k = 0; k < 4; k++) await page.keyboard.press('+');
    await page.waitForTimeout(600);
    const text = await panel.textContent();
    const pictures = () =>
      page
        .locator('.pane canvas')
        .evaluateAll((list) => list.map((canvas) => (canvas as HTMLCanvasElement).toDataURL()));
    const before = await pictures();
    expect(new Set(before).size).toBe(3);
    await page.screenshot({ path: join(OUT, '80-grid-before-reload.png') });
    await page.reload();
    await waitUntilReady(page);
    await page.evaluate(() => window.studio.planes());
    await page.waitForTimeout(600);
    await expect(panel.getByRole('button', { name: 'Color map', exact: true })).toHaveAttribute(
      'aria-pressed',
      'true',
    );
    await expect(numbers.first()).toHaveValue('12');
    expect(await panel.textContent()).toBe(text);
    await page.screenshot({ path: join(OUT, '81-grid-after-reload.png') });
    expect(await pictures(), 'the same pictures').toEqual(before);
    expectNoFailures(failures);
  } finally {
    await killStudio(server);
  }
});

test('a wipe shows an image before the edit on its left', async ({ page }) => {
  const folder = join(OUT, `grid-wipe-${Date.now()}`);
  mkdirSync(folder, { recursive: true });
  const path = join(folder, 'noise.png');
  let state = 1;
  const noise = () => {
    state = (Math.imul(state, 48271) >>> 0) % 2147483647;
    return 100 + (state % 100);
  };
  writeFileSync(
    path,
    encodePng(300, 200, () => {
      const gray = noise();
      return [gray, gray, gray];
    }),
  );
  const failures: string[] = [];
  const server = await open(page, path, folder, failures);
  try {
    for (const band of [0, 1, 2]) await setSlider(page, band, 0);
    await page.evaluate(() => window.studio.saved());
    await page.getByRole('button', { name: 'Wipe before/after (S)' }).click();
    const divider = page.getByRole('slider', { name: 'Wipe before/after (S)' });
    await expect(divider).toBeVisible();
    await page.waitForTimeout(400);
    const panes = page.locator('.grid-panes');
    const box = (await panes.boundingBox())!;
    const shot = async (name: string) => decodePng(await panes.screenshot({ path: join(OUT, name) }));
    const middle = await shot('82-grid-wipe.png');
    const [rough, smooth] = roughness(middle, Math.round(box.width / 2));
    expect(smooth).toBeLessThan(0.5 * rough);
    await divider.focus();
    for (let k = 0; k < 2; k++) await page.keyboard.press('PageDown');
    await expect(divider).toHaveAttribute('aria-valuenow', '30');
    await page.waitForTimeout(300);
    const moved = await shot('83-grid-wipe-moved.png');
    const [left, right] = roughness(moved, Math.round(0.3 * box.width));
    expect(right).toBeLessThan(0.5 * left);
    await page.keyboard.press('s');
    await expect(divider).toBeHidden();
    await page.waitForTimeout(300);
    const [whole, same] = roughness(await shot('84-grid-no-wipe.png'), Math.round(box.width / 2));
    expect(whole / same).toBeCloseTo(1, 0);
    expect(whole).toBeLessThan(0.5 * rough);
    expectNoFailures(failures);
  } finally {
    await killStudio(server);
  }
});
