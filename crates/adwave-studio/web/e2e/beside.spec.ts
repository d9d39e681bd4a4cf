/** Two tabs side by side: one camera, and the distances that `adwave diff` measures. */

import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import { drag, openFile, openStudio, setSlider, waitForBands, waitUntilSaved } from './support/page';
import { decodePng, deviation } from './support/png';
import { ADWAVE, creature, OUT } from './support/studio-server';

/** Opens the other tab beside the present one. */
async function showBeside(page: Page, name: string): Promise<void> {
  await page.getByRole('button', { name: 'Tools', exact: true }).click();
  await page.getByRole('dialog').getByRole('button', { name, exact: true }).click();
  await page.locator('.beside-labels small').waitFor();
}

test('two tabs are shown with one camera and their distances', async ({ browser }) => {
  const studio = await openStudio(browser, 'beside');
  const { page, folder } = studio;
  const shape = creature(20_000);
  const smooth = join(folder, 'smooth.ply');
  execFileSync(ADWAVE, ['filter', shape, '--gains', '0,0,0,0,1', '--quiet', '-o', smooth]);
  const measured = JSON.parse(
    execFileSync(ADWAVE, ['diff', shape, smooth, '--by', 'closest', '--json', '--quiet']).toString(),
  );
  try {
    await openFile(page, smooth);
    await page.locator('.tab.here', { hasText: 'smooth.ply' }).waitFor();
    await page.locator('.tab', { hasText: 'creature' }).getByRole('button').first().click();
    await page.locator('.tab.here', { hasText: 'creature' }).waitFor();
    await waitForBands(page);
    await showBeside(page, 'smooth.ply');
    const { rms, greatest } = measured.difference ?? measured;
    const figures = (await page.locator('.beside-labels small').textContent())!;
    const shown = figures
      .match(/RMS (\S+), max (\S+)/)!
      .slice(1)
      .map(Number);
    expect(Math.abs(shown[0]! / rms - 1), `${figures} and ${rms}`).toBeLessThan(0.005);
    expect(Math.abs(shown[1]! / greatest - 1), `${figures} and ${greatest}`).toBeLessThan(0.005);
    await expect(page.locator('.legend')).toContainText('Distance from smooth.ply');
    await expect(page.locator('.legend .histogram')).toBeVisible();
    await page.waitForTimeout(400);
    // Both halves have a shape, and both turn with a drag over the second one.
    const area = (await page.locator('canvas.picture').boundingBox())!;
    const half = (k: number) => ({ ...area, x: area.x + (k * area.width) / 2, width: area.width / 2 });
    const picture = async (name: string) => decodePng(await page.screenshot({ path: join(OUT, name) }));
    const before = await picture('28-beside.png');
    for (const k of [0, 1]) expect(deviation(before, half(k))).toBeGreaterThan(5);
    const [x, y] = [area.x + 0.75 * area.width, area.y + 0.5 * area.height];
    await drag(page, [
      [x, y],
      [x + 60, y + 10],
      [x + 140, y + 10],
    ]);
    await page.waitForTimeout(400);
    const turned = await picture('29-beside-turned.png');
    const differs = (k: number) => {
      const { x: left, y: top, width, height } = half(k);
      let n = 0;
      for (let r = 0; r < height; r += 3)
        for (let c = 0; c < width; c += 3) {
          const i = before.channels * (Math.floor(top + r) * before.width + Math.floor(left + c));
          if (Math.abs(before.pixels[i]! - turned.pixels[i]!) > 20) n++;
        }
      return n;
    };
    for (const k of [0, 1]) expect(differs(k), `half ${k}`).toBeGreaterThan(300);
    // An edit is measured again.
    for (const j of [0, 1, 2, 3]) await setSlider(page, j, 0);
    await waitUntilSaved(page);
    await expect
      .poll(async () =>
        Number(
          (await page.locator('.beside-labels small').textContent())!
            .match(/RMS (\S+),/)![1]!
            .replace('−', '-'),
        ),
      )
      .toBeLessThan(0.1 * rms);
    await page.setViewportSize({ width: 390, height: 844 });
    await page.waitForTimeout(500);
    await page.screenshot({ path: join(OUT, '30-beside-390.png') });
    await page.setViewportSize({ width: 1200, height: 900 });
    await page.getByRole('button', { name: 'End side by side' }).click();
    await expect(page.locator('.beside-labels')).toBeHidden();
    await page.waitForTimeout(300);
  } finally {
    await studio.end();
  }
});
