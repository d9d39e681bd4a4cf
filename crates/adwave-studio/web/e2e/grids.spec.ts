/** Images, terrain and volumes: what is shown, what an edit changes, and the file that is saved. */

import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { join } from 'node:path';
import { type Browser, expect, type Page, test } from '@playwright/test';
import {
  clickUndo,
  currentEdit,
  dropFile,
  type OpenStudio,
  openStudio,
  setSlider,
  useTestBuild,
  waitForBands,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { decodePng, deviation, encodePng } from './support/png';
import { ADWAVE, creature, OUT } from './support/studio-server';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');

/** Rules of axe that the page breaks, with the elements. */
async function findings(page: Page): Promise<string[]> {
  await page.evaluate(AXE);
  return page.evaluate(async () => {
    const { axe } = window as unknown as {
      axe: { run(): Promise<{ violations: { id: string; nodes: { html: string }[] }[] }> };
    };
    const { violations } = await axe.run();
    return violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html).join(' ')}`);
  });
}

/** Values of the panes after the edit. */
const planes = (page: Page): Promise<number[][]> =>
  page.evaluate(async () => (await window.studio.planes()).map((plane) => [...plane]));

/** Recipe of the edit that the server stores. */
const recipe = (page: Page): Promise<string> =>
  page.evaluate(async () => {
    const headers = { Authorization: `Bearer ${sessionStorage.getItem('adwave-token')}` };
    return (await fetch('api/shapes/1/recipe', { headers })).text();
  });

/** Root mean square difference of numbers, places without data left out. */
function rms(a: readonly number[], b: readonly number[]): number {
  const squares = a.map((x, i) => (x - b[i]!) ** 2).filter((x) => !Number.isNaN(x));
  return Math.sqrt(squares.reduce((sum, x) => sum + x, 0) / squares.length);
}

/** Folder for the files of a test, so that results are saved into it. */
function folderFor(name: string): string {
  const folder = join(OUT, `${name}-${Date.now()}-files`);
  mkdirSync(folder, { recursive: true });
  return folder;
}

/** Saves by the menu, and compares the file with that of the command. */
async function expectSavedAsByCommand(
  page: Page,
  folder: string,
  opened: string,
  saved: string,
): Promise<void> {
  await waitUntilSaved(page);
  await page.keyboard.press('Control+s');
  await expect(page.locator('.toasts')).toContainText(saved);
  writeFileSync(join(folder, 'edit.toml'), await recipe(page));
  const args = ['filter', opened, '--recipe', 'edit.toml', '--quiet', '-o'];
  execFileSync(ADWAVE, [...args, `command-${saved}`], { cwd: folder, stdio: 'ignore' });
  const [ours, command] = [saved, `command-${saved}`].map((name) => readFileSync(join(folder, name)));
  expect(ours!.equals(command!), `${saved} has the bytes that the command writes`).toBe(true);
}

/** Opens a studio with another screen. */
async function reopen(browser: Browser, studio: OpenStudio, dark: boolean, width: number): Promise<Page> {
  const context = await browser.newContext({
    viewport: { width, height: 844 },
    colorScheme: dark ? 'dark' : 'light',
  });
  await useTestBuild(context);
  const page = await context.newPage();
  page.on('pageerror', (e) => studio.failures.push(e.message));
  await page.goto(studio.server.url);
  await waitUntilReady(page);
  return page;
}

test.describe('a color image', () => {
  let studio: OpenStudio;
  let page: Page;
  let folder: string;

  test.beforeAll(async ({ browser }) => {
    folder = folderFor('photo');
    const color = (x: number, y: number) => {
      const disk = Math.hypot(x - 90, y - 70) < 40 ? 60 : 0;
      const grain = ((x * 7919 + y * 104729) % 41) - 20;
      return [110 + disk + grain, 90 + Math.round(40 * Math.sin(x / 17)) + grain, 120 + grain - disk / 2];
    };
    writeFileSync(join(folder, 'photo.png'), encodePng(192, 144, color));
    studio = await openStudio(browser, 'photo', join(folder, 'photo.png'));
    ({ page } = studio);
    await waitForBands(page, 6);
  });
  test.afterAll(() => studio.end());

  test('is shown in color, without what only shapes have', async () => {
    await expect(page.locator('canvas.picture')).toBeHidden();
    for (const name of ['Layers', 'Brush']) await expect(page.getByRole('tab', { name })).toBeHidden();
    await expect(page.getByRole('button', { name: /^Wipe/ })).toBeVisible();
    await expect(page.getByRole('button', { name: 'Tools' })).toBeHidden();
    await expect(page.getByRole('button', { name: 'Color', exact: true })).toHaveAttribute(
      'aria-pressed',
      'true',
    );
    const box = (await page.locator('.pane canvas').boundingBox())!;
    const shot = decodePng(await page.screenshot({ path: join(OUT, '60-image.png') }));
    expect(deviation(shot, box)).toBeGreaterThan(20);
    expect(await findings(page)).toEqual([]);
  });

  test('follows a slider, and undo, redo and reset give back every value', async () => {
    const [before] = await planes(page);
    await setSlider(page, 0, 0);
    const [smooth] = await planes(page);
    expect(rms(smooth!, before!)).toBeGreaterThan(3);
    await clickUndo(page);
    expect((await planes(page))[0]).toEqual(before);
    await page.keyboard.press('Control+Shift+Z');
    expect((await planes(page))[0]).toEqual(smooth);
    await page.getByRole('button', { name: 'Reset' }).click();
    expect((await planes(page))[0]).toEqual(before);
    await page.locator('.band').first().getByRole('button', { name: /^Solo/ }).click();
    expect(rms((await planes(page))[0]!, before!)).toBeGreaterThan(1);
    await page.locator('.band').first().getByRole('button', { name: /^Solo/ }).click();
    expect((await planes(page))[0]).toEqual(before);
  });

  test('tells the value at a marked place, in the image and in the file', async () => {
    const box = (await page.locator('.pane canvas').boundingBox())!;
    await setSlider(page, 0, 50);
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    const facts = page.locator('#grid .facts').first();
    await expect(facts).toContainText('row 72, column 96');
    await expect(facts).toContainText('In the file');
    await page.mouse.move(box.x + 2, box.y + 2);
    await expect(facts).toContainText('row 72, column 96');
    await page.getByRole('button', { name: 'Enlarge' }).click();
    await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
    await expect(facts).toContainText('row 72, column 96');
    await page.getByRole('button', { name: 'Fit', exact: true }).click();
  });

  test('a window of values is a pair of numbers, and gray shows the first channel', async () => {
    await page.getByRole('button', { name: 'Gray' }).click();
    const low = page.getByRole('textbox', { name: 'Darkest' });
    await expect(low).toHaveValue('0');
    await page.getByRole('button', { name: /^Auto/ }).click();
    expect(Number(await low.inputValue())).toBeGreaterThan(30);
    await low.fill('100');
    await low.blur();
    await expect(low).toHaveValue('100');
    await page.getByRole('slider', { name: 'Brightest' }).focus();
    await page.keyboard.press('Home');
    // A window without width is refused.
    expect(Number(await page.getByRole('textbox', { name: 'Brightest' }).inputValue())).toBeGreaterThan(100);
    await page.getByRole('button', { name: 'Color', exact: true }).click();
  });

  test('an edit is there again after a reload, with its history', async () => {
    const { layers } = await currentEdit(page);
    await waitUntilSaved(page);
    await page.reload();
    await waitUntilReady(page);
    expect((await currentEdit(page)).layers[0]!.gains).toEqual(layers[0]!.gains);
    await expect(page.locator('#grid .facts').last()).not.toContainText('Max change0');
    await expect(page.getByRole('button', { name: /^Undo/ })).toBeEnabled();
  });

  test('other bands keep the gains at their widths', async () => {
    await page.getByRole('button', { name: 'Bands', exact: true }).click();
    await page.getByLabel('Choose bands').selectOption('lengths');
    await page.getByRole('dialog').getByRole('textbox').fill('1, 3, 9');
    await page.getByRole('button', { name: 'Apply' }).click();
    await expect(page.locator('.band')).toHaveCount(3);
    await waitForBands(page, 3);
    await expect(page.locator('.sigma').nth(1)).toHaveText('3');
    await clickUndo(page);
    await expect(page.locator('.band')).not.toHaveCount(3);
    await waitUntilSaved(page);
  });

  test('a saved image has the bytes that the command writes', async () => {
    await expectSavedAsByCommand(page, folder, 'photo.png', 'photo-edited.png');
  });

  test('a shape opens beside it, and both keep their parts of the page', async () => {
    await dropFile(page, 'creature.ply', readFileSync(creature(5000)));
    await expect(page.locator('canvas.picture')).toBeVisible();
    await expect(page.locator('.pane')).toBeHidden();
    await expect(page.getByRole('tab', { name: 'Brush' })).toBeVisible();
    await waitForBands(page);
    await page.getByRole('button', { name: 'photo.png', exact: true }).click();
    await expect(page.locator('.pane canvas')).toBeVisible();
    await expect(page.getByRole('tab', { name: 'Brush' })).toBeHidden();
    expect((await planes(page))[0]!.length).toBe(3 * 192 * 144);
  });
});

test.describe('a terrain', () => {
  let studio: OpenStudio;
  let page: Page;
  let folder: string;

  test.beforeAll(async ({ browser }) => {
    folder = folderFor('terrain');
    const asc = Array.from({ length: 120 }, (_, r) =>
      Array.from({ length: 160 }, (_, c) => {
        if (Math.hypot(r - 20, c - 130) < 18) return -9999;
        const hills = 60 * Math.sin(r / 19) * Math.cos(c / 23) + 20 * Math.sin((r + c) / 9);
        return (300 + hills + ((r * 7919 + c * 104729) % 17) / 4).toFixed(2);
      }).join(' '),
    );
    const head = 'ncols 160\nnrows 120\nxllcorner 5000\nyllcorner 9000\ncellsize 10\nNODATA_value -9999\n';
    writeFileSync(join(folder, 'hills.asc'), `${head}${asc.join('\n')}\n`);
    studio = await openStudio(browser, 'terrain', join(folder, 'hills.asc'));
    ({ page } = studio);
    await waitForBands(page, 5);
  });
  test.afterAll(() => studio.end());

  test('is a relief, with flat colors as another choice', async () => {
    await expect(page.getByRole('button', { name: 'Relief' })).toHaveAttribute('aria-pressed', 'true');
    const canvas = page.locator('.pane canvas');
    const box = (await canvas.boundingBox())!;
    const relief = decodePng(await page.screenshot({ path: join(OUT, '61-terrain.png') }));
    expect(deviation(relief, box)).toBeGreaterThan(15);
    await page.getByRole('slider', { name: 'Height of the relief' }).fill('-40');
    const flat = decodePng(await page.screenshot());
    expect(deviation(flat, { ...box, x: box.x + 120, y: box.y + 200, width: 200, height: 200 })).toBeLessThan(
      deviation(relief, { ...box, x: box.x + 120, y: box.y + 200, width: 200, height: 200 }),
    );
    await page.getByRole('button', { name: 'Color map' }).click();
    await page.screenshot({ path: join(OUT, '62-terrain-map.png') });
    expect(await findings(page)).toEqual([]);
  });

  test('places without data are named and stay without', async () => {
    await expect(page.locator('#grid')).toContainText('Places without data');
    const n = (list: readonly number[]) => list.filter(Number.isNaN).length;
    const [before] = await planes(page);
    expect(n(before!)).toBeGreaterThan(900);
    await setSlider(page, 1, 0);
    expect(n((await planes(page))[0]!)).toBe(n(before!));
    // The place in the middle of the gap.
    const box = (await page.locator('.pane canvas').boundingBox())!;
    const pitch = Math.min((0.94 * box.width) / 160, (0.94 * box.height) / 120);
    await page.mouse.click(box.x + box.width / 2 + 50.5 * pitch, box.y + box.height / 2 - 39.5 * pitch);
    const facts = page.locator('#grid .facts').first();
    await expect(facts).toContainText('row 20, column 130');
    await expect(facts).toContainText('no data');
  });

  test('a saved terrain has the bytes that the command writes', async () => {
    await expectSavedAsByCommand(page, folder, 'hills.asc', 'hills-edited.asc');
  });
});

test.describe('a volume', () => {
  let studio: OpenStudio;
  let page: Page;
  let folder: string;
  const facts = () => page.locator('#grid .facts').first();

  test.beforeAll(async ({ browser }) => {
    folder = folderFor('volume');
    execFileSync(ADWAVE, ['sample', 'head', '--quiet', '-o', join(folder, 'head.nii.gz')]);
    studio = await openStudio(browser, 'volume', join(folder, 'head.nii.gz'));
    ({ page } = studio);
    await waitForBands(page, 5);
  });
  test.afterAll(() => studio.end());

  test('is three slices by the axes of the body', async () => {
    await expect(page.locator('.grid-panes figcaption')).toHaveText(['Axial', 'Coronal', 'Sagittal']);
    await expect(page.locator('.edge.left').first()).toHaveText('L');
    const shot = decodePng(await page.screenshot({ path: join(OUT, '63-volume.png') }));
    for (const pane of await page.locator('.pane canvas').all())
      expect(deviation(shot, (await pane.boundingBox())!)).toBeGreaterThan(10);
    expect(await findings(page)).toEqual([]);
  });

  test('a press in one slice moves the others, and names the place', async () => {
    const before = await planes(page);
    const coronal = page.locator('.pane canvas').nth(1);
    const box = (await coronal.boundingBox())!;
    const indices = async () => ((await facts().textContent()) ?? '').match(/z \d+, y \d+, x \d+/)![0];
    const from = await indices();
    await page.mouse.move(box.x + box.width * 0.5, box.y + box.height * 0.5);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.6, box.y + box.height * 0.35, { steps: 4 });
    await page.mouse.up();
    const after = await planes(page);
    expect(after[1], 'the slice that was pressed stays').toEqual(before[1]);
    expect(after[0]).not.toEqual(before[0]);
    expect(after[2]).not.toEqual(before[2]);
    const to = await indices();
    expect(to).not.toBe(from);
    expect(to.split(', ')[1], 'y is fixed in a coronal slice').toBe(from.split(', ')[1]);
    await expect(facts()).toContainText('Position, mm');
    await coronal.focus();
    await page.keyboard.press('PageUp');
    await expect.poll(indices).not.toBe(to);
    expect((await planes(page))[1]).not.toEqual(before[1]);
    await page.getByRole('slider', { name: 'Coronal' }).focus();
    await page.keyboard.press('ArrowLeft');
    await expect.poll(indices).toBe(to);
  });

  test('follows a slider in all slices, and the original is shown while a key is held', async () => {
    const before = await planes(page);
    await setSlider(page, 0, 0);
    const after = await planes(page);
    for (const [k, plane] of after.entries()) expect(rms(plane, before[k]!)).toBeGreaterThan(0);
    await page.locator('.pane canvas').first().focus();
    await page.keyboard.down('\\');
    await expect(page.locator('.badge')).toBeVisible();
    await page.screenshot({ path: join(OUT, '64-volume-before.png') });
    await page.keyboard.up('\\');
    await expect(page.locator('.badge')).toBeHidden();
    expect(await planes(page)).toEqual(after);
  });

  test('a saved volume has the bytes that the command writes', async () => {
    await expectSavedAsByCommand(page, folder, 'head.nii.gz', 'head-edited.nii.gz');
  });

  test('the panel has no faults in dark mode and on a narrow screen', async ({ browser }) => {
    const dark = await reopen(browser, studio, true, 1100);
    expect(await findings(dark)).toEqual([]);
    await dark.screenshot({ path: join(OUT, '65-volume-dark.png') });
    await dark.context().close();
    const phone = await reopen(browser, studio, false, 390);
    await phone.getByRole('tab', { name: 'View' }).click();
    await expect(phone.locator('#grid')).toBeVisible();
    await phone.screenshot({ path: join(OUT, '66-volume-narrow.png') });
    expect(await findings(phone)).toEqual([]);
    await phone.context().close();
  });
});

test.describe('a series of volumes', () => {
  let studio: OpenStudio;
  let page: Page;
  let folder: string;
  const slider = () => page.getByRole('slider', { name: 'Frame', exact: true });
  const label = () => page.locator('.grid-panes .frame-bar output');
  const facts = () => page.locator('#grid .facts').first();

  test.beforeAll(async ({ browser }) => {
    folder = folderFor('series');
    execFileSync(ADWAVE, ['sample', 'bold', '--quiet', '-o', join(folder, 'bold.nii.gz')]);
    studio = await openStudio(browser, 'series', join(folder, 'bold.nii.gz'));
    ({ page } = studio);
    await waitForBands(page, 3);
  });
  test.afterAll(() => studio.end());

  test('shows one frame in three slices, and the slider chooses it', async () => {
    await expect(page.locator('.grid-panes figcaption')).toHaveText(['Axial', 'Coronal', 'Sagittal']);
    await expect(label()).toHaveText('1 of 90, 0 s');
    const first = await planes(page);
    const [xy, xz, yz] = first.map((plane) => plane.length) as [number, number, number];
    // Sizes of three slices of one volume.
    expect(Number.isInteger(Math.sqrt((xy * xz) / yz)), `${xy}, ${xz}, ${yz}`).toBe(true);
    await slider().fill('5');
    await expect(label()).toHaveText('6 of 90, 10 s');
    const sixth = await planes(page);
    for (const [k, plane] of sixth.entries()) expect(rms(plane, first[k]!)).toBeGreaterThan(0);
    await expect(facts()).toContainText('6 of 90, 10 s');
    await expect(page.locator('#grid .facts').last()).toContainText('90, one every 2 s');
    await page.screenshot({ path: join(OUT, '67-series.png') });
    expect(await findings(page)).toEqual([]);
    await page.locator('.pane canvas').first().focus();
    await page.keyboard.press('.');
    await expect(label()).toHaveText('7 of 90, 12 s');
    for (let k = 0; k < 6; k++) await page.keyboard.press(',');
    await expect(label()).toHaveText('1 of 90, 0 s');
    expect(await planes(page)).toEqual(first);
  });

  test('gains act on all frames', async () => {
    const read = async () => {
      const list: number[][] = [];
      for (const frame of ['0', '5']) {
        await slider().fill(frame);
        list.push((await planes(page))[0]!);
      }
      return list;
    };
    const before = await read();
    await setSlider(page, 0, 0);
    const after = await read();
    for (const [k, plane] of after.entries()) expect(rms(plane, before[k]!)).toBeGreaterThan(0.1);
    expect(after[0]).not.toEqual(after[1]);
  });

  test('plays with one request for each pane at a time, and no pane is ever empty', async () => {
    const { mostRequests, nEmpty, nFrames } = await page.evaluate(async () => {
      const plainFetch = window.fetch;
      const loading = new Map<string, number>();
      let mostRequests = 0;
      window.fetch = async (...request) => {
        const axes = /plane\?axes=(\d,\d)/.exec(String(request[0]))?.[1] ?? '';
        const count = (by: number) => loading.set(axes, (loading.get(axes) ?? 0) + by);
        count(1);
        if (axes) mostRequests = Math.max(mostRequests, loading.get(axes)!);
        const response = await plainFetch(...request);
        const read = response.arrayBuffer.bind(response);
        response.arrayBuffer = () => read().finally(() => count(-1));
        return response;
      };
      const button = document.querySelector<HTMLButtonElement>('.grid-panes .frame-bar button')!;
      const output = document.querySelector('.grid-panes .frame-bar output')!;
      const canvases = [...document.querySelectorAll<HTMLCanvasElement>('.pane canvas')];
      const isEmpty = (canvas: HTMLCanvasElement) =>
        canvas.getContext('2d')!.getImageData(canvas.width >> 1, canvas.height >> 1, 1, 1).data[3] === 0;
      const shown = new Set<string>();
      let nEmpty = 0;
      button.click();
      const end = performance.now() + 2000;
      while (performance.now() < end) {
        await new Promise(requestAnimationFrame);
        nEmpty += canvases.filter(isEmpty).length;
        shown.add(output.textContent!);
      }
      button.click();
      window.fetch = plainFetch;
      return { mostRequests, nEmpty, nFrames: shown.size };
    });
    expect(mostRequests).toBe(1);
    expect(nEmpty).toBe(0);
    expect(nFrames).toBeGreaterThan(3);
    await expect(page.getByRole('button', { name: 'Play the frames' })).toBeVisible();
    const still = await label().textContent();
    await page.waitForTimeout(300);
    expect(await label().textContent()).toBe(still);
  });

  test('the frame is there again after a reload', async () => {
    await slider().fill('33');
    const before = await planes(page);
    await waitUntilSaved(page);
    await page.reload();
    await waitUntilReady(page);
    await expect(label()).toHaveText('34 of 90, 66 s');
    expect(await planes(page)).toEqual(before);
  });

  test('a shape that opens beside it has no slider over frames', async () => {
    await dropFile(page, 'creature.ply', readFileSync(creature(5000)));
    await expect(page.locator('canvas.picture')).toBeVisible();
    await expect(slider()).toBeHidden();
    await page.getByRole('button', { name: 'bold.nii.gz', exact: true }).click();
    await expect(label()).toHaveText('34 of 90, 66 s');
    await expect(slider()).toBeVisible();
  });

  test('a saved series has the bytes that the command writes', async () => {
    await expectSavedAsByCommand(page, folder, 'bold.nii.gz', 'bold-edited.nii.gz');
  });
});
