/** Graphs and curves: where they are drawn, fields on their nodes, and files that equal those of the command. */

import { execFileSync } from 'node:child_process';
import { mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  askServer,
  clickUndo,
  currentEdit,
  drag,
  dropFile,
  openStudio,
  pictureFrame,
  setSlider,
  startPainting,
  waitForBands,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { ADWAVE, OUT } from './support/studio-server';

/** Rows and columns of the lattice. */
const SIDE = 20;

/** Folder with a lattice as a list of edges, and with a curve. */
function filesFor(name: string): string {
  const folder = join(OUT, `${name}-${Date.now()}-files`);
  mkdirSync(folder, { recursive: true });
  const edges: string[] = [];
  for (let k = 0; k < SIDE * SIDE; k++) {
    if (k % SIDE > 0) edges.push(`${k - 1} ${k}`);
    if (k >= SIDE) edges.push(`${k - SIDE} ${k}`);
  }
  writeFileSync(join(folder, 'lattice.edgelist'), `${edges.join('\n')}\n`);
  const points = Array.from({ length: 400 }, (_, k) => {
    const t = k / 30;
    return `v ${Math.cos(t) + 0.02 * Math.sin(2.7 * k)} ${Math.sin(t)} ${t / 6}`;
  });
  const line = `l ${points.map((_, k) => k + 1).join(' ')}`;
  writeFileSync(join(folder, 'wire.obj'), `${[...points, line].join('\n')}\n`);
  return folder;
}

/** Three frames of values on the lattice, as a table. */
function frames(): string {
  const row = (k: number) => {
    const [r, c] = [Math.floor(k / SIDE), k % SIDE];
    return [0, 1, 2].map((f) => Math.sin((r + c) / 4 + f) + 0.5 * ((k * 7919) % 13 > 6 ? 1 : 0));
  };
  const rows = Array.from({ length: SIDE * SIDE }, (_, k) => row(k).join(','));
  return `day 1,day 2,day 3\n${rows.join('\n')}\n`;
}

const fieldValues = (page: Page) => page.evaluate(async () => [...(await window.studio.fieldValues())!]);

const target = (page: Page) => page.getByRole('group', { name: 'Edit', exact: true });

test('a graph is placed in the plane, and its fields are edited', async ({ browser }) => {
  const folder = filesFor('graph');
  const studio = await openStudio(browser, 'graph', join(folder, 'lattice.edgelist'));
  const { page } = studio;
  await waitForBands(page, 3);
  await page.screenshot({ path: join(OUT, '60-graph.png') });
  await expect(page.locator('.readouts')).toContainText('Edges');
  await expect(page.locator('.legend')).toContainText('degree');
  await expect(target(page).getByRole('button', { name: 'Positions' })).toBeHidden();
  await expect(page.locator('.scale-bar'), 'places have no unit').toBeHidden();
  await expect(page.locator('.toolbar button:visible')).toHaveCount(2);

  // The picture of a flat graph is moved by a drag, never turned.
  const { x, y, size } = await pictureFrame(page);
  const picture = page.locator('canvas.picture');
  await drag(page, [
    [x, y],
    [x + 0.2 * size, y],
  ]);
  await page.keyboard.press('7');
  await page.waitForTimeout(400);
  await page.screenshot({ path: join(OUT, '61-graph-moved.png') });
  await page.keyboard.press('f');

  // A file of values is edited at once, and its frames can be chosen.
  await dropFile(page, 'load.csv', frames());
  await expect(target(page)).toContainText('load');
  await waitForBands(page, 3);
  await expect(page.locator('.frame-bar')).toContainText('1 of 3');
  const before = await fieldValues(page);
  expect(before).toHaveLength(SIDE * SIDE);
  await page.waitForTimeout(300);
  const noisy = await picture.screenshot();
  await setSlider(page, 0, 0);
  await setSlider(page, 1, 20);
  await waitUntilSaved(page);
  const after = await fieldValues(page);
  expect(after.filter((v, k) => Math.abs(v - before[k]!) > 0.05).length).toBeGreaterThan(SIDE);
  await page.waitForTimeout(300);
  expect((await picture.screenshot()).equals(noisy), 'other colors').toBe(false);

  // The values are those of the command.
  const { field } = (await currentEdit(page)).fields![0]!;
  const query = encodeURIComponent(field);
  writeFileSync(join(folder, 'values.csv'), frames());
  writeFileSync(join(folder, 'edit.toml'), await askServer(page, `recipe?field=${query}`));
  const signal = `values.csv:${field.replace('load ', '')}`;
  const args = ['filter', 'lattice.edgelist', '--signal', signal, '--recipe', 'edit.toml', '--quiet'];
  execFileSync(ADWAVE, [...args, '-o', 'out.csv'], { cwd: folder, stdio: 'ignore' });
  const ours = (await askServer(page, `edited-field?name=${query}&format=csv`)).split('\n');
  const command = readFileSync(join(folder, 'out.csv'), 'utf8').split('\n');
  expect(ours.slice(1)).toEqual(command.slice(1));

  // A brush reaches along the edges, and undo takes the stroke back.
  await startPainting(page);
  const along = (k: number): [number, number] => [x + 0.004 * size * k, y + 0.002 * size * k];
  // Over more than a node.
  await drag(
    page,
    Array.from({ length: 40 }, (_, k) => along(k)),
  );
  await waitUntilSaved(page);
  const painted = await page.evaluate(async () => [...(await window.studio.mask())]);
  const n = painted.filter((w) => w > 0).length;
  expect(n).toBeGreaterThan(2);
  expect(n).toBeLessThan((SIDE * SIDE) / 2);
  await page.screenshot({ path: join(OUT, '62-graph-brush.png') });
  await clickUndo(page);
  await waitUntilSaved(page);
  expect((await currentEdit(page)).fields![0]!.layers).toHaveLength(1);

  // The next visit shows the same field and its edit.
  await page.reload();
  await waitUntilReady(page);
  await expect(target(page)).toContainText(field);
  await waitForBands(page, 3);
  expect(await fieldValues(page)).toEqual(after);
  await studio.end();
});

test('a click on a node tells its name', async ({ browser }) => {
  const folder = filesFor('named');
  // The hub of a star is placed in the middle.
  const leaves = ['TP53', 'EGFR', 'KRAS', 'BRAF', 'PTEN', 'ALK'];
  writeFileSync(join(folder, 'star.edgelist'), leaves.map((leaf) => `<b>MYC</b> ${leaf}\n`).join(''));
  const studio = await openStudio(browser, 'named', join(folder, 'star.edgelist'));
  const { page } = studio;
  await waitForBands(page, 1);
  const { x, y } = await pictureFrame(page);
  await page.mouse.click(x, y);
  await expect(page.locator('.card')).toContainText('<b>MYC</b> · Vertex 0');
  await page.screenshot({ path: join(OUT, '65-graph-name.png') });
  await studio.end();
});

test('a curve is smoothed, and saved as the command writes it', async ({ browser }) => {
  const folder = filesFor('curve');
  const studio = await openStudio(browser, 'curve', join(folder, 'wire.obj'));
  const { page } = studio;
  await waitForBands(page, 3);
  await page.screenshot({ path: join(OUT, '63-curve.png') });
  const before = await page.evaluate(async () => [...(await window.studio.positions())]);
  await setSlider(page, 0, 0);
  await setSlider(page, 1, 0);
  await waitUntilSaved(page);
  await expect(page.locator('.readouts')).toContainText('Max displacement');
  const after = await page.evaluate(async () => [...(await window.studio.positions())]);
  expect(after.filter((v, k) => Math.abs(v - before[k]!) > 0.005).length).toBeGreaterThan(100);
  await page.screenshot({ path: join(OUT, '64-curve-smooth.png') });
  await page.keyboard.press('Control+s');
  await expect(page.locator('.toasts')).toContainText('wire-edited.obj');
  writeFileSync(join(folder, 'edit.toml'), await askServer(page, 'recipe'));
  const args = ['filter', 'wire.obj', '--recipe', 'edit.toml', '--quiet', '-o', 'command.obj'];
  execFileSync(ADWAVE, args, { cwd: folder, stdio: 'ignore' });
  const [saved, command] = ['wire-edited.obj', 'command.obj'].map((name) => readFileSync(join(folder, name)));
  expect(saved!.equals(command!), 'equal bytes').toBe(true);
  // A curve has no surface to compare, and can be denoised.
  await page.getByRole('button', { name: 'Tools', exact: true }).click();
  await expect(page.getByRole('button', { name: 'Taubin' })).toBeHidden();
  await expect(page.getByRole('heading', { name: 'Denoise' })).toBeVisible();
  await page.keyboard.press('Escape');
  await studio.end();
});
