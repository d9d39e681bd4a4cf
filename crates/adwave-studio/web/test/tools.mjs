/**
 * Regions by hand and the tools of a running studio: `node test/tools.mjs URL FOLDER`. Draws a line, grows it, compares with another method, makes
 * the report, and opens the page in one file from the disk, without a network.
 */

import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { launch, opened, report, stage } from './browser.mjs';
import { decodePng, deviation } from './png.mjs';

const [url, folder] = process.argv.slice(2);
const failures = [];
const check = (what, ok, detail = '') => {
  if (!ok) failures.push(detail === '' ? what : `${what}: ${JSON.stringify(detail)}`);
};
const browser = await launch();
const layers = (page) => page.evaluate(() => window.studio.state().layers);
const covered = (page) =>
  page.evaluate(async () => (await window.studio.mask()).reduce((sum, w) => sum + w, 0));
const kept = (page) => page.evaluate(() => window.studio.kept());
const slide = (page, band, value) =>
  page.evaluate(
    ([j, to]) => {
      const input = document.querySelectorAll('.band input.gain')[j];
      input.value = String(to);
      for (const type of ['input', 'change']) input.dispatchEvent(new Event(type, { bubbles: true }));
    },
    [band, value],
  );
/** Deviation of the colors of a picture within a box. */
const look = async (page, name, selector) =>
  deviation(
    decodePng(await page.screenshot({ path: join(folder, name) })),
    await page.locator(selector).boundingBox(),
  );

try {
  const page = await opened(browser, url, failures);
  const { x, y, size } = await stage(page);

  // A line over the surface, click by click.
  await page.keyboard.press('l');
  await page.locator('#layers select').first().selectOption('stroke');
  for (const k of [-1, 0, 1]) {
    const before = JSON.stringify((await layers(page)).at(-1).region);
    await page.mouse.click(x + 0.06 * size * k, y);
    for (let i = 0; i < 100 && JSON.stringify((await layers(page)).at(-1).region) === before; i++)
      await page.waitForTimeout(30);
  }
  await page.keyboard.press('Enter');
  await kept(page);
  check(
    'a line of three places',
    (await layers(page)).at(-1).region?.stroke?.path.length === 3,
    (await layers(page)).at(-1).region,
  );
  const line = await covered(page);
  await page.keyboard.press('g');
  await kept(page);
  const grown = await covered(page);
  check('grown is more', grown > line && line > 0, [line, grown]);
  await page.keyboard.press('Shift+g');
  await page.keyboard.press('Shift+g');
  await kept(page);
  check('shrunk is less', (await covered(page)) < grown);
  await page.keyboard.press('u');
  await kept(page);
  check(
    'blurred',
    'blurred' in (await layers(page)).at(-1).region,
    Object.keys((await layers(page)).at(-1).region),
  );
  await page.screenshot({ path: join(folder, '15-regions.png') });
  for (let i = 0; i < 5; i++) await page.keyboard.press('Control+z');
  check('all of it undone', (await layers(page)).at(-1).region === null, (await layers(page)).at(-1).region);

  // By a field that the shape gives itself, and in a connected part.
  await page.locator('#layers select').first().selectOption('field');
  for (let i = 0; i < 200 && !(await layers(page)).at(-1).region; i++) await page.waitForTimeout(50);
  check(
    'by a field',
    (await layers(page)).at(-1).region?.field?.name === 'saliency',
    (await layers(page)).at(-1).region,
  );
  await kept(page);
  check('which covers something', (await covered(page)) > 0);
  await page.locator('#layers select').first().selectOption('component');
  await page.mouse.click(x, y);
  await kept(page);
  const whole = await covered(page);
  check(
    'all of one part',
    whole === 255 * (await page.evaluate(async () => (await window.studio.mask()).length)),
    whole,
  );
  await page.keyboard.press('Escape');

  // Another method as smooth as the edit.
  await slide(page, 0, 0);
  await slide(page, 1, 20);
  await kept(page);
  for (const name of ['Taubin', 'Manifold harmonics']) {
    await page.getByRole('button', { name: 'File', exact: true }).click();
    await page.getByRole('button', { name, exact: true }).click();
    await page
      .locator(`.comparison:not([hidden]) th:text-is("${name === 'Taubin' ? name : 'harmonics'}")`)
      .waitFor();
    const cells = await page.locator('.comparison tbody tr').first().locator('td').allTextContents();
    check(`${name} is as rough`, Math.abs(cells[0] / cells[1] - 1) < 0.02, cells);
    await look(page, `16-${name.toLowerCase().replace(' ', '-')}.png`, 'main.stage');
  }
  await page.locator('.comparison button').click();
  check('the comparison ends', await page.locator('.comparison').isHidden());
  await page.keyboard.press('s');

  // The report.
  await page.getByRole('button', { name: 'File', exact: true }).click();
  await page.getByRole('button', { name: 'Make the report' }).click();
  const link = page.getByRole('link', { name: 'Open the report' });
  await link.waitFor();
  const [tab] = await Promise.all([page.context().waitForEvent('page'), link.click()]);
  await tab.waitForLoadState();
  check(
    'the report is a page',
    (await tab.locator('h2').count()) > 3 && (await tab.locator('img, svg').count()) > 3,
  );
  await tab.screenshot({ path: join(folder, '17-report.png') });
  await tab.close();
  await page.keyboard.press('Escape');

  // The page in one file, from the disk.
  await page.getByRole('button', { name: 'File', exact: true }).click();
  const [download] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', { name: 'Page with sliders (HTML)' }).click(),
  ]);
  const file = join(folder, download.suggestedFilename());
  await download.saveAs(file);
  for (const [width, height, colorScheme] of [
    [1200, 900, 'light'],
    [390, 844, 'dark'],
  ]) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme, offline: true });
    const alone = await context.newPage();
    alone.on('pageerror', (e) => failures.push(`the file: ${e.message}`));
    alone.on('console', (m) => m.type() === 'error' && failures.push(`the file: ${m.text()}`));
    alone.on(
      'request',
      (r) => /^(file|data|blob):/.test(r.url()) || failures.push(`the file asks for ${r.url()}`),
    );
    await alone.goto(pathToFileURL(file).href);
    await alone.locator('.bands label').first().waitFor();
    await alone.waitForTimeout(500);
    const before = await alone.locator('canvas').screenshot();
    check('the file draws', (await look(alone, `18-page-${width}-${colorScheme}.png`, 'canvas')) > 5);
    check('the file has the edit', (await alone.locator('.bands input').first().inputValue()) === '0');
    await alone.locator('.bands input').nth(4).fill('180');
    await alone.waitForTimeout(500);
    check('its sliders move the shape', !before.equals(await alone.locator('canvas').screenshot()));
    const wide = await alone.evaluate(() => document.documentElement.scrollWidth);
    check('nothing is wider than the window', wide <= width, wide);
    await context.close();
  }
} catch (error) {
  failures.push(`the test ended: ${error.message}`);
} finally {
  await browser.close();
}
report(failures);
