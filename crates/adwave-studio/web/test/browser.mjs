/** What the tests in a browser share. */

import { spawn } from 'node:child_process';
import { readFile } from 'node:fs/promises';
import { createInterface } from 'node:readline';
import { chromium } from 'playwright-core';

export const launch = (args = []) =>
  chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--use-angle=gl-egl', '--ignore-gpu-blocklist', ...args],
  });

/** Polls within one call: the page's policy forbids what `waitForFunction` does. */
export async function untilReady(page) {
  await page.evaluate(async () => {
    while (!window.studio) await new Promise((done) => setTimeout(done, 10));
    await window.studio.ready;
  });
}

/** With STUDIO_DIST the page is taken from that folder in place of the server's own: a change is tried without building the server. */
export async function fromDisk(context) {
  const dist = process.env.STUDIO_DIST;
  if (!dist) return;
  await context.route(/\/(index\.js|main\.js|worker\.js|studio\.css)$/, async (route) => {
    const name = new URL(route.request().url()).pathname.slice(1);
    await route.fulfill({ response: await route.fetch(), body: await readFile(`${dist}/${name}`) });
  });
}

export async function opened(browser, url, failures) {
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  await fromDisk(page);
  page.setDefaultTimeout(60_000);
  page.on('pageerror', (e) => failures.push(`page: ${e.message}`));
  await page.goto(url);
  await untilReady(page);
  return page;
}

/** Mulberry32: the same seed, the same numbers in [0, 1). */
export function randomNumbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** A studio of its own on a shape: the process and its address. */
export async function serve(adwave, shape, folder, words = []) {
  const server = spawn(adwave, ['studio', '--no-open', shape, ...words], {
    env: { ...process.env, XDG_STATE_HOME: `${folder}/state` },
    stdio: ['ignore', 'pipe', 'inherit'],
  });
  const [url] = await Promise.race([
    (async () => {
      for await (const line of createInterface({ input: server.stdout })) return [line.trim()];
      throw new Error('the studio gave no address');
    })(),
    new Promise((_, failed) => setTimeout(() => failed(new Error('the studio gave no address')), 60_000)),
  ]);
  return { server, url };
}

/** Drags over the picture from place to place; `mid` is awaited before the pointer is lifted. */
export async function drag(page, places, mid = async () => {}) {
  const [first, ...rest] = places;
  await page.mouse.move(...first);
  await page.mouse.down();
  for (const place of rest) await page.mouse.move(...place);
  await mid();
  await page.mouse.up();
}

/** The middle of the picture, and how large it is. */
export async function stage(page) {
  const box = await page.locator('canvas.picture').boundingBox();
  return { x: box.x + box.width / 2, y: box.y + box.height / 2, size: Math.min(box.width, box.height) };
}

/** Strokes of the last layer. */
export const strokes = (page) =>
  page.evaluate(() => window.studio.state().layers.at(-1).region?.painted?.length ?? 0);

/** Waits until the last layer has so many strokes and all is kept; false after ten seconds. */
export async function untilStrokes(page, n) {
  for (let i = 0; i < 200 && (await strokes(page)) < n; i++) await page.waitForTimeout(50);
  return (await strokes(page)) >= n;
}

export function report(failures, more = {}) {
  console.log(JSON.stringify({ ...more, failures: [...new Set(failures)] }, null, 2));
  process.exit(failures.length ? 1 : 0);
}
