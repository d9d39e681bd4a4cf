/** The whole edit as a list: layers with their presets, clones, pins and handles, and fields. */

import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  askServer,
  clickUndo,
  currentEdit,
  dropFile,
  type OpenStudio,
  openStudio,
  saveShape,
  setSlider,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { ADWAVE, creature, OUT } from './support/studio-server';

/** An NPY of version 1 with one 64-bit number for each of `n` vertices. */
function npy(n: number, value: (k: number) => number): Buffer {
  const head = `${`{'descr': '<f8', 'fortran_order': False, 'shape': (${n},), }`.padEnd(117)}\n`;
  const values = Buffer.from(Float64Array.from({ length: n }, (_, k) => value(k)).buffer);
  return Buffer.concat([
    Buffer.from('\x93NUMPY\x01\x00', 'latin1'),
    Buffer.from([118, 0]),
    Buffer.from(head),
    values,
  ]);
}

test.describe
  .serial('the list of the edit', () => {
    let studio: OpenStudio;
    let page: Page;
    const list = () => page.getByRole('list', { name: 'On top of the layers' });
    const item = (name: string) => list().getByRole('listitem').filter({ hasText: name });
    const layer = () => page.getByRole('list', { name: 'Layers' }).getByRole('listitem').first();
    const presets = () => page.getByLabel('Presets');
    const path = creature(5000);

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'list', path);
      ({ page } = studio);
    });

    test.afterAll(() => studio.end());

    test('the active preset is shown, and how many bands have changed since', async () => {
      await presets().selectOption({ label: 'Enhance' });
      await expect(presets().locator('option:checked')).toHaveText('Enhance');
      await expect(layer()).toHaveText(/Layer 1Enhance$/);
      await setSlider(page, 2, 10);
      await setSlider(page, 4, 150);
      await expect(presets().locator('option:checked')).toHaveText('Enhance, 2 bands changed');
      await expect(layer()).toContainText('Enhance, 2 bands changed');
      await waitUntilSaved(page);
      await page.reload();
      await waitUntilReady(page);
      await expect(presets().locator('option:checked'), 'after a reload').toHaveText(
        'Enhance, 2 bands changed',
      );
      await page.screenshot({ path: join(OUT, '70-preset.png') });
      await clickUndo(page);
      await expect(layer()).toContainText('Enhance, 1 band changed');
      await clickUndo(page);
      await expect(layer()).toHaveText(/Enhance$/);
      await page.getByRole('button', { name: 'Reset', exact: true }).click();
      await expect(presets().locator('option:checked')).toHaveText('Presets');
      await setSlider(page, 0, 150);
      await expect(layer()).toContainText('1 band changed');
      await expect(presets().locator('option:checked')).toHaveText('Presets');
    });

    test('clones, pins and handles have eyes, names and an order, and are removed one by one', async () => {
      await waitUntilSaved(page);
      const edit = await currentEdit(page);
      const clone = (source: number, target: number) => ({
        source,
        targets: [target],
        radius: '6%',
      });
      const handle = (vertex: number, z: number) => ({
        by: [0, 0, z],
        region: { vertices: { indices: [vertex], radius: 0 } },
      });
      const pose = {
        fixed: { any: [{ ball: { center: { vertex: 7 }, radius: '8%' } }] },
        handle: [handle(2000, 0.1), handle(3000, -0.1)],
      };
      const whole = { ...edit, clones: [clone(10, 900), clone(400, 905)], pose };
      await dropFile(page, 'whole.edit.json', JSON.stringify(whole));
      await expect(list().getByRole('listitem')).toHaveCount(5);
      await waitUntilSaved(page);
      const all = await page.locator('.readouts').textContent();
      await page.screenshot({ path: join(OUT, '71-list.png') });
      // An eye.
      await item('Handle 2').getByRole('button', { name: 'Turn Handle 2 off' }).click();
      await waitUntilSaved(page);
      await expect(page.locator('.readouts')).not.toHaveText(all!);
      expect((await currentEdit(page)).pose!.handle.map((one) => one.on)).toEqual([undefined, false]);
      expect(JSON.parse(await askServer(page, 'edit')).pose.handle[1].on).toBe(false);
      expect((await askServer(page, 'recipe')).match(/\[\[pose\.handle\]\]/g)).toHaveLength(1);
      await item('Pins').getByRole('button', { name: 'Turn Pins off' }).click();
      await waitUntilSaved(page);
      expect(await askServer(page, 'recipe')).not.toContain('fixed');
      await clickUndo(page);
      // A name.
      await item('Clone 1').locator('.name').dblclick();
      await list().getByRole('textbox').fill('nose');
      await page.keyboard.press('Enter');
      await expect(item('nose')).toBeVisible();
      // The order.
      await item('nose').getByRole('button', { name: 'Move nose down' }).click();
      await waitUntilSaved(page);
      expect((await currentEdit(page)).clones!.map(({ source }) => source)).toEqual([400, 10]);
      await expect(item('nose').getByRole('button', { name: 'Move nose down' })).toHaveCount(0);
      await item('Clone 1').getByRole('button', { name: 'Turn Clone 1 off' }).click();
      await waitUntilSaved(page);
      // The saved file is what the command makes of the recipe.
      const saved = await saveShape(page, 'listed.ply');
      const recipe = join(studio.folder, 'listed.toml');
      writeFileSync(recipe, await askServer(page, 'recipe'));
      const replayed = join(studio.folder, 'replayed.ply');
      execFileSync(ADWAVE, ['filter', path, '-o', replayed, '--recipe', recipe, '--quiet']);
      expect(readFileSync(saved).equals(readFileSync(replayed)), 'the bytes of the command').toBe(true);
      // All of it is there after a reload.
      const before = await currentEdit(page);
      await page.reload();
      await waitUntilReady(page);
      expect(await currentEdit(page)).toEqual(before);
      await expect(item('nose')).toBeVisible();
      await expect(item('Clone 1').getByRole('button', { name: 'Turn Clone 1 on' })).toBeVisible();
      // Removal of one item, and its return.
      await item('Handle 1').getByRole('button', { name: 'Delete Handle 1' }).click();
      expect((await currentEdit(page)).pose!.handle).toHaveLength(1);
      await clickUndo(page);
      expect((await currentEdit(page)).pose!.handle).toHaveLength(2);
      // A hidden handle is not pulled or shown; undo goes back to the start.
      for (let k = 0; k < 5; k++) await clickUndo(page);
      await expect(list()).toBeHidden();
      await waitUntilSaved(page);
    });

    test('edits of fields are items too', async () => {
      const n = 4948;
      await dropFile(
        page,
        'heat.npy',
        npy(n, (k) => Math.sin(k / 50)),
      );
      await expect(page.locator('.legend')).toContainText('heat');
      await page.locator('.target').getByRole('button', { name: 'heat' }).click();
      await expect(page.locator('.band input.gain').first()).toBeEnabled();
      await setSlider(page, 0, 0);
      await setSlider(page, 1, 0);
      await waitUntilSaved(page);
      await page.getByRole('tab', { name: 'Layers' }).click();
      await expect(item('Field heat')).toContainText('2 bands changed');
      const edited = await askServer(page, 'edited-field?name=heat&format=csv');
      await item('Field heat').getByRole('button', { name: 'Turn Field heat off' }).click();
      await waitUntilSaved(page);
      const plain = await askServer(page, 'edited-field?name=heat&format=csv');
      expect(plain === edited).toBe(false);
      expect(Number(plain.trim().split('\n').at(-1))).toBeCloseTo(Math.sin((n - 1) / 50), 12);
      await expect(page.locator('.readouts')).toContainText(/Max change0/);
      await page.screenshot({ path: join(OUT, '72-field-item.png') });
      await clickUndo(page);
      await waitUntilSaved(page);
      expect(await askServer(page, 'edited-field?name=heat&format=csv')).toBe(edited);
      await item('Field heat').getByRole('button', { name: 'Delete Field heat' }).click();
      await waitUntilSaved(page);
      expect((await currentEdit(page)).fields).toEqual([]);
    });
  });
