/**
 * Random use of a running studio: `node test/random.mjs URL [SECONDS] [SEED]` clicks, drags, presses keys and loads the page anew, and
 * says what went wrong on the console and what memory is left held.
 */

import { chromium } from 'playwright-core';

const [url, seconds = '60', seed = '1'] = process.argv.slice(2);
if (!url) {
  console.error('usage: node test/random.mjs URL [SECONDS] [SEED]');
  process.exit(2);
}

/** Mulberry32: the same seed, the same use. */
let state = Number(seed) >>> 0;
const random = () => {
  state = (state + 0x6d2b79f5) >>> 0;
  let t = state;
  t = Math.imul(t ^ (t >>> 15), t | 1);
  t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
  return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
};
const among = (list) => list[Math.floor(random() * list.length)];

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

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-angle=gl-egl', '--ignore-gpu-blocklist', '--js-flags=--expose-gc'],
});
const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
const failures = [];
page.on('console', (m) => {
  if (m.type() === 'error') failures.push(`console: ${m.text()}`);
});
page.on('pageerror', (e) => failures.push(`page: ${e.message}`));
page.on('dialog', (d) => d.dismiss());
const session = await page.context().newCDPSession(page);
await session.send('Performance.enable');

const ready = () =>
  page.evaluate(async () => {
    while (!window.studio) await new Promise((done) => setTimeout(done, 10));
    await window.studio.ready;
  });
const heap = async () => {
  await page.evaluate(async () => {
    for (let k = 0; k < 5; k++) {
      window.gc?.();
      await new Promise((done) => setTimeout(done, 50));
    }
  });
  const { metrics } = await session.send('Performance.getMetrics');
  return metrics.find((m) => m.name === 'JSHeapUsedSize').value / 1e6;
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
await ready();
const before = await heap();
const kinds = Object.keys(use);
const end = Date.now() + 1000 * Number(seconds);
const counts = {};
let reloads = 0;
while (Date.now() < end) {
  const kind = among(kinds);
  counts[kind] = (counts[kind] ?? 0) + 1;
  await use[kind]();
  if (random() < 0.01) {
    await page.keyboard.press('Escape');
    await page.reload();
    await ready();
    reloads += 1;
  }
}
// The same page as at the start: a fresh one has the same shape and the last edit.
await page.keyboard.press('Escape');
const used = await heap();
await page.reload();
await ready();
const after = await heap();
await browser.close();
console.log(
  JSON.stringify(
    {
      seconds: Number(seconds),
      counts,
      reloads,
      heap: { before, used, after },
      failures: [...new Set(failures)],
    },
    null,
    2,
  ),
);
process.exit(failures.length > 0 ? 1 : 0);
