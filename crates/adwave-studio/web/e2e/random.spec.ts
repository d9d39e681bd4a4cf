/**
 * Random use of the studio: clicks, drags, keys, reloads, restarts of the server and second tabs must leave nothing on the
 * console and no memory behind, and lose nothing.
 *
 * `STUDIO_SECONDS=600 STUDIO_SEED=1 npx playwright test --project=random`, with `STUDIO_SHAPE=FILE` on another shape, a graph, an
 * image or a volume.
 */

import { expect, type Page, test } from '@playwright/test';
import type { Edit } from '../src/protocol';
import {
  currentEdit,
  randomNumbers,
  setSlider,
  useTestBuild,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { creature, killStudio, OUT, startStudio } from './support/studio-server';

const N_SECONDS = Number(process.env['STUDIO_SECONDS'] ?? 60);
const SEED = Number(process.env['STUDIO_SEED'] ?? 1);
const SHAPE = process.env['STUDIO_SHAPE'];
/**
 * Part of the time before the memory is measured first. The browser keeps compiled code of what was used for the next visit,
 * about a megabyte; a page in another context has the memory of the first visit.
 */
const WARM_UP = 0.25;
/** Largest change of the held memory, relative to the memory before. */
const MAX_LEAK = 0.1;

const KEYS = ['b', 'p', 'n', 'l', 's', 'm', 'f', '[', ']', '1', '3', '7', '?', 'x'].concat([
  'Escape',
  'Tab',
  'Enter',
  'ArrowUp',
  'ArrowLeft',
  'Space',
]);

interface MemoryMeasurement {
  breakdown: { bytes: number; types: string[]; attribution: unknown[] }[];
}

/** Megabytes of scripts, arrays and elements of the page and its worker. */
const heldMemory = (page: Page): Promise<number> =>
  page.evaluate(async () => {
    // The worker answers in order, so that its preparations are finished.
    await window.studio.mask().catch(() => {}); // an image has none
    for (let k = 0; k < 5; k++) {
      (window as unknown as { gc?: () => void }).gc?.();
      await new Promise((resolve) => setTimeout(resolve, 50));
    }
    // Memory without attribution belongs to the browser and to the scripts of the test driver.
    const { breakdown } = await (
      performance as unknown as { measureUserAgentSpecificMemory(): Promise<MemoryMeasurement> }
    ).measureUserAgentSpecificMemory();
    const own = breakdown.filter((part) => part.attribution.length > 0 || part.types.includes('DOM'));
    return Math.round(own.reduce((sum, part) => sum + part.bytes, 0) / 1e4) / 100;
  });

/** Edit of the only shape as the server has it, without the count of its changes; `null` if there are more shapes. */
const storedEdit = (page: Page): Promise<Edit | null> =>
  page.evaluate(async () => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    const { shapes } = await (await fetch('api/shapes', { headers })).json();
    if (shapes.length > 1) return null;
    const edit = await (await fetch(`api/shapes/${shapes[0].id}/edit`, { headers })).json();
    return { ...edit, revision: 0 };
  });

/** Opens the first shape with default levels and a neutral edit. */
async function openNeutral(page: Page, url: string): Promise<void> {
  // A static file of the same origin, where no page sends an edit meanwhile.
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
    const gains = levels.map(() => 1);
    const neutral = {
      ...edit,
      revision: edit.revision + 1,
      layers: [{ name: '', on: true, opacity: 1, gains, region: null }],
      along: null,
      border: 'natural',
      volume: 'free',
      // Clones and a pose take memory for the places and frames of all vertices.
      clones: [],
      pose: null,
      fields: [],
    };
    const response = await fetch(`${path}/edit`, { method: 'PUT', headers, body: JSON.stringify(neutral) });
    if (!response.ok) throw new Error(await response.text());
    // A view with colors, and undo, would be there again.
    localStorage.removeItem('adwave-views');
    sessionStorage.removeItem(`adwave-history-${shapes[0].id}`);
    sessionStorage.setItem('adwave-shape', String(shapes[0].id));
  });
  await page.goto(url);
  await waitUntilReady(page);
}

/** Random actions by name. */
function randomActions(page: Page, random: () => number): Record<string, () => Promise<void>> {
  const pick = <T>(list: readonly T[]): T => list[Math.floor(random() * list.length)]!;
  return {
    async drag() {
      const [x, y] = [random() * 920, 60 + random() * 580];
      await page.mouse.move(x, y);
      await page.mouse.down({ button: pick(['left', 'left', 'left', 'right', 'middle'] as const) });
      for (let k = 0; k < 6; k++)
        await page.mouse.move(x + 40 * k * (random() - 0.5), y + 40 * k * (random() - 0.5));
      for (const button of ['left', 'right', 'middle'] as const) await page.mouse.up({ button });
    },
    async slider() {
      const sliders = page.locator('.band input.gain');
      const n = await sliders.count();
      if (n === 0) return;
      const box = await sliders.nth(Math.floor(random() * n)).boundingBox();
      if (!box) return;
      const x = box.x + box.width / 2;
      await page.mouse.move(x, box.y + box.height * random());
      await page.mouse.down();
      for (let k = 0; k < 4; k++) await page.mouse.move(x, box.y + box.height * random());
      await page.mouse.up();
    },
    async click() {
      const buttons = page.locator('button:visible:enabled, summary:visible, input[type=checkbox]:visible');
      const n = await buttons.count();
      if (n === 0) return;
      const button = buttons.nth(Math.floor(random() * n));
      // Repeated downloads would fill the folder, and quitting would end the test.
      const name = `${await button.textContent().catch(() => '')}`;
      if (/save|download|picture|json|with sliders|quit/i.test(name)) return;
      await button.click({ timeout: 500, force: true }).catch(() => {});
    },
    async choose() {
      const lists = page.locator('select:visible:enabled');
      const n = await lists.count();
      if (n === 0) return;
      const list = lists.nth(Math.floor(random() * n));
      const nOptions = await list.locator('option').count();
      if (nOptions === 0) return;
      const index = Math.floor(random() * nOptions);
      await list.selectOption({ index }, { timeout: 500 }).catch(() => {});
    },
    async key() {
      await page.keyboard.press(pick(KEYS));
    },
    async undo() {
      await page.keyboard.press(pick(['Control+z', 'Control+z', 'Control+Shift+z']));
    },
    async grab() {
      const isOn = await page.evaluate(() =>
        document.querySelector('.picture')!.classList.contains('grabbing'),
      );
      if (!isOn) await page.keyboard.press('p');
      const modes = page.locator('.grab-panel .segments button:visible');
      const n = await modes.count();
      if (n > 0)
        await modes
          .nth(pick([0, 0, 0, 1, 2]) % n)
          .click({ timeout: 500 })
          .catch(() => {});
      const [x, y] = [360 + 200 * random(), 250 + 200 * random()];
      await page.mouse.move(x, y);
      await page.mouse.down();
      await page.waitForTimeout(300 * random());
      for (let k = 1; k < 8; k++)
        await page.mouse.move(x + 12 * k * (random() - 0.3), y + 12 * k * (random() - 0.5));
      await page.mouse.up();
    },
    async clone() {
      await page.evaluate(() => document.querySelector<HTMLButtonElement>('[data-effect="clone"]')!.click());
      const at = () => [380 + 160 * random(), 270 + 160 * random()] as const;
      if (random() < 0.5) await page.keyboard.down('Alt');
      await page.mouse.click(...at());
      await page.keyboard.up('Alt');
      const [x, y] = at();
      await page.mouse.move(x, y);
      await page.mouse.down();
      for (let k = 1; k < 6; k++) await page.mouse.move(x + 10 * k, y + 10 * k * (random() - 0.5));
      await page.mouse.up();
    },
    async field() {
      const name = pick(['smooth', 'classes'] as const);
      await page.evaluate(async (kind) => {
        const n = await window.studio.positions().then(
          (positions) => positions.length / 3,
          () => 0,
        );
        if (n === 0) return;
        const head = `{'descr': '<f4', 'fortran_order': False, 'shape': (${n},), }`;
        // Magic, version 1.0, and the length of the header.
        const file = new Uint8Array(128 + 4 * n).fill(32);
        file.set([0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, 118, 0]);
        file.set(new TextEncoder().encode(head), 10);
        file[127] = 10;
        const values = new Float32Array(file.buffer, 128);
        for (let v = 0; v < n; v++) values[v] = kind === 'classes' ? v % 4 : Math.sin(v / 300);
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([file], `${kind}.npy`));
        document.getElementById('app')!.dispatchEvent(new DragEvent('drop', { dataTransfer }));
      }, name);
    },
    async target() {
      const choice = page.locator('.target:visible button');
      const n = await choice.count();
      if (n > 0)
        await choice
          .nth(Math.floor(random() * n))
          .click({ timeout: 500 })
          .catch(() => {});
    },
    async handle() {
      const handles = page.locator('.gizmo-handle:visible');
      const n = await handles.count();
      const box = n > 0 ? await handles.nth(Math.floor(random() * n)).boundingBox() : null;
      if (!box) return;
      const [x, y] = [box.x + 12, box.y + 12];
      await page.mouse.move(x, y);
      await page.mouse.down();
      for (let k = 1; k < 5; k++)
        await page.mouse.move(x + 15 * k * (random() - 0.5), y + 15 * k * (random() - 0.5));
      await page.mouse.up();
    },
    async wheel() {
      await page.mouse.move(random() * 920, 60 + random() * 580);
      await page.mouse.wheel(0, 600 * (random() - 0.5));
    },
  };
}

test('random use leaves no errors and no memory behind', async ({ browser }) => {
  const random = randomNumbers(SEED);
  const failures: string[] = [];
  const shape = SHAPE ?? creature(20_000);
  const state = `${OUT}/random-${Date.now()}`;
  let server = await startStudio(shape, state);
  try {
    const context = await browser.newContext({ viewport: { width: 1200, height: 900 } });
    await useTestBuild(context);
    // The browser requests an icon for the static file; the studio has none.
    await context.route('**/favicon.ico', (route) => route.fulfill({ status: 204 }));
    let last = 'nothing';
    let loadedAt = Date.now();
    // A tab whose edit is outdated gets the status 409 and asks. Whether an edit is smooth enough to be compared with other
    // methods is known once the server has measured it; it says so with the status 400.
    let hasTwoTabs = false;
    const isAnswer = (status: number, url: string) =>
      (hasTwoTabs && status === 409) || (status === 400 && url.endsWith('/compare'));
    const watch = (tab: Page) => {
      tab.on('console', (m) => {
        const status = Number(/status of (\d+)/.exec(m.text())?.[1] ?? 0);
        if (m.type() === 'error' && !isAnswer(status, m.location().url))
          failures.push(`console: ${m.text()}`);
      });
      tab.on('response', async (r) => {
        if (r.status() < 400) return;
        const text = await r.text().catch(() => '');
        const isRefusal =
          !r.url().endsWith('/compare') || text.includes('must be smoother than the original');
        if (isAnswer(r.status(), r.url()) && isRefusal) return;
        const seconds = ((Date.now() - loadedAt) / 1000).toFixed(1);
        const body = text.slice(0, 200);
        const request = `${r.request().method()} ${r.url()}: ${r.status()}`;
        failures.push(`${request} after ${last}, ${seconds} s after loading: ${body}`);
      });
      tab.on('pageerror', (e) => failures.push(`page: ${e.message}`));
      tab.on('dialog', (d) => d.dismiss());
    };
    const page = await context.newPage();
    watch(page);

    /** Edit of the page, without the count of its changes. */
    const shownEdit = async () => ({ ...(await currentEdit(page)), revision: 0 });

    /** Kills the server when all is saved, and starts it again: the edit must be there as it was. */
    const restart = async () => {
      await waitUntilSaved(page);
      const before = await storedEdit(page);
      if (before) expect(before, 'what is shown is saved').toEqual(await shownEdit());
      await page.goto('about:blank');
      await killStudio(server);
      server = await startStudio(shape, state);
      await page.goto(server.url);
      await waitUntilReady(page);
      if (before) expect(await storedEdit(page), 'the edit after a restart').toEqual(before);
    };

    /** Moves the first slider, if there is one. */
    const moveSlider = async (tab: Page) => {
      if ((await tab.locator('.band input.gain:enabled').count()) > 0)
        await setSlider(tab, 0, 10 + Math.floor(150 * random()));
    };

    let nAsked = 0;
    /** Edits in a second tab and then here: the page asks, and either edit is kept whole. */
    const useSecondTab = async () => {
      await waitUntilSaved(page);
      const before = await storedEdit(page);
      if (!before) return;
      hasTwoTabs = true;
      const other = await context.newPage();
      watch(other);
      await other.goto(server.url);
      await waitUntilReady(other);
      await moveSlider(other);
      await waitUntilSaved(other);
      const theirs = await storedEdit(other);
      await other.close();
      await page.bringToFront();
      const shown = await shownEdit();
      await moveSlider(page);
      const mine = await shownEdit();
      const isSame = (a: unknown, b: unknown) => JSON.stringify(a) === JSON.stringify(b);
      if (!isSame(theirs, before) && !isSame(mine, shown)) {
        const keepsMine = random() < 0.5;
        await page.getByRole('button', { name: keepsMine ? 'Keep mine' : 'Take theirs' }).click();
        await waitUntilSaved(page);
        const kept = keepsMine ? mine : theirs;
        expect(await storedEdit(page), keepsMine ? 'mine is kept' : 'theirs is taken').toEqual(kept);
        nAsked++;
      }
      await waitUntilSaved(page);
      hasTwoTabs = false;
    };

    await page.goto(server.url);
    await waitUntilReady(page);
    const actions = randomActions(page, random);
    const names = Object.keys(actions);
    const counts: Record<string, number> = {};
    const used: number[] = [];
    const began = Date.now();
    let before = 0;
    while (Date.now() < began + 1000 * N_SECONDS) {
      if (before === 0 && Date.now() > began + 1000 * WARM_UP * N_SECONDS) {
        await openNeutral(page, server.url);
        loadedAt = Date.now();
        before = await heldMemory(page);
      }
      last = names[Math.floor(random() * names.length)]!;
      counts[last] = (counts[last] ?? 0) + 1;
      await actions[last]!();
      if (random() < 0.01) {
        await page.keyboard.press('Escape');
        used.push(await heldMemory(page));
        const event = (['reload', 'restart', 'tabs'] as const)[Math.floor(3 * random())]!;
        last = event;
        counts[event] = (counts[event] ?? 0) + 1;
        if (event === 'restart') await restart();
        else if (event === 'tabs') await useSecondTab();
        else {
          await page.reload();
          await waitUntilReady(page);
        }
        loadedAt = Date.now();
      }
    }
    await page.keyboard.press('Escape');
    used.push(await heldMemory(page));
    await openNeutral(page, server.url);
    const after = await heldMemory(page);
    console.log(JSON.stringify({ seconds: N_SECONDS, counts, asked: nAsked, before, used, after }));
    expect([...new Set(failures)]).toEqual([]);
    expect(Math.abs(after - before), `memory: ${before} MB before, ${after} MB after`).toBeLessThanOrEqual(
      MAX_LEAK * before,
    );
  } finally {
    await killStudio(server);
  }
});
