/**
 * Two tabs on one edit, and a server that is killed in mid stroke: `node test/recovery.mjs ADWAVE SHAPE FOLDER`. Nothing may be lost but the stroke
 * that was being painted.
 */

import { mkdir } from 'node:fs/promises';
import { drag, launch, opened, report, serve, stage, strokes, untilStrokes } from './browser.mjs';

const [adwave, shape, folder] = process.argv.slice(2);
await mkdir(folder, { recursive: true });
const failures = [];
const check = (what, ok, detail = '') => {
  if (!ok) failures.push(detail === '' ? what : `${what}: ${JSON.stringify(detail)}`);
};
const browser = await launch();

const gains = (page) => page.evaluate(() => window.studio.state().layers[0].gains);
const kept = (page) =>
  page.evaluate(async () => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    return (await (await fetch(`api/shapes/${shapes[0].id}/edit`, { headers })).json()).layers[0].gains;
  });
const slide = (page, band, value) =>
  page.evaluate(
    ([j, to]) => {
      const input = document.querySelectorAll('.band input.gain')[j];
      input.value = String(to);
      for (const type of ['input', 'change']) input.dispatchEvent(new Event(type, { bubbles: true }));
    },
    [band, value],
  );
const banner = async (page, name) => {
  await page.getByRole('button', { name }).click();
};

let { server, url } = await serve(adwave, shape, folder);
try {
  // Two tabs: who comes second is told, and loses nothing.
  const [first, second] = [await opened(browser, url, failures), await opened(browser, url, failures)];
  await slide(first, 0, 0);
  await first.evaluate(() => window.studio.kept());
  check('the first tab is kept', (await kept(first))[0] === 0);
  await slide(second, 1, 150);
  await second.locator('.banner:not([hidden])').waitFor();
  check('the second tab keeps what it did', (await gains(second))[1] > 1 && (await gains(second))[0] === 1);
  check('the server keeps what the first did', (await kept(second))[0] === 0);
  await banner(second, 'Keep mine');
  await second.evaluate(() => window.studio.kept());
  check('the second can have its own', (await kept(second))[1] > 1 && (await kept(second))[0] === 1);
  await slide(first, 2, 0);
  await first.locator('.banner:not([hidden])').waitFor();
  await banner(first, 'Take theirs');
  await first.evaluate(() => window.studio.kept());
  check('the first can take it', JSON.stringify(await gains(first)) === JSON.stringify(await gains(second)));
  await slide(first, 3, 120);
  await first.evaluate(() => window.studio.kept());
  check('and go on', (await kept(first))[3] > 1 && (await kept(first))[1] > 1);
  await second.close();

  // A server that dies while a stroke is painted.
  const { x, y, size } = await stage(first);
  const line = (dy) => Array.from({ length: 8 }, (_, k) => [x + size * 0.01 * (k - 4), y + size * dy]);
  await first.keyboard.press('l');
  await first.keyboard.press('b');
  for (const [n, dy] of [0, 0.04, -0.04].entries()) {
    await drag(first, line(dy));
    check(`stroke ${n + 1}`, await untilStrokes(first, n + 1));
  }
  await first.evaluate(() => window.studio.kept());
  await drag(first, line(0.08), async () => {
    server.kill('SIGKILL');
    await new Promise((done) => server.once('exit', done));
  });
  check('the stroke goes on without the server', await untilStrokes(first, 4), await strokes(first));
  await first.locator('.banner:not([hidden])').waitFor();
  // What was done meanwhile is not lost either: it goes into a file.
  const [download] = await Promise.all([first.waitForEvent('download'), banner(first, 'Save the edit')]);
  const file = `${folder}/${download.suggestedFilename()}`;
  await download.saveAs(file);
  const before = await first.evaluate(() => JSON.stringify(window.studio.state().layers));
  ({ server, url } = await serve(adwave, shape, folder));
  const again = await opened(browser, url, failures);
  const back = await strokes(again);
  check('at most one stroke is lost', back >= 3, back);
  check('and the gains are there', JSON.stringify(await gains(again)) === JSON.stringify(await gains(first)));
  // A page behind another one opens no chooser.
  await again.bringToFront();
  const choosing = again.waitForEvent('filechooser');
  // The browser is told in its own time to hand choosers over.
  await again.waitForTimeout(500);
  await again.keyboard.press('Control+o');
  const chooser = await choosing;
  await chooser.setFiles(file);
  check('the file brings the rest', await untilStrokes(again, 4), await strokes(again));
  await again.evaluate(() => window.studio.kept());
  check('all of it', (await again.evaluate(() => JSON.stringify(window.studio.state().layers))) === before);
  // A built-in shape has no format of its own; it can be saved all the same.
  server.kill('SIGKILL');
  ({ server, url } = await serve(adwave, 'sample:sphere', folder));
  const sample = await opened(browser, url, failures);
  await sample.getByRole('button', { name: 'File', exact: true }).click();
  check(
    'a built-in shape has a menu of files',
    await sample.locator('dialog[open] select').first().isVisible(),
  );
} catch (error) {
  failures.push(`the test ended: ${error.message}`);
} finally {
  server.kill('SIGKILL');
  await browser.close();
}
report(failures);
