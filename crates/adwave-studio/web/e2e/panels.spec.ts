/** Panels for everyone: rules of axe, tabs by keys, targets for fingers, and words that fit their places. */

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { type Browser, expect, type Page, test } from '@playwright/test';
import {
  collectErrors,
  type OpenStudio,
  openStudio,
  setSlider,
  useTestBuild,
  waitForBands,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { creature, OUT } from './support/studio-server';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Rules of axe that the page breaks, with the elements. */
async function findings(page: Page): Promise<string[]> {
  return page.evaluate(async () => {
    const { axe } = window as unknown as {
      axe: { run(): Promise<{ violations: { id: string; nodes: { html: string }[] }[] }> };
    };
    const { violations } = await axe.run();
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`);
  });
}

/** Buttons, fields and selects that can be seen, of which `isBad` is true, by their words. */
const controls = (page: Page, bad: 'small' | 'overflowing'): Promise<string[]> =>
  page.evaluate((bad) => {
    const dialog = document.querySelector('dialog[open]');
    const list = (dialog ?? document).querySelectorAll<HTMLElement>(
      'button, select, input[type=text], .check',
    );
    return [...list]
      .filter((element) => {
        const { width, height } = element.getBoundingClientRect();
        if (width === 0 || getComputedStyle(element).pointerEvents === 'none') return false;
        if (bad === 'small') return Math.round(width) < 40 || Math.round(height) < 40;
        const right = element.parentElement!.getBoundingClientRect().right;
        return (
          !element.matches('select, .tab *, .target *, .name') &&
          (element.scrollWidth > element.clientWidth || element.getBoundingClientRect().right > right + 1)
        );
      })
      .map((element) => `${element.getAttribute('aria-label') ?? element.textContent} ${element.className}`);
  }, bad);

test.describe('panels', () => {
  let studio: OpenStudio;
  let page: Page;
  const tab = (name: string) => page.getByRole('tab', { name, exact: true });

  /** Opens the page on a narrow touch screen. */
  async function openPhone(browser: Browser): Promise<Page> {
    const viewport = { width: 390, height: 844 };
    const context = await browser.newContext({ viewport, hasTouch: true, isMobile: true });
    await useTestBuild(context);
    const phone = await context.newPage();
    await phone.addInitScript(AXE);
    collectErrors(phone, studio.failures, 'phone');
    await phone.goto(studio.server.url);
    await waitUntilReady(phone);
    return phone;
  }

  test.beforeAll(async ({ browser }) => {
    studio = await openStudio(browser, 'panels', creature(5000));
    ({ page } = studio);
    await page.addInitScript(AXE);
    await page.reload();
    await waitUntilReady(page);
    await waitForBands(page);
  });

  test.afterAll(() => studio.end());

  test('panels are tabs, which arrow keys choose', async () => {
    await tab('Layers').focus();
    await page.keyboard.press('ArrowRight');
    await expect(tab('Brush')).toBeFocused();
    await expect(tab('Brush')).toHaveAttribute('aria-selected', 'true');
    await expect(page.getByRole('tabpanel', { name: 'Brush' })).toBeVisible();
    await page.keyboard.press('ArrowLeft');
    await page.keyboard.press('ArrowLeft');
    await expect(page.getByRole('tabpanel', { name: 'View' })).toBeVisible();
    await page.keyboard.press('Home');
    await expect(page.getByRole('tabpanel', { name: 'Layers' })).toBeVisible();
    await expect(page.getByRole('tabpanel')).toHaveCount(1);
  });

  test('a brush that is off has nothing chosen', async () => {
    await tab('Brush').click();
    const panel = page.getByRole('tabpanel', { name: 'Brush' });
    const pressed = panel.locator('[aria-pressed=true]:visible');
    await expect(pressed).toHaveCount(0);
    await expect(panel.getByText('Paint', { exact: true })).toHaveCount(1);
    await page.screenshot({ path: join(OUT, '42-brush-off.png') });
    await panel.getByRole('button', { name: 'Erase' }).click();
    await expect(pressed).toHaveText(['Smooth', 'Erase']);
    await panel.getByRole('button', { name: 'Paint' }).click();
    await page.keyboard.press('b');
    await expect(pressed).toHaveCount(0);
  });

  test('exactly one tool is active beside the picture, and the cursor shows it', async ({ browser }) => {
    const bar = page.getByRole('group', { name: 'Pointer' });
    const expectTool = async (name: RegExp, cursor: string) => {
      await expect(bar.locator('[aria-pressed=true]')).toHaveCount(1);
      await expect(bar.getByRole('button', { name })).toHaveAttribute('aria-pressed', 'true');
      await expect(page.locator('canvas.picture')).toHaveCSS('cursor', cursor);
    };
    await expectTool(/^Rotate/, 'auto');
    await bar.getByRole('button', { name: /^Brush/ }).click();
    await expectTool(/^Brush/, 'crosshair');
    await bar.getByRole('button', { name: /^Grab/ }).click();
    await expectTool(/^Grab/, 'grab');
    await page.screenshot({ path: join(OUT, '52-tools.png') });
    await page.keyboard.press('b');
    await expectTool(/^Brush/, 'crosshair');
    await page.keyboard.press('Escape');
    await expectTool(/^Rotate/, 'auto');
    const phone = await openPhone(browser);
    await expect(phone.locator('.toasts'), 'the first visit').toContainText('Drag the shape');
    await phone.screenshot({ path: join(OUT, '53-first-visit-390.png') });
    await phone.reload();
    await waitUntilReady(phone);
    await expect(phone.locator('.toasts'), 'the second visit').not.toContainText('Drag the shape');
    await phone.context().close();
  });

  for (const theme of ['light', 'dark']) {
    test(`axe finds nothing in any panel, ${theme}`, async ({ browser }) => {
      if (theme === 'dark') await page.getByRole('button', { name: 'Light or dark' }).click();
      await setSlider(page, 1, 150);
      await page.getByRole('button', { name: /^Mute/ }).first().click();
      for (const name of ['Layers', 'View', 'Brush']) {
        await tab(name).click();
        expect.soft(await findings(page), name).toEqual([]);
      }
      await page.keyboard.press('b');
      expect.soft(await findings(page), 'the brush is on').toEqual([]);
      await page.keyboard.press('p');
      expect.soft(await findings(page), 'grabbing').toEqual([]);
      await page.keyboard.press('p');
      await tab('Layers').click();
      for (const kind of ['ball', 'box', 'half-space', 'field']) {
        await page.locator('#layers select').first().selectOption(kind);
        await page.waitForTimeout(300);
        expect.soft(await findings(page), kind).toEqual([]);
      }
      await tab('View').click();
      await page.getByLabel('Colors').selectOption('change');
      await page.getByText('Features', { exact: true }).click();
      await page.locator('.clip, .field').getByRole('button', { name: 'x', exact: true }).click();
      await page.locator('summary', { hasText: 'Camera' }).click();
      await page.keyboard.press('s');
      await page.waitForTimeout(500);
      expect.soft(await findings(page), 'colors, features and a clip').toEqual([]);
      await page.keyboard.press('s');
      for (const name of ['File', 'Tools']) {
        await page.getByRole('button', { name, exact: true }).click();
        expect.soft(await findings(page), name).toEqual([]);
        await page.keyboard.press('Escape');
      }
      await page.keyboard.press('?');
      expect.soft(await findings(page), 'keys').toEqual([]);
      await page.keyboard.press('Escape');
      await page.reload();
      await waitUntilReady(page);
      if (theme === 'light') return;
      const phone = await openPhone(browser);
      await phone.emulateMedia({ colorScheme: 'dark' });
      for (const name of ['Bands', 'Layers', 'Brush', 'View']) {
        await phone.getByRole('tab', { name, exact: true }).tap();
        expect.soft(await findings(phone), `${name} on a phone`).toEqual([]);
      }
      await phone.context().close();
    });
  }

  test('no words leave their button, on wide and narrow screens', async ({ browser }) => {
    const phone = await openPhone(browser);
    for (const target of [page, phone]) {
      for (const name of ['File', 'Tools']) {
        if (target === phone && name === 'Tools')
          await phone.getByRole('button', { name: 'File', exact: true }).click();
        await target.getByRole('button', { name, exact: true }).click();
        await target.screenshot({ path: join(OUT, `43-${name}-${target === phone ? 390 : 1200}.png`) });
        expect.soft(await controls(target, 'overflowing'), name).toEqual([]);
        await target.keyboard.press('Escape');
      }
      for (const name of ['Layers', 'Brush', 'View']) {
        await target.getByRole('tab', { name, exact: true }).click();
        expect.soft(await controls(target, 'overflowing'), name).toEqual([]);
      }
    }
    await phone.context().close();
  });

  test('a phone has targets of 40 px, widths that do not touch, and the state of saving', async ({
    browser,
  }) => {
    const phone = await openPhone(browser);
    for (const name of ['Layers', 'Brush', 'View', 'Bands']) {
      await phone.getByRole('tab', { name, exact: true }).tap();
      expect.soft(await controls(phone, 'small'), name).toEqual([]);
      await expect(phone.getByText(/\([BP]\)/), 'a phone has no such keys').toHaveCount(0);
      await phone.screenshot({ path: join(OUT, `44-${name}-390.png`) });
    }
    await expect(phone.getByRole('button', { name: /^Keyboard shortcuts/ })).toBeInViewport({ ratio: 1 });
    await expect(phone.getByRole('button', { name: 'Open a file' })).toBeInViewport({ ratio: 1 });
    const gaps = (target: Page) =>
      target.locator('.sigma').evaluateAll((labels) => {
        const boxes = labels
          .filter((label) => getComputedStyle(label).visibility === 'visible')
          .map((label) => label.getBoundingClientRect());
        return boxes.slice(1).map((box, i) => box.left - boxes[i]!.right);
      });
    expect(Math.min(...(await gaps(phone)))).toBeGreaterThanOrEqual(3);
    await phone.getByRole('button', { name: 'Bands', exact: true }).tap();
    await phone.getByLabel('Choose bands').selectOption('lengths');
    await phone
      .getByLabel(/^Widths/)
      .fill('0.0212, 0.0313, 0.0414, 0.0515, 0.0616, 0.0717, 0.0818, 0.1019, 0.1223');
    await phone.getByRole('button', { name: 'Apply', exact: true }).tap();
    await waitForBands(phone, 9);
    await phone.waitForTimeout(200);
    expect(Math.min(...(await gaps(phone)))).toBeGreaterThanOrEqual(3);
    await phone.screenshot({ path: join(OUT, '45-widths-390.png') });
    await waitUntilSaved(phone);
    await expect(phone.locator('.saving')).toBeInViewport({ ratio: 1 });
    await expect(phone.locator('.saving')).toHaveText('Edit saved');
    await phone.context().close();
  });
});
