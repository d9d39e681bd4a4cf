/** The picture: smooth edges at rest, smooth shading and figures during a pull, and sliders that belong to what is shown. */

import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  type OpenStudio,
  openStudio,
  pictureFrame,
  setSlider,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { decodePng, type PngImage } from './support/png';
import { creature, OUT } from './support/studio-server';

/** Milliseconds after which the picture is at rest. */
const REST = 1000;

const takePicture = async (page: Page, name: string): Promise<PngImage> => {
  const bytes = await page.locator('canvas.picture').screenshot();
  writeFileSync(join(OUT, name), bytes);
  return decodePng(bytes);
};

/** Pixels of the picture per pixel of the page. */
const pixelRatio = (page: Page) =>
  page.locator('canvas.picture').evaluate((canvas: HTMLCanvasElement) => canvas.width / canvas.clientWidth);

/** Share of the rows whose last pixel of the shape is a blend of its color and that of the paper. */
function smoothShare({ width, height, channels, pixels }: PngImage): number {
  const at = (x: number, y: number) => pixels[(y * width + x) * channels]!;
  const paper = at(width - 4, height >> 1);
  let [rows, smooth] = [0, 0];
  // Below the readouts, and above the scale.
  for (let y = 110; y < height - 100; y++) {
    let x = width - 4;
    while (x > width / 2 && Math.abs(at(x, y) - paper) < 6) x--;
    if (x <= width / 2) continue;
    rows++;
    if (Math.abs(at(x, y) - paper) < 0.75 * Math.abs(at(x - 1, y) - paper)) smooth++;
  }
  return smooth / rows;
}

/** Mean change of the slope from pixel to pixel along the rows of the middle of the picture: large on facets. */
function roughness({ width, height, channels, pixels }: PngImage): number {
  const at = (x: number, y: number) => pixels[(y * width + x) * channels]!;
  let [sum, n] = [0, 0];
  for (let y = height >> 2; y < 0.75 * height; y++) {
    for (let x = width >> 2; x < 0.75 * width; x++) {
      const [a, b, c] = [at(x - 1, y), at(x, y), at(x + 1, y)];
      if (Math.min(a, b, c) > 225) continue;
      sum += Math.abs(a - 2 * b + c);
      n++;
    }
  }
  return sum / n;
}

test.describe('a small shape', () => {
  let studio: OpenStudio;
  let page: Page;

  test.beforeAll(async ({ browser }) => {
    studio = await openStudio(browser, 'picture', creature(20_000));
    ({ page } = studio);
  });

  test.afterAll(() => studio.end());

  test('has smooth edges at rest, also without a GPU, and fewer pixels while it moves', async () => {
    await page.waitForTimeout(REST);
    expect(await pixelRatio(page)).toBe(2);
    expect(smoothShare(await takePicture(page, '46-rest.png'))).toBeGreaterThan(0.5);
    const { x, y } = await pictureFrame(page);
    const least = page.evaluate(async () => {
      const canvas = document.querySelector<HTMLCanvasElement>('canvas.picture')!;
      let least = Number.POSITIVE_INFINITY;
      for (let k = 0; k < 60; k++) {
        await new Promise((resolve) => requestAnimationFrame(resolve));
        least = Math.min(least, canvas.width / canvas.clientWidth);
      }
      return least;
    });
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 4, y);
    await page.mouse.move(x + 8, y);
    if (/llvmpipe|swiftshader/i.test(await page.evaluate(() => window.studio.renderer)))
      expect(await least).toBe(1);
    await page.mouse.up();
    await page.waitForTimeout(REST);
    expect(await pixelRatio(page)).toBe(2);
  });

  test('has figures that are legible over it, in both themes', async () => {
    const luminance = (rgb: readonly number[]) => {
      const [r, g, b] = rgb.map((c) =>
        c / 255 <= 0.04 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4,
      );
      return 0.2126 * r! + 0.7152 * g! + 0.0722 * b!;
    };
    const { x, y } = await pictureFrame(page);
    await page.mouse.move(x, y);
    for (let k = 0; k < 8; k++) await page.mouse.wheel(0, -150);
    for (const theme of ['light', 'dark']) {
      await page.waitForTimeout(REST);
      const label = page.locator('.readouts dt').last();
      const color = await label.evaluate((dt) => getComputedStyle(dt).color.match(/\d+/g)!.map(Number));
      const box = (await label.locator('..').boundingBox())!;
      // The left margin of the text, without round corners.
      const clip = { x: Math.ceil(box.x) + 1, y: Math.ceil(box.y) + 5, width: 2, height: 20 };
      const { channels, pixels } = decodePng(await page.screenshot({ clip }));
      for (let k = 0; k < pixels.length; k += channels) {
        const behind = luminance([...pixels.subarray(k, k + 3)]);
        const [low, high] = [behind, luminance(color)].sort((a, b) => a - b) as [number, number];
        expect((high + 0.05) / (low + 0.05), theme).toBeGreaterThan(4.5);
      }
      await page.screenshot({ path: join(OUT, `55-figures-${theme}.png`) });
      await page.getByRole('button', { name: 'Light or dark' }).click();
    }
    await page.keyboard.press('f');
  });

  test('enables its sliders with the edit that is restored', async () => {
    await setSlider(page, 2, 160);
    await waitUntilSaved(page);
    await page.addInitScript(() => {
      const look = () => {
        if (document.querySelector('.band input.gain:enabled'))
          sessionStorage.setItem('moved-at-first', document.querySelector('.readouts')!.textContent!);
        else requestAnimationFrame(look);
      };
      look();
    });
    await page.reload();
    await waitUntilReady(page);
    await page.waitForTimeout(100);
    const first = await page.evaluate(() => sessionStorage.getItem('moved-at-first'));
    expect(first, 'the displacement when the first slider was enabled').toMatch(/Max displacement0\.0/);
  });
});

test('a large shape that is pulled has smooth shading, and its displacement is told', async ({ browser }) => {
  const studio = await openStudio(browser, 'pulled', creature(60_000));
  const { page } = studio;
  try {
    // Its own detail is not to be taken for facets.
    await setSlider(page, 0, 0);
    await setSlider(page, 1, 0);
    await setSlider(page, 2, 0);
    await waitUntilSaved(page);
    await page.keyboard.press('p');
    const { x, y, size } = await pictureFrame(page);
    const told = async () =>
      (await page.locator('.readouts').textContent())!.match(/displacement([\d.]+)/)?.[1];
    const before = Number(await told());
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let k = 1; k <= 6; k++) await page.mouse.move(x + 0.02 * k * size, y - 0.03 * k * size);
    await expect.poll(async () => Number(await told())).toBeGreaterThan(before + 0.05);
    await page.waitForTimeout(50);
    await page.mouse.move(x + 0.121 * size, y - 0.18 * size);
    const during = await takePicture(page, '47-pulled.png');
    const meanwhile = Number(await told());
    await page.mouse.up();
    await waitUntilSaved(page);
    await page.waitForTimeout(REST);
    const after = await takePicture(page, '48-released.png');
    expect(meanwhile / Number(await told())).toBeCloseTo(1, 1);
    // The picture of the coarse version lacks fine detail; facets would make it rougher than the exact one.
    expect(roughness(during)).toBeLessThan(0.95 * roughness(after));
  } finally {
    await studio.end();
  }
});

/** A near square before a far one, of white points, as a PLY of text. */
function twoSheets(): string {
  const rows: string[] = [];
  const sheet = (n: number, half: number, z: number) => {
    for (let i = 0; i <= n; i++)
      for (let j = 0; j <= n; j++)
        rows.push(`${half * ((2 * i) / n - 1)} ${half * ((2 * j) / n - 1)} ${z} 255 255 255`);
  };
  sheet(160, 1, 0);
  sheet(60, 0.3, 0.5);
  const properties = ['x', 'y', 'z'].map((name) => `property double ${name}`);
  const colors = ['red', 'green', 'blue'].map((name) => `property uchar ${name}`);
  const head = ['ply', 'format ascii 1.0', `element vertex ${rows.length}`, ...properties, ...colors];
  return [...head, 'end_header', ...rows, ''].join('\n');
}

test('points of a cloud are darker beside nearer ones', async ({ browser }) => {
  const path = join(OUT, 'two-sheets.ply');
  writeFileSync(path, twoSheets());
  const studio = await openStudio(browser, 'cloud', path);
  const { page } = studio;
  try {
    await page.keyboard.press('1');
    await page.waitForTimeout(REST);
    const { width, height, channels, pixels } = await takePicture(page, '54-cloud.png');
    const row = Array.from({ length: width >> 1 }, (_, i) => {
      // Mean of a few rows, of which some lie between points.
      let sum = 0;
      for (let dy = 0; dy < 40; dy++)
        sum += pixels[((height >> 1) + dy) * width * channels + (i + (width >> 1)) * channels]!;
      return sum / 40;
    });
    const onSheet = row.slice(0, 60).reduce((sum, x) => sum + x, 0) / 60;
    expect(Math.min(...row.slice(0, 200)), 'the edge of the near sheet').toBeLessThan(0.8 * onSheet);
    expect(Math.min(...row.slice(0, 40)), 'no edge within the near sheet').toBeGreaterThan(0.93 * onSheet);
  } finally {
    await studio.end();
  }
});
