/** Smoke test of the committed production bundle, as the server embeds it. */

import { expect, test } from '@playwright/test';
import { collectErrors, expectNoFailures, openFile } from './support/page';
import { decodePng, deviation } from './support/png';
import { creature, killStudio, OUT, startStudio } from './support/studio-server';

for (const colorScheme of ['light', 'dark'] as const) {
  test(`the production bundle draws and edits (${colorScheme})`, async ({ browser }) => {
    const failures: string[] = [];
    const server = await startStudio(creature(20_000), `${OUT}/production-${colorScheme}-${Date.now()}`);
    try {
      const page = await browser.newPage({ viewport: { width: 1200, height: 900 }, colorScheme });
      collectErrors(page, failures);
      page.on('console', (m) => m.type() === 'error' && failures.push(`console: ${m.text()}`));
      await page.goto(server.url);
      const slider = page.locator('.band input.gain').first();
      await expect(slider).toBeEnabled({ timeout: 60_000 });
      await slider.focus();
      await page.keyboard.press('PageDown');
      await expect(page.locator('.saving')).toHaveText('Edit saved');
      const hasHooks = await page.evaluate(() => 'studio' in window);
      expect(hasHooks, 'window.studio exists in test builds only').toBe(false);
      const path = `${OUT}/production-${colorScheme}.png`;
      const box = (await page.locator('main.stage').boundingBox())!;
      expect(deviation(decodePng(await page.screenshot({ path })), box), 'the picture').toBeGreaterThan(5);
      await page.keyboard.press('Escape');
      await page.getByRole('button', { name: 'Keyboard shortcuts (?)' }).click();
      const link = page.getByRole('link', { name: 'Third-party notices' });
      const [notices] = await Promise.all([page.context().waitForEvent('page'), link.click()]);
      await expect(notices.locator('body')).toContainText('three.js authors');
      expectNoFailures(failures);
    } finally {
      await killStudio(server);
    }
  });
}

test('an unknown file is refused with a link to the supported formats', async ({ page }) => {
  const server = await startStudio(creature(20_000), `${OUT}/formats-${Date.now()}`);
  try {
    await page.goto(server.url);
    await expect(page.locator('.band input.gain').first()).toBeEnabled({ timeout: 60_000 });
    const buffer = Buffer.from('neither vertices nor faces');
    await openFile(page, { name: 'notes.doc', mimeType: 'text/plain', buffer });
    const message = page.locator('.toasts p');
    await expect(message).toContainText('notes.doc is not a shape adwave can read');
    await message.getByRole('button', { name: 'Supported formats' }).click();
    await expect(page.locator('dialog[open]')).toContainText('Wavefront OBJ');
  } finally {
    await killStudio(server);
  }
});

test('an outdated link is explained', async ({ page }) => {
  const server = await startStudio(creature(20_000), `${OUT}/link-${Date.now()}`);
  try {
    await page.goto(server.url.replace(/#.*/, '#old'));
    await expect(page.locator('.loading')).toHaveText(
      'This link is no longer valid. Open the latest link printed in the terminal.',
    );
  } finally {
    await killStudio(server);
  }
});
