/**
 * Steps back and forth on a shape that is large, with a server that answers at once: after each the picture is that of the present document
 * before the key press is over. A part of the tour of test/studio.mjs.
 */

import { fileURLToPath } from 'node:url';
import { opened } from './browser.mjs';
import { mockServer } from './mock.mjs';

/** More triangles than are drawn while something moves without a graphics processor. */
const VERTICES = 40_000;
/** Fewer triangles, each shaded for itself, differ from all of them by less than this part of what a step changes. */
const NEAR = 0.5;

/** In the page: pictures by name, taken at once after the keys, or by the next frame. */
function takePictures() {
  const canvas = document.querySelector('canvas.picture');
  const small = new OffscreenCanvas(200, 150);
  const context = small.getContext('2d', { willReadFrequently: true });
  const pictures = {};
  const press = (key, more = {}, type = 'keydown') =>
    document.body.dispatchEvent(new KeyboardEvent(type, { key, bubbles: true, cancelable: true, ...more }));
  const take = (name) => {
    context.drawImage(canvas, 0, 0, small.width, small.height);
    pictures[name] = context.getImageData(0, 0, small.width, small.height).data;
  };
  window.pictures = {
    /** Ctrl+Z or Ctrl+Shift+Z, and what is drawn when the event is over. */
    step(shiftKey, name) {
      press('z', { ctrlKey: true, shiftKey });
      take(name);
      return canvas.width;
    },
    /** What the next frame has. */
    rest(name) {
      press('\\');
      press('\\', {}, 'keyup');
      return new Promise((done) => requestAnimationFrame(() => done(take(name))));
    },
    /** Mean difference of a byte, in the part of the width from `from` to `to`. */
    differ(a, b, from = 0, to = 1) {
      let sum = 0;
      for (let i = 0; i < pictures[a].length; i++) {
        const x = ((i >> 2) % small.width) / small.width;
        if (x >= from && x < to) sum += Math.abs(pictures[a][i] - pictures[b][i]);
      }
      return sum / pictures[a].length;
    },
  };
}

export async function steps(browser, failures) {
  const check = (what, ok, detail = '') => {
    if (!ok) failures.push(`steps: ${what}: ${JSON.stringify(detail)}`);
  };
  const dist = process.env.STUDIO_DIST ?? fileURLToPath(new URL('../dist', import.meta.url));
  const { url, server } = await mockServer({ vertices: VERTICES, dist });
  const page = await opened(browser, url, failures);
  try {
    const still = async () => {
      await page.evaluate(() => window.studio.positions().then(() => {}));
      // All triangles are drawn again a moment after the last movement.
      await page.waitForTimeout(400);
    };
    const slide = (value, release = true) =>
      page.evaluate(
        ([to, last]) => {
          const input = [...document.querySelectorAll('.band input.gain')].at(-1);
          input.value = String(to);
          for (const type of last ? ['input', 'change'] : ['input'])
            input.dispatchEvent(new Event(type, { bubbles: true }));
        },
        [value, release],
      );
    const rest = async (name) => {
      await still();
      await page.evaluate((n) => window.pictures.rest(n), name);
    };
    const step = (redo, name) => page.evaluate(([r, n]) => window.pictures.step(r, n), [redo, name]);
    const differ = (...names) => page.evaluate((n) => window.pictures.differ(...n), names);
    /** Whether a picture shows one document rather than another. */
    const shows = async (what, name, is, not, ...part) => {
      const [near, far] = [await differ(name, is, ...part), await differ(name, not, ...part)];
      check(what, near < NEAR * far, [near, far]);
    };

    await page.evaluate(takePictures);
    await rest('opened');
    await slide(0);
    await rest('flat');
    await slide(190);
    await rest('bumpy');
    const width = await page.evaluate(() => document.querySelector('canvas.picture').width);
    check('a slider changes the picture', (await differ('flat', 'bumpy')) > 1, await differ('flat', 'bumpy'));

    // At rest: at once, in as many pixels, and after a moment to the bit what it was.
    check('a step keeps the pixels', (await step(false, 'back')) === width);
    await shows('undo is drawn at once', 'back', 'flat', 'bumpy');
    await rest('back at rest');
    check(
      'and comes to rest',
      (await differ('back at rest', 'flat')) === 0,
      await differ('back at rest', 'flat'),
    );
    await step(true, 'forth');
    await shows('redo is drawn at once', 'forth', 'bumpy', 'flat');

    // Two steps within a frame.
    await rest('forth at rest');
    await page.evaluate(() => window.pictures.step(false, 'one'));
    await step(false, 'two');
    await shows('the second of two steps is what is drawn', 'two', 'opened', 'bumpy');
    await step(true, 'one');
    await step(true, 'two');

    // While a slider is held, in fewer pixels: the gesture is ended and undone.
    await still();
    await slide(0, false);
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done))));
    const moving = await page.evaluate(() => document.querySelector('canvas.picture').width);
    check('fewer pixels while it moves', moving < width, [moving, width]);
    await step(false, 'held');
    await shows('undo within a gesture', 'held', 'bumpy', 'flat');
    await page.setViewportSize({ width: 1100, height: 900 });
    await rest('narrower');
    const narrower = await page.evaluate(() => {
      const canvas = document.querySelector('canvas.picture');
      return canvas.width - canvas.clientWidth;
    });
    check('all pixels of another window', narrower === 0, narrower);
    await page.setViewportSize({ width: 1200, height: 900 });

    // Before and after: only the right half is the edit's.
    await rest('whole');
    await page.keyboard.press('s');
    await rest('split');
    await step(false, 'split back');
    await shows('the left half is the shape as opened', 'split back', 'opened', 'bumpy', 0, 0.48);
    await shows('the right half is undone', 'split back', 'flat', 'bumpy', 0.52, 1);
    await rest('split back at rest');
    await shows('and stays so', 'split back at rest', 'flat', 'bumpy', 0.52, 1);
  } finally {
    await page.close();
    server.closeAllConnections();
    server.close();
  }
}
