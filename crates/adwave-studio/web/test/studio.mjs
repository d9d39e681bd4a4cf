/**
 * A tour of a running studio in a real Chromium: `node test/studio.mjs URL FOLDER [--write]` takes pictures into the folder and
 * prints what was wrong and how long things took. It assumes PROTOCOL.md and nothing else.
 */

import { mkdir, writeFile } from 'node:fs/promises';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { fromDisk, launch, untilReady } from './browser.mjs';
import { decodePng, deviation } from './png.mjs';
import { steps } from './steps.mjs';

/** Anything that takes longer hangs. */
const LIMIT = 60_000;
/** Least standard deviation of a picture that is not blank. */
const NOT_BLANK = 5;
/** Positions of equal documents may differ by the last bit of single precision at most; here they are equal. */
const EQUAL = 0;

export async function tour(url, folder, { limit = LIMIT } = {}) {
  await mkdir(folder, { recursive: true });
  const browser = await launch();
  const failures = [];
  const check = (what, ok, detail = '') => {
    if (!ok) failures.push(detail === '' ? what : `${what}: ${detail}`);
  };
  try {
    const page = await browser.newPage({
      viewport: { width: 1200, height: 900 },
      colorScheme: 'light',
      hasTouch: false,
    });
    await fromDisk(page);
    page.setDefaultTimeout(limit);
    page.on('console', (m) => {
      if (m.type() === 'error' || /content security policy/i.test(m.text()))
        failures.push(`console: ${m.text()}`);
    });
    page.on('pageerror', (e) => failures.push(`page: ${e.message}`));
    const away = new URL(url).origin;
    const requests = [];
    page.on('request', (r) => {
      requests.push({
        method: r.method(),
        path: new URL(r.url()).pathname,
        bytes: r.postDataBuffer()?.length ?? 0,
      });
      if (new URL(r.url()).origin !== away && !/^(blob|data):/.test(r.url()))
        failures.push(`a request to ${r.url()}`);
    });

    await page.goto(url);
    await untilReady(page);
    // An edit of another time would be in the way.
    const resumed = await page.evaluate(async () => {
      if (window.studio.state().layers.every((l) => l.gains.every((g) => g === 1))) return false;
      const headers = {
        Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}`,
        'Content-Type': 'application/json',
      };
      const { shapes } = await (await fetch('api/shapes', { headers })).json();
      const path = `api/shapes/${shapes[0].id}/edit`;
      const edit = await (await fetch(path, { headers })).json();
      const layer = {
        name: '',
        on: true,
        opacity: 1,
        gains: edit.layers[0].gains.map(() => 1),
        region: null,
      };
      const neutral = { ...edit, revision: edit.revision + 1, layers: [layer] };
      await fetch(path, { method: 'PUT', headers, body: JSON.stringify(neutral) });
      return true;
    });
    if (resumed) {
      await page.reload();
      await untilReady(page);
    }
    const renderer = await page.evaluate(() => window.studio.renderer);
    check('drawn by', !/swiftshader/i.test(renderer) && renderer !== '', renderer);
    const first = await page.evaluate(() => ({ ...window.studio.timings }));
    await page.evaluate(() => window.studio.measure(true));

    const picture = async (name, clip) => {
      await page.evaluate(() => new Promise((done) => setTimeout(done, 250)));
      const bytes = await page.screenshot({ path: join(folder, `${name}.png`) });
      const stage = clip ?? (await page.locator('main.stage').boundingBox());
      const sd = deviation(decodePng(bytes), stage);
      check(`picture ${name} is blank`, sd > NOT_BLANK, sd.toFixed(1));
      return sd;
    };
    const state = () => page.evaluate(() => window.studio.state());
    /** Sum of absolute differences and a few numbers, without sending all positions twice. */
    const keep = (name) =>
      page.evaluate(async (n) => {
        window.kept ??= {};
        window.kept[n] = await window.studio.positions();
        return window.kept[n].length;
      }, name);
    const differ = (a, b) =>
      page.evaluate(
        ([p, q]) => window.kept[p].reduce((most, x, i) => Math.max(most, Math.abs(x - window.kept[q][i])), 0),
        [a, b],
      );
    const reset = () =>
      page.evaluate(() => {
        for (const list of Object.values(window.studio.timings)) if (Array.isArray(list)) list.length = 0;
      });
    const times = () => page.evaluate(() => ({ ...window.studio.timings }));

    await picture('1-opened');
    await keep('opened');

    // A slider, as a hand drags it: many values in one gesture, one step of undo, no request while it moves.
    const sliders = page.locator('.band input.gain');
    const nBands = await sliders.count();
    check('there are sliders', nBands > 0);
    await reset();
    const before = requests.length;
    const track = await sliders.nth(1).boundingBox();
    const thumb = [track.x + track.width / 2, track.y + track.height / 2];
    await page.mouse.move(...thumb);
    await page.mouse.down();
    for (let i = 0; i <= 20; i++) {
      await page.mouse.move(thumb[0], thumb[1] - (0.4 * track.height * i) / 20);
      await page.waitForTimeout(16);
    }
    check('requests while a slider moves', requests.length === before, requests.length - before);
    const sliding = (await times()).slider;
    await page.mouse.up();
    await page.evaluate(() => window.studio.kept());
    await keep('slid');
    check('the slider moves the shape', (await differ('opened', 'slid')) > 0);
    const settling = (await times()).settle.at(-1);
    await picture('2-slider');

    // Keys move a focused slider.
    await sliders.nth(0).focus();
    await page.keyboard.press('ArrowDown');
    await page.keyboard.press('PageDown');
    check('keys move a slider', (await state()).layers[0].gains[0] < 1);
    await page.evaluate(() => window.studio.positions());

    // Undo to the beginning gives the shape as it was opened, to the bit.
    await page.evaluate(() => document.activeElement.blur());
    for (let i = 0; i < 3; i++) await page.keyboard.press('Control+z');
    await keep('undone');
    check('undo restores the positions', (await differ('opened', 'undone')) <= EQUAL);
    for (let i = 0; i < 3; i++) await page.keyboard.press('Control+Shift+z');
    await keep('redone');
    check('redo changes them again', (await differ('opened', 'redone')) > 0);

    await page.evaluate(() => window.studio.kept());
    // The brush: a stroke over the middle of the shape makes a layer; its sliders act there alone.
    await reset();
    await page.keyboard.press('b');
    const box = await page.locator('canvas.picture').boundingBox();
    const [cx, cy] = [box.x + box.width / 2, box.y + box.height / 2];
    const layersBefore = (await state()).layers.length;
    const moving = requests.length;
    await page.mouse.move(cx - 60, cy);
    await page.waitForTimeout(300);
    await page.mouse.down();
    for (let i = 0; i <= 24; i++) {
      await page.mouse.move(cx - 60 + 5 * i, cy + 20 * Math.sin(i / 4));
      await page.waitForTimeout(16);
    }
    check('requests while the brush paints', requests.length === moving, requests.length - moving);
    await page.mouse.up();
    // The stroke ends in the worker: a large one takes a moment.
    await page.evaluate(async () => {
      for (let i = 0; i < 200 && !window.studio.state().layers.at(-1).region?.painted?.length; i++) {
        await new Promise((done) => setTimeout(done, 50));
      }
    });
    await page.evaluate(() => window.studio.kept());
    const painted = await state();
    const stroke = painted.layers.at(-1).region?.painted;
    check('a stroke makes a layer', painted.layers.length === layersBefore + 1, painted.layers.length);
    check(
      'with the vertices it was stamped at',
      stroke?.[0]?.add?.vertices?.indices?.length > 3,
      JSON.stringify(stroke)?.slice(0, 200),
    );
    const strokeTimes = await times();
    await picture('3-brush');
    await page.evaluate(async () => {
      for (const j of [0, 1, 2]) {
        const input = document.querySelectorAll('.band input.gain')[j];
        if (!input) continue;
        input.value = '0';
        input.dispatchEvent(new Event('input', { bubbles: true }));
        input.dispatchEvent(new Event('change', { bubbles: true }));
      }
      await window.studio.kept();
    });
    await keep('smoothed');
    const local = await page.evaluate(() => {
      const a = window.kept.redone;
      const b = window.kept.smoothed;
      let moved = 0;
      for (let i = 0; i < a.length; i += 3)
        if (a[i] !== b[i] || a[i + 1] !== b[i + 1] || a[i + 2] !== b[i + 2]) moved++;
      return moved / (a.length / 3);
    });
    check('the layer acts where it was painted only', local > 0 && local < 0.5, local);
    await page.keyboard.press('Escape');
    await picture('4-smoothed');

    // Positions of the page and of the server.
    const exact = await page.evaluate(async () => {
      const token = sessionStorage.getItem('adwave-token');
      const headers = { Authorization: `Bearer ${token}` };
      const list = await (await fetch('api/shapes', { headers })).json();
      const id = list.shapes[0].id;
      const shape = await (await fetch(`api/shapes/${id}`, { headers })).json();
      const kept = await (await fetch(`api/shapes/${id}/edit`, { headers })).json();
      const there = new Float32Array(
        await (await fetch(`api/shapes/${id}/exact`, { headers })).arrayBuffer(),
      );
      const here = await window.studio.positions();
      let most = 0;
      for (let i = 0; i < here.length; i++) most = Math.max(most, Math.abs(here[i] - there[i]));
      return { kept, part: most / shape.diagonal };
    });
    const { revision: _, ...ours } = await state();
    const { revision: __, ...theirs } = exact.kept;
    check('the edit that is kept is the one of the page', JSON.stringify(ours) === JSON.stringify(theirs));

    // Looks.
    await page.keyboard.press('s');
    await picture('5-split');
    await page.keyboard.press('s');
    await page.keyboard.down('\\');
    await page.waitForTimeout(200);
    await page.screenshot({ path: join(folder, '6-before.png') });
    await page.keyboard.up('\\');
    await page.keyboard.press('c');
    await page.waitForTimeout(500);
    await picture('7-change');
    await page.keyboard.press('c');
    const fields = await page.locator('#look select').first().locator('option').count();
    if (fields > 2) {
      const names = await page
        .locator('#look select')
        .first()
        .locator('option')
        .evaluateAll((o) => o.map((x) => x.value));
      const field = names.find((n) => n.startsWith('field-'));
      if (field) {
        await page.locator('#look select').first().selectOption(field);
        await page.waitForTimeout(1000);
        await picture('8-field');
        await page.locator('#look select').first().selectOption('none');
      }
    }
    await page.locator('#look .check input').first().check();
    await page.waitForTimeout(1500);
    await picture('9-features');
    await page.locator('#look .check input').first().uncheck();
    for (const name of ['matcap', 'flat', 'edges', 'shaded']) {
      await page.keyboard.press('m');
      await page.waitForTimeout(300);
      await picture(`10-${name}`);
    }
    await page.keyboard.press('?');
    await picture('11-keys', await page.locator('dialog').boundingBox());
    await page.keyboard.press('Escape');
    await page.getByRole('button', { name: 'Light or dark' }).click();
    await picture('12-dark');

    // Orbiting.
    const orbit = await page.evaluate(async () => {
      const canvas = document.querySelector('canvas.picture');
      const r = canvas.getBoundingClientRect();
      const at = (type, x, y) =>
        canvas.dispatchEvent(
          new PointerEvent(type, { pointerId: 1, button: 0, clientX: x, clientY: y, bubbles: true }),
        );
      canvas.setPointerCapture = () => {};
      const [x, y] = [r.left + r.width / 2, r.top + r.height / 2];
      at('pointerdown', x, y);
      const frames = [];
      for (let i = 0; i < 12; i++) {
        const t = performance.now();
        at('pointermove', x + 3 * i, y);
        await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
        frames.push(performance.now() - t);
      }
      at('pointerup', x + 36, y);
      return frames;
    });

    // A lost picture comes back.
    await page.evaluate(async () => {
      const gl = document.querySelector('canvas.picture').getContext('webgl2');
      const lose = gl.getExtension('WEBGL_lose_context');
      lose.loseContext();
      await new Promise((done) => setTimeout(done, 300));
      lose.restoreContext();
      await new Promise((done) => setTimeout(done, 800));
    });
    await picture('13-restored');

    // A reload resumes.
    await page.reload();
    await untilReady(page);
    const { revision: ___, ...again } = await state();
    check('a reload resumes the edit', JSON.stringify(again) === JSON.stringify(ours));
    await keep('reloaded').catch(() => {});

    await steps(browser, failures);

    // Narrow, with touch.
    for (const scheme of ['light', 'dark']) {
      const context = await browser.newContext({
        viewport: { width: 390, height: 844 },
        hasTouch: true,
        isMobile: true,
        colorScheme: scheme,
      });
      const phone = await context.newPage();
      phone.on('pageerror', (e) => failures.push(`page: ${e.message}`));
      await phone.goto(url);
      await untilReady(phone);
      await phone.waitForTimeout(400);
      for (const tab of ['equalizer', 'layers', 'brush', 'look']) {
        await phone.locator(`.sheet-tabs [data-tab=${tab}]`).tap();
        await phone.waitForTimeout(150);
        await phone.screenshot({ path: join(folder, `14-narrow-${scheme}-${tab}.png`) });
      }
      const wide = await phone.evaluate(() => document.documentElement.scrollWidth);
      check('nothing is wider than a narrow window', wide <= 390, wide);
      await context.close();
    }

    const median = (list) => {
      const sorted = [...(list ?? [])].sort((a, b) => a - b);
      return sorted.length ? Number(sorted[sorted.length >> 1].toFixed(2)) : null;
    };
    const ms = (x) => (x === undefined ? null : Number(x.toFixed(1)));
    const result = {
      failures,
      renderer,
      bands: nBands,
      'first pixels ms': ms(first.firstPixels),
      'first slider live ms': ms(first.firstSlider),
      'all sliders live ms': ms(first.slidersLive),
      'slider to pixels ms': median(sliding),
      'exact after release, computing ms': ms(settling),
      'pick ms': median(strokeTimes.pick),
      'stamp ms': median(strokeTimes.stamp),
      'orbit frame ms': median(orbit),
      'page against exact, part of the diagonal': exact.part,
      'bytes sent for the stroke': requests.filter((r) => r.method === 'PUT').at(1)?.bytes ?? null,
    };
    await writeFile(join(folder, 'times.json'), `${JSON.stringify(result, null, 2)}\n`);
    return result;
  } catch (error) {
    failures.push(`the tour ended: ${error.message}`);
    return { failures };
  } finally {
    await browser.close();
  }
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? '').href) {
  const [url, folder = 'out'] = process.argv.slice(2);
  const result = await tour(url, folder);
  console.log(JSON.stringify(result, null, 2));
  process.exitCode = result.failures.length ? 1 : 0;
}
