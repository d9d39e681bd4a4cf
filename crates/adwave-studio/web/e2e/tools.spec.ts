/** Regions drawn by hand, comparison with other methods, the report, and the exported HTML file. */

import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { expect, type Page, test } from '@playwright/test';
import {
  chooseRegion,
  coverage,
  currentEdit,
  type OpenStudio,
  openStudio,
  pictureFrame,
  setSlider,
  waitUntilSaved,
} from './support/page';
import { decodePng, deviation } from './support/png';
import { OUT } from './support/studio-server';

const lastRegion = async (page: Page) => (await currentEdit(page)).layers.at(-1)!.region;

/** Standard deviation of the colors of a screenshot within an element. */
async function screenshotDeviation(page: Page, name: string, selector: string): Promise<number> {
  const bytes = await page.screenshot({ path: join(OUT, name) });
  return deviation(decodePng(bytes), (await page.locator(selector).boundingBox())!);
}

const openTools = (page: Page) => page.getByRole('button', { name: 'Tools', exact: true }).click();
const openFileMenu = (page: Page) => page.getByRole('button', { name: 'File', exact: true }).click();

test.describe
  .serial('tools', () => {
    let studio: OpenStudio;
    let page: Page;

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'tools');
      ({ page } = studio);
    });

    test.afterAll(() => studio.end());

    test('a line over the surface is grown, shrunk, blurred and undone', async () => {
      const { x, y, size } = await pictureFrame(page);
      await page.keyboard.press('l');
      await chooseRegion(page, 'stroke');
      for (const k of [-1, 0, 1]) {
        const before = JSON.stringify(await lastRegion(page));
        await page.mouse.click(x + 0.06 * size * k, y);
        for (let i = 0; i < 100 && JSON.stringify(await lastRegion(page)) === before; i++)
          await page.waitForTimeout(30);
      }
      await page.keyboard.press('Enter');
      await waitUntilSaved(page);
      const region = await lastRegion(page);
      expect(region, 'a line of three points').toMatchObject({ stroke: { path: [{}, {}, {}] } });
      const line = await coverage(page);
      await page.keyboard.press('g');
      await waitUntilSaved(page);
      const grown = await coverage(page);
      expect(line).toBeGreaterThan(0);
      expect(grown, 'growing covers more').toBeGreaterThan(line);
      await page.keyboard.press('Shift+g');
      await page.keyboard.press('Shift+g');
      await waitUntilSaved(page);
      expect(await coverage(page), 'shrinking covers less').toBeLessThan(grown);
      await page.keyboard.press('u');
      await waitUntilSaved(page);
      expect(await lastRegion(page), 'the region is blurred').toHaveProperty('blurred');
      await page.screenshot({ path: join(OUT, '15-regions.png') });
      for (let i = 0; i < 5; i++) await page.keyboard.press('Control+z');
      expect(await lastRegion(page), 'everything is undone').toBeNull();
    });

    test('regions by a computed field and by a connected part', async () => {
      const { x, y } = await pictureFrame(page);
      await chooseRegion(page, 'field');
      for (let i = 0; i < 200 && !(await lastRegion(page)); i++) await page.waitForTimeout(50);
      expect(await lastRegion(page)).toMatchObject({ field: { name: 'saliency' } });
      await waitUntilSaved(page);
      expect(await coverage(page), 'the field covers something').toBeGreaterThan(0);
      await chooseRegion(page, 'component');
      await page.mouse.click(x, y);
      await waitUntilSaved(page);
      const nVertices = await page.evaluate(async () => (await window.studio.mask()).length);
      expect(await coverage(page), 'the part is the whole shape').toBe(255 * nVertices);
      await page.keyboard.press('Escape');
    });

    test('other methods are compared at equal roughness', async () => {
      await setSlider(page, 0, 0);
      await setSlider(page, 1, 20);
      await waitUntilSaved(page);
      for (const [name, heading] of [
        ['Taubin', 'Taubin'],
        ['Manifold harmonics', 'Harmonics'],
      ] as const) {
        await openTools(page);
        await page.getByRole('button', { name, exact: true }).click();
        await page.locator(`.comparison:not([hidden]) th:text-is("${heading}")`).waitFor();
        const cells = await page.locator('.comparison tbody tr').first().locator('td').allTextContents();
        const ratio = Number(cells[0]) / Number(cells[1]);
        expect(Math.abs(ratio - 1), `roughness of ${name}: ${cells}`).toBeLessThan(0.02);
        await screenshotDeviation(page, `16-${name.toLowerCase().replace(' ', '-')}.png`, 'main.stage');
      }
      await page.locator('.comparison button').click();
      expect(await page.locator('.comparison').isHidden(), 'the comparison ends').toBe(true);
      await page.keyboard.press('s');
    });

    test('the report is a page with pictures', async () => {
      await openTools(page);
      await page.getByRole('button', { name: 'Create report' }).click();
      const link = page.getByRole('link', { name: 'Open report' });
      await link.waitFor();
      const [tab] = await Promise.all([page.context().waitForEvent('page'), link.click()]);
      await tab.waitForLoadState();
      expect(await tab.locator('h2').count()).toBeGreaterThan(3);
      expect(await tab.locator('img, svg').count()).toBeGreaterThan(3);
      await tab.screenshot({ path: join(OUT, '17-report.png') });
      await tab.close();
      await page.keyboard.press('Escape');
    });

    test('the exported file works from a disk without a network', async ({ browser }) => {
      const { failures } = studio;
      await openFileMenu(page);
      const [download] = await Promise.all([
        page.waitForEvent('download'),
        page.getByRole('button', { name: 'Page with sliders (HTML)' }).click(),
      ]);
      const file = join(OUT, download.suggestedFilename());
      await download.saveAs(file);
      expect(readFileSync(file, 'utf8')).toContain('no third-party code');
      for (const [width, height, colorScheme] of [
        [1200, 900, 'light'],
        [390, 844, 'dark'],
      ] as const) {
        const context = await browser.newContext({ viewport: { width, height }, colorScheme, offline: true });
        const exported = await context.newPage();
        exported.on('pageerror', (e) => failures.push(`the file: ${e.message}`));
        exported.on('console', (m) => m.type() === 'error' && failures.push(`the file: ${m.text()}`));
        exported.on('request', (r) => {
          if (!/^(file|data|blob):/.test(r.url())) failures.push(`the file requests ${r.url()}`);
        });
        await exported.goto(pathToFileURL(file).href);
        await exported.locator('.bands label').first().waitFor();
        await exported.waitForTimeout(500);
        const before = await exported.locator('canvas').screenshot();
        const sd = await screenshotDeviation(exported, `18-page-${width}-${colorScheme}.png`, 'canvas');
        expect(sd, 'the file draws').toBeGreaterThan(5);
        const first = exported.locator('.bands input').first();
        expect(await first.inputValue(), 'the file has the edit').toBe('0');
        await exported.locator('.bands input').nth(4).fill('180');
        await exported.waitForTimeout(500);
        const after = await exported.locator('canvas').screenshot();
        expect(before.equals(after), 'its sliders change the shape').toBe(false);
        const scrollWidth = await exported.evaluate(() => document.documentElement.scrollWidth);
        expect(scrollWidth, 'nothing is wider than the window').toBeLessThanOrEqual(width);
        await context.close();
      }
    });
  });
