/**
 * Random use of a running studio: `node test/random.mjs URL [SECONDS] [SEED]` clicks, drags, presses keys and loads the page anew, and
 * says what went wrong on the console and what memory is left held.
 */

import { fromDisk, launch, randomNumbers, report, untilReady } from './browser.mjs';

const [url, seconds = '60', seed = '1'] = process.argv.slice(2);
if (!url) {
  console.error('usage: node test/random.mjs URL [SECONDS] [SEED]');
  process.exit(2);
}

const random = randomNumbers(Number(seed));
const among = (list) => list[Math.floor(random() * list.length)];

/** What may be held more or less after it, as part of what was held before. */
const LEAK = 0.1;

const KEYS = [
  'b',
  'n',
  'l',
  's',
  'm',
  'f',
  '[',
  ']',
  '1',
  '3',
  '7',
  '?',
  'Escape',
  'Tab',
  'Enter',
  'ArrowUp',
  'ArrowLeft',
  'Space',
  'x',
];

const browser = await launch(['--js-flags=--expose-gc', '--enable-blink-features=ForceEagerMeasureMemory']);
const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
await fromDisk(page);
// What the browser asks of a page without an icon, which is where this test begins, and not the studio.
await page.route('**/favicon.ico', (route) => route.fulfill({ status: 204 }));
const failures = [];
let last = 'nothing';
let loaded = Date.now();
page.on('console', (m) => {
  if (m.type() === 'error') failures.push(`console: ${m.text()}`);
});
page.on('response', async (r) => {
  if (r.status() < 400) return;
  const since = ((Date.now() - loaded) / 1000).toFixed(1);
  const told = await r.text().catch(() => '');
  failures.push(
    `${r.request().method()} ${r.url()}: ${r.status()} after ${last}, ${since} s after loading: ${told.slice(0, 200)}`,
  );
});
page.on('pageerror', (e) => failures.push(`page: ${e.message}`));
page.on('dialog', (d) => d.dismiss());

/** Megabytes of the page and its worker: scripts, arrays and elements. */
const memory = () =>
  page.evaluate(async () => {
    // The worker answers in turn: what it builds beforehand is there then.
    await window.studio.mask();
    for (let k = 0; k < 5; k++) {
      window.gc?.();
      await new Promise((done) => setTimeout(done, 50));
    }
    // What no page owns is the browser's own, and what drives it leaves some of its scripts there.
    const { breakdown } = await performance.measureUserAgentSpecificMemory();
    const own = breakdown.filter((part) => part.attribution.length > 0 || part.types.includes('DOM'));
    return Math.round(own.reduce((sum, part) => sum + part.bytes, 0) / 1e4) / 100;
  });
/** The edit that does nothing, on the shape that was opened first with its own levels. */
const begin = async () => {
  // A file of the same place, where no page sends an edit meanwhile.
  await page.goto(new URL('studio.css', url).href);
  await page.waitForTimeout(1000);
  await page.evaluate(async () => {
    const headers = {
      Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}`,
      'Content-Type': 'application/json',
    };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    for (const { id } of shapes.slice(1)) await fetch(`api/shapes/${id}`, { method: 'DELETE', headers });
    const path = `api/shapes/${shapes[0].id}`;
    await fetch(`${path}/levels`, { method: 'PUT', headers, body: '{}' });
    const edit = await (await fetch(`${path}/edit`, { headers })).json();
    const { levels } = await (await fetch(path, { headers })).json();
    const layer = { name: '', on: true, opacity: 1, gains: levels.map(() => 1), region: null };
    const neutral = {
      ...edit,
      revision: edit.revision + 1,
      layers: [layer],
      along: null,
      border: 'natural',
      volume: 'free',
    };
    const answer = await fetch(`${path}/edit`, { method: 'PUT', headers, body: JSON.stringify(neutral) });
    if (!answer.ok) throw new Error(await answer.text());
    sessionStorage.setItem('adwave-shape', String(shapes[0].id));
  });
  await page.goto(url);
  await untilReady(page);
};

const use = {
  async drag() {
    const [x, y] = [random() * 920, 60 + random() * 580];
    await page.mouse.move(x, y);
    await page.mouse.down({ button: among(['left', 'left', 'left', 'right', 'middle']) });
    for (let k = 0; k < 6; k++)
      await page.mouse.move(x + 40 * k * (random() - 0.5), y + 40 * k * (random() - 0.5));
    for (const button of ['left', 'right', 'middle']) await page.mouse.up({ button });
  },
  async slider() {
    const sliders = page.locator('.band input.gain');
    const n = await sliders.count();
    if (n === 0) return;
    const box = await sliders.nth(Math.floor(random() * n)).boundingBox();
    if (!box) return;
    await page.mouse.move(box.x + box.width / 2, box.y + box.height * random());
    await page.mouse.down();
    for (let k = 0; k < 4; k++) await page.mouse.move(box.x + box.width / 2, box.y + box.height * random());
    await page.mouse.up();
  },
  async click() {
    const buttons = page.locator('button:visible:enabled, summary:visible, input[type=checkbox]:visible');
    const n = await buttons.count();
    if (n === 0) return;
    const one = buttons.nth(Math.floor(random() * n));
    // A download or a save each time would fill the folder.
    const name = `${await one.textContent().catch(() => '')}`;
    if (/save|download|picture|with sliders|done/i.test(name)) return;
    await one.click({ timeout: 500, force: true }).catch(() => {});
  },
  async choose() {
    const lists = page.locator('select:visible:enabled');
    const n = await lists.count();
    if (n === 0) return;
    const list = lists.nth(Math.floor(random() * n));
    const options = await list.locator('option').count();
    if (options > 0)
      await list.selectOption({ index: Math.floor(random() * options) }, { timeout: 500 }).catch(() => {});
  },
  async key() {
    await page.keyboard.press(among(KEYS));
  },
  async undo() {
    await page.keyboard.press(among(['Control+z', 'Control+z', 'Control+Shift+z']));
  },
  async wheel() {
    await page.mouse.move(random() * 920, 60 + random() * 580);
    await page.mouse.wheel(0, 600 * (random() - 0.5));
  },
};

await page.goto(url);
await untilReady(page);
await begin();
const before = await memory();
const kinds = Object.keys(use);
const end = Date.now() + 1000 * Number(seconds);
const counts = {};
const used = [];
while (Date.now() < end) {
  const kind = among(kinds);
  counts[kind] = (counts[kind] ?? 0) + 1;
  last = kind;
  await use[kind]();
  if (random() < 0.01) {
    await page.keyboard.press('Escape');
    used.push(await memory());
    await page.reload();
    loaded = Date.now();
    await untilReady(page);
  }
}
await page.keyboard.press('Escape');
used.push(await memory());
await begin();
const after = await memory();
await browser.close();
if (Math.abs(after - before) > LEAK * before) failures.push(`memory: ${before} MB before, ${after} MB after`);
report(failures, {
  seconds: Number(seconds),
  counts,
  reloads: used.length - 1,
  'MB held': { before, used, after },
});
