/** Handles of a region in the picture: dragging moves and resizes a box, a ball and a half-space, one step each; clipping and zooming. */

import { join } from 'node:path';
import { expect, type Page, test } from '@playwright/test';
import {
  chooseRegion,
  coverage,
  currentEdit,
  drag,
  type OpenStudio,
  openStudio,
  type Point,
  pictureFrame,
  waitUntilReady,
  waitUntilSaved,
} from './support/page';
import { OUT } from './support/studio-server';

type Box = { min: number[]; max: number[]; falloff: number };
type Half = { point: number[]; normal: number[] };
type Ball = { center: { vertex: number }; radius: number };

const region = async (page: Page) => (await currentEdit(page)).layers.at(-1)!.region as unknown;
const handle = (page: Page, name: string) => page.getByRole('button', { name, exact: true });

/** Drags a handle by pixels; `beforeRelease` is awaited before the pointer is lifted. */
async function pull(page: Page, name: string, dx: number, dy: number, beforeRelease?: () => Promise<void>) {
  const box = (await handle(page, name).boundingBox())!;
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const points: Point[] = [0, 0.3, 0.7, 1].map((t) => [x + t * dx, y + t * dy]);
  await drag(page, points, async () => {
    await page.waitForTimeout(80);
    await beforeRelease?.();
  });
  await waitUntilSaved(page);
  await page.waitForTimeout(50);
}

test.describe
  .serial('handles of regions', () => {
    let studio: OpenStudio;
    let page: Page;

    test.beforeAll(async ({ browser }) => {
      studio = await openStudio(browser, 'gizmo');
      ({ page } = studio);
      await page.keyboard.press('l');
      await page.keyboard.press('1');
    });

    test.afterAll(() => studio.end());

    test('a box is resized by its faces and moved by its center', async () => {
      await chooseRegion(page, 'box');
      await waitUntilSaved(page);
      const before = ((await region(page)) as { box: Box }).box;
      const all = await coverage(page);
      let during = 0;
      await pull(page, 'To x', -90, 0, async () => {
        during = await coverage(page);
      });
      const narrow = ((await region(page)) as { box: Box }).box;
      expect(narrow.max[0]).toBeLessThan(before.max[0]! - 0.05);
      expect({ ...narrow, max: narrow.max.with(0, 0) }).toEqual({ ...before, max: before.max.with(0, 0) });
      expect(during, 'the mask follows the handle').toBeLessThan(all);
      expect(await coverage(page), 'and stays when it is released').toBe(during);
      // From the front the third axis points at the viewer.
      await expect(handle(page, 'To z')).toBeHidden();
      await pull(page, 'Move the region', 60, -40);
      const moved = ((await region(page)) as { box: Box }).box;
      for (const end of ['min', 'max'] as const) {
        const by = moved[end].map((x, c) => x - narrow[end][c]!);
        expect(by[0]).toBeGreaterThan(0.05);
        expect(by[1]).toBeGreaterThan(0.03);
        expect(Math.abs(by[2]!)).toBeLessThan(1e-6);
      }
      await page.keyboard.press('Control+z');
      expect(((await region(page)) as { box: Box }).box, 'one step a drag').toEqual(narrow);
      await handle(page, 'To y').press('ArrowDown');
      const lower = ((await region(page)) as { box: Box }).box;
      expect(lower.max[1]).toBeLessThan(narrow.max[1]!);
      await handle(page, 'Move the region').press('ArrowUp');
      const higher = ((await region(page)) as { box: Box }).box;
      expect(higher.min[1], 'up in the picture').toBeGreaterThan(lower.min[1]!);
      expect(higher.min[0]).toBeCloseTo(lower.min[0]!, 9);
      await page.keyboard.press('3');
      await page.screenshot({ path: join(OUT, '23-box.png') });
      await page.keyboard.press('1');
    });

    test('a plane is moved and turned', async () => {
      await chooseRegion(page, 'half-space');
      await waitUntilSaved(page);
      const before = ((await region(page)) as { 'half-space': Half })['half-space'];
      await pull(page, 'Move the plane', 70, 30);
      const moved = ((await region(page)) as { 'half-space': Half })['half-space'];
      expect(moved.point[0]).toBeGreaterThan(before.point[0]! + 0.05);
      expect([moved.point[1], moved.normal]).toEqual([before.point[1], before.normal]);
      await pull(page, 'Turn the plane', -60, -80);
      const turned = ((await region(page)) as { 'half-space': Half })['half-space'];
      expect(Math.hypot(...turned.normal)).toBeCloseTo(1, 9);
      expect(turned.normal[1]).toBeGreaterThan(0.4);
      await handle(page, 'Turn the plane').press('ArrowDown');
      const back = ((await region(page)) as { 'half-space': Half })['half-space'];
      expect(back.normal[1], 'keys turn it too').toBeLessThan(turned.normal[1]!);
      await expect(page.getByLabel('Toward')).toHaveValue('tilted');
      await page.screenshot({ path: join(OUT, '24-plane.png') });
    });

    test('a ball is moved over the surface and resized', async () => {
      await chooseRegion(page, 'ball');
      await waitUntilSaved(page);
      await page.keyboard.press('1');
      const before = ((await region(page)) as { ball: Ball }).ball;
      await pull(page, 'Move the center', -20, 18);
      const moved = ((await region(page)) as { ball: Ball }).ball;
      expect(moved.center.vertex).not.toBe(before.center.vertex);
      expect(moved.radius).toBe(before.radius);
      // Arrow keys move the center over the surface, each to another vertex on that side.
      const center = async () => (await handle(page, 'Move the center').boundingBox())!;
      for (const [key, side, sign] of [
        ['ArrowUp', 'y', -1],
        ['ArrowLeft', 'x', -1],
        ['ArrowDown', 'y', 1],
        ['ArrowRight', 'x', 1],
      ] as const) {
        const [was, from] = [((await region(page)) as { ball: Ball }).ball.center.vertex, await center()];
        await handle(page, 'Move the center').press(key);
        expect(((await region(page)) as { ball: Ball }).ball.center.vertex, key).not.toBe(was);
        await page.waitForTimeout(150);
        expect(sign * ((await center())[side] - from[side]), key).toBeGreaterThan(1);
      }
      await waitUntilSaved(page);
      const all = await coverage(page);
      await pull(page, 'Radius', 60, 0);
      expect(((await region(page)) as { ball: Ball }).ball.radius).toBeGreaterThan(1.2 * before.radius);
      expect(await coverage(page)).toBeGreaterThan(all);
      await page.screenshot({ path: join(OUT, '25-ball.png') });
      await page.setViewportSize({ width: 390, height: 844 });
      await page.waitForTimeout(300);
      await page.screenshot({ path: join(OUT, '26-ball-390.png') });
      await page.setViewportSize({ width: 1200, height: 900 });
      await page.keyboard.press('b');
      await expect(handle(page, 'Move the center'), 'the brush needs the picture').toBeHidden();
      await page.keyboard.press('b');
    });

    test('a clipping plane cuts the picture and what is picked', async () => {
      await page.keyboard.press('1');
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      const { x, y } = await pictureFrame(page);
      const pick = async () => {
        await page.mouse.click(x, y);
        await page.waitForTimeout(200);
        await page.locator('.card output').waitFor();
        return page.locator('.card output').textContent();
      };
      const whole = await pick();
      const clip = page.getByRole('group', { name: 'Clip', exact: true });
      await clip.getByRole('button', { name: 'z' }).click();
      const cut = await pick();
      const depth = (line: string | null) =>
        Number(line!.match(/At .*, (\S+?)(Distance|$)/)![1]!.replace('−', '-'));
      expect(depth(cut), 'the surface behind the plane is picked').toBeLessThan(depth(whole) - 0.1);
      await page.waitForTimeout(300);
      await page.screenshot({ path: join(OUT, '27-clip.png') });
      await page.getByLabel('Keep the other side').check();
      expect(depth(await pick())).toBe(depth(whole));
      await page.keyboard.press('x');
      await expect(clip.locator('[aria-pressed="true"]')).toHaveText('Off');
      await page.keyboard.press('x');
      await page.reload();
      await waitUntilReady(page);
      await page.getByRole('tab', { name: 'View', exact: true }).click();
      await expect(clip.locator('[aria-pressed="true"]'), 'kept').toHaveText('z');
    });

    test('a view without the shape offers to fit it, and zooming ends at the size of an edge', async () => {
      await page.keyboard.press('f');
      const { x, y, size } = await pictureFrame(page);
      await page.mouse.move(x + 0.6 * size, y - 0.4 * size);
      for (let k = 0; k < 25; k++) await page.mouse.wheel(0, -600);
      await page.getByRole('button', { name: 'Fit view (F)' }).last().click();
      await page.mouse.move(x, y);
      for (let k = 0; k < 60; k++) {
        await page.mouse.wheel(0, -600);
        if (k % 10 === 0) await page.waitForTimeout(60);
      }
      await page.waitForTimeout(300);
      const bar = (await page.locator('.scale-bar').textContent())!;
      // The edges of this creature are about 0.018 units long.
      expect(Number(bar.match(/[\d.e−-]+ units/)![0].replace(' units', ''))).toBeGreaterThan(0.0003);
      await page.keyboard.press('f');
    });
  });
