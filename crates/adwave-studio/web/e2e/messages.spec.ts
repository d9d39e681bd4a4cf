/** Messages: they come with their cause, say what a preset does, and go when the cause has gone. */

import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import { chooseRegion, type OpenStudio, openStudio, pictureFrame, setSlider } from './support/page';
import { creature, OUT } from './support/studio-server';

/** Time within which a message goes, much shorter than the one for which it would be shown. */
const SOON = { timeout: 1500 };

test.describe('messages', () => {
  let studio: OpenStudio;
  let page: Page;
  const message = (words: string | RegExp) => page.locator('.toasts p', { hasText: words });

  test.beforeAll(async ({ browser }) => {
    studio = await openStudio(browser, 'messages', creature(5000));
    ({ page } = studio);
  });

  test.afterAll(() => studio.end());

  test('a refusal goes with the next value that holds', async () => {
    const number = page.locator('.band input.number').first();
    const enter = async (typed: string) => {
      await number.fill(typed);
      await number.press('Enter');
    };
    await enter('-1');
    await expect(message('Enter a gain')).toBeVisible();
    await enter('0.5');
    await expect(message('Enter a gain')).toBeHidden(SOON);
    await enter('-1');
    await expect(message('Enter a gain')).toBeVisible();
    await setSlider(page, 1, 60);
    await expect(message('Enter a gain')).toBeHidden(SOON);

    await page.getByRole('tab', { name: 'View' }).click();
    await page.getByLabel('Colors').selectOption('change');
    await expect(page.locator('.legend')).toBeVisible();
    await page.getByLabel('Lowest value').fill('9');
    await page.getByLabel('Lowest value').press('Enter');
    await expect(message('must be below')).toBeVisible();
    await page.getByLabel('Lowest value').fill('0');
    await page.getByLabel('Lowest value').press('Enter');
    await expect(message('must be below')).toBeHidden(SOON);
    await page.getByLabel('Colors').selectOption('none');
  });

  test('a request stays until it is met or withdrawn', async () => {
    await page.getByRole('tab', { name: 'Layers' }).click();
    await chooseRegion(page, 'ball');
    const choose = page.getByRole('button', { name: 'Choose center' });
    const request = message('Click the new center');
    await choose.click();
    await page.waitForTimeout(5500);
    await expect(request, 'it still waits for a click').toBeVisible();
    await page.keyboard.press('Escape');
    await expect(request).toBeHidden(SOON);
    await choose.click();
    await expect(request).toBeVisible();
    const { x, y } = await pictureFrame(page);
    await page.mouse.click(x, y);
    await expect(request).toBeHidden(SOON);
    await choose.click();
    await page.getByRole('button', { name: 'Add a layer (L)' }).click();
    await expect(request, 'the layer is no longer selected').toBeHidden(SOON);
  });

  test('a hint goes with the tool, and a lost shape with the view', async () => {
    await page.keyboard.press('b');
    await page.locator('#brush').getByRole('button', { name: 'Erase' }).click();
    const { x, y, size } = await pictureFrame(page);
    await page.mouse.click(x, y);
    await expect(message('nothing to erase')).toBeVisible();
    await page.keyboard.press('b');
    await expect(message('nothing to erase')).toBeHidden(SOON);

    await page.mouse.move(x + 0.6 * size, y - 0.4 * size);
    for (let k = 0; k < 25; k++) await page.mouse.wheel(0, -600);
    await expect(message('No part of the shape')).toBeVisible();
    await page.keyboard.press('f');
    await expect(message('No part of the shape')).toBeHidden(SOON);
  });

  test('a preset says what it does to the coarsest band, and the bars beside the sliders are named', async () => {
    await expect(page.getByText('Detail under the cursor', { exact: true })).toBeVisible();
    await page.getByLabel('Presets').selectOption({ label: 'Smooth' });
    await expect(page.locator('.band input.number').last()).toHaveValue('2.00');
    await expect(message(/coarsest, which is doubled/)).toBeVisible();
    const { x, y } = await pictureFrame(page);
    await page.mouse.move(x, y);
    await page.waitForTimeout(400);
    await page.screenshot({ path: join(OUT, '49-preset.png') });
    await page.getByRole('button', { name: 'Reset', exact: true }).click();
    await expect(message(/doubled/)).toBeHidden(SOON);
  });
});
