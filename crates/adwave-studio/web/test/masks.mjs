/**
 * Random strokes in a real Chromium, each compared with what the server makes of it: `node test/masks.mjs URL [STROKES] [SEED]`. Every byte
 * of the page's mask has to be that of the server.
 */

import { drag, launch, opened, randomNumbers, report, stage, untilStrokes } from './browser.mjs';

const [url, wanted = '100', seed = '1'] = process.argv.slice(2);
const random = randomNumbers(Number(seed));
const among = (list) => list[Math.floor(random() * list.length)];
const failures = [];
const browser = await launch();
const page = await opened(browser, url, failures);
const { x, y, size } = await stage(page);

/** Where both masks differ, and how many vertices are painted. */
const compare = () =>
  page.evaluate(async () => {
    const headers = {
      Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}`,
      'Content-Type': 'application/json',
    };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    const { region } = window.studio.state().layers.at(-1);
    const body = JSON.stringify(region);
    const answer = await fetch(`api/shapes/${shapes[0].id}/weights`, { method: 'POST', headers, body });
    const there = new Uint8Array(await answer.arrayBuffer());
    const here = await window.studio.mask();
    const wrong = [];
    for (let v = 0; v < there.length; v++) if (here[v] !== there[v]) wrong.push([v, here[v], there[v]]);
    return {
      same: here.length === there.length && !wrong.length,
      wrong: wrong.slice(0, 5),
      painted: here.filter((w) => w).length,
    };
  });

await page.keyboard.press('l');
await page.keyboard.press('b');
let n = 0;
let tries = 0;
let covered = 0;
const set = async (label, value) =>
  page.getByLabel(label, { exact: true }).evaluate((input, to) => {
    input.value = String(to);
    input.dispatchEvent(new Event('input', { bubbles: true }));
  }, value);
while (n < Number(wanted) && tries < 4 * Number(wanted)) {
  tries += 1;
  if (random() < 0.2) await page.keyboard.press(among(['1', '3', '7', 'Shift+1', 'Shift+3']));
  if (random() < 0.3) await page.keyboard.press(among(['n', 'n', 'j', '[', ']']));
  if (random() < 0.2) await page.getByLabel('Front faces only').click();
  if (random() < 0.2) await page.getByLabel('Mirror in x').click();
  if (random() < 0.3) await set('Soft edge', among([0, 35, 70, 100]));
  if (random() < 0.3)
    await page
      .locator('#brush')
      .getByLabel('Strength', { exact: true })
      .evaluate(
        (input, to) => {
          input.value = String(to);
          input.dispatchEvent(new Event('input', { bubbles: true }));
        },
        among([25, 60, 100]),
      );
  // Mostly over the shape: what begins beside it is no stroke.
  const place = () => [x + 0.2 * size * (random() - 0.5), y + 0.5 * size * (random() - 0.5)];
  const [from, to] = [place(), place()];
  const steps = 2 + Math.floor(6 * random());
  const before = n;
  await drag(
    page,
    Array.from({ length: steps + 1 }, (_, k) => from.map((a, c) => a + ((to[c] - a) / steps) * k)),
  );
  // A drag beside the shape turns it, and is no stroke.
  for (let i = 0; i < 24 && n === before; i++) {
    await page.waitForTimeout(25);
    n = await page.evaluate(() => window.studio.state().layers.at(-1).region?.painted?.length ?? 0);
  }
  if (n === before) continue;
  const found = await compare();
  covered = found.painted;
  if (!found.same) failures.push(`stroke ${n}: ${JSON.stringify(found.wrong)}`);
}
if (n < Number(wanted)) failures.push(`only ${n} strokes in ${tries} drags`);
if (covered === 0) failures.push('nothing is painted');
// Undo and redo of all of them give the server's bytes as well.
await page.evaluate(() => document.activeElement.blur());
for (const [key, times] of [
  ['Control+z', 10],
  ['Control+Shift+z', 10],
]) {
  for (let k = 0; k < times; k++) await page.keyboard.press(key);
  const found = await compare();
  if (!found.same) failures.push(`after ${key}: ${JSON.stringify(found.wrong)}`);
}
await untilStrokes(page, n);
await browser.close();
report(failures, { strokes: n, drags: tries, 'vertices painted': covered });
