import { describe, expect, test } from 'vitest';
import { appendStroke } from '../brush';
import type { Region } from '../protocol';
import type { BrushShape } from './messages';
import { Painter } from './painter';
import { computeMask, smoothstep, weights } from './regions';
import { ground, random, sheet } from './testing';
import { packBefore, unpackBefore } from './undo-packing';

const BRUSH: BrushShape = { radius: 1, falloff: 1, strength: 1, mode: 'add', facing: null, mirror: null };

describe('regions and strokes', () => {
  const stamp = (indices: number[], radius: number, factor = 1): Region => {
    const stamps: Region = { vertices: { indices, radius } };
    return factor < 1 ? { faded: { factor, region: stamps } } : stamps;
  };

  test('the rise is 0 and 1 with flat ends, and symmetric', () => {
    expect([smoothstep(-1), smoothstep(0), smoothstep(0.5), smoothstep(1), smoothstep(2)]).toEqual([
      0, 0, 0.5, 1, 1,
    ]);
    expect(smoothstep(0.3) + smoothstep(0.7)).toBeCloseTo(1, 12);
  });

  test('painted, not, any, all are largest and smallest', async () => {
    const g = ground(sheet(12));
    const a = stamp([20], 0.4);
    const b = stamp([90], 0.5, 0.5);
    const [wa, wb] = [weights(a, g), weights(b, g)];
    const both = weights({ painted: [{ add: a }, { subtract: b }] }, g);
    const any = weights({ any: [a, b] }, g);
    const all = weights({ all: [a, { not: b }] }, g);
    for (let v = 0; v < g.n; v++) {
      expect(any[v]).toBe(Math.max(wa[v]!, wb[v]!));
      expect(both[v]).toBeCloseTo(Math.min(wa[v]!, 1 - wb[v]!), 6);
      expect(all[v]).toBeCloseTo(both[v]!, 6);
    }
    expect(wa[20]).toBe(1);
    expect(Math.max(...wb)).toBe(0.5);
  });

  test('what is not known here is asked for', async () => {
    const g = ground(sheet(3));
    const field = { field: { name: 'x', low: 0, high: 1 } };
    const blurred = { blurred: { by: 0.1, region: stamp([1], 0.2) } };
    for (const region of [field, { not: { any: [field] } }, blurred, { painted: [{ add: blurred }] }]) {
      await expect(computeMask(region, g)).rejects.toThrow('asked');
    }
    // The server has its own neighbor graph of clouds.
    await expect(computeMask(stamp([1], 0.2), { ...g, local: false })).rejects.toThrow('asked');
    expect((await computeMask(stamp([1], 0.2), g))[1]).toBe(255);
  });

  test('a mask after strokes equals the region from scratch; undo and redo give back every byte', async () => {
    const s = sheet(24, 0.01);
    const g = ground(s);
    const next = random(3);
    const painter = new Painter(g, s.positions, () => {});
    painter.updateRegions([[0, { painted: [] }]]);
    await painter.show(7, 0);
    const strokes: ({ add: Region } | { subtract: Region })[] = [];
    const masks = [painter.mask(7)!.slice()];
    for (let id = 1; id <= 30; id++) {
      const subtract = id % 3 === 0;
      const radius = 0.05 + 0.2 * next();
      const strength = id % 4 ? 1 : 0.6;
      const mode = subtract ? 'subtract' : 'add';
      const brush: BrushShape = { radius, falloff: radius, strength, mode, facing: null, mirror: null };
      const at = Math.floor(next() * s.n);
      painter.stamp(7, [at, (at + 3) % s.n, (at + 40) % s.n], brush);
      painter.stamp(7, [(at + 60) % s.n], brush);
      const region = stamp(painter.end(id), radius, strength);
      strokes.push(subtract ? { subtract: region } : { add: region });
      painter.updateRegions([[id, { extends: id - 1, stroke: strokes.at(-1)! }]]);
      await painter.show(7, id);
      masks.push(painter.mask(7)!.slice());
      expect(painter.mask(7)).toEqual(await computeMask({ painted: strokes }, g));
    }
    for (let id = 29; id >= 0; id--) {
      await painter.show(7, id);
      expect(painter.mask(7)).toEqual(masks[id]);
    }
    for (let id = 1; id <= 30; id++) await painter.show(7, id);
    expect(painter.mask(7)).toEqual(masks[30]);
  });

  test('a stroke that is given up leaves nothing', async () => {
    const s = sheet(12);
    const painter = new Painter(ground(s), s.positions, () => {});
    painter.updateRegions([[0, { painted: [] }]]);
    await painter.show(1, 0);
    painter.stamp(1, [5, 6], { ...BRUSH, radius: 0.3, falloff: 0.1 });
    expect(Math.max(...painter.mask(1)!)).toBe(255);
    painter.cancel();
    expect(Math.max(...painter.mask(1)!)).toBe(0);
  });

  test('a stroke outlives its layer, and its mask goes with the next edit', async () => {
    const s = sheet(12);
    for (const finish of ['cancel', 'end'] as const) {
      const painter = new Painter(ground(s), s.positions, () => {});
      painter.updateRegions([[0, { painted: [] }]]);
      await painter.show(1, 0);
      painter.stamp(1, [5, 6], { ...BRUSH, radius: 0.3, falloff: 0.1 });
      painter.retainLayers(new Set());
      expect(painter.stamp(1, [20], { ...BRUSH, radius: 0.3, falloff: 0.1 })).toBe(1);
      if (finish === 'cancel') painter.cancel();
      else expect(painter.end(1)).toEqual([5, 6, 20]);
      painter.retainLayers(new Set());
      expect(painter.mask(1)).toBeNull();
    }
  });

  test('only what faces the viewer is painted, as the region says it', async () => {
    const s = sheet(24, 0.15);
    const g = ground(s);
    const painter = new Painter(g, s.positions, () => {});
    painter.updateRegions([[0, { painted: [] }]]);
    await painter.show(1, 0);
    const facing = { direction: [1, 2, 1], falloff: 0.3 };
    const brush: BrushShape = { ...BRUSH, radius: 0.4, falloff: 0.4, strength: 0.8, facing };
    painter.stamp(1, [300, 320], brush);
    const indices = painter.end(1);
    const stamps: Region = { vertices: { indices, radius: 0.4, falloff: 0.4 } };
    const region: Region = { faded: { factor: 0.8, region: { all: [stamps, { facing }] } } };
    const mask = painter.mask(1)!;
    expect(mask).toEqual(await computeMask({ painted: [{ add: region }] }, g));
    const all = await computeMask({ faded: { factor: 0.8, region: stamps } }, g);
    expect(mask.some((w, v) => w === all[v] && w > 0)).toBe(true);
    expect(mask.some((w, v) => w < all[v]!)).toBe(true);
    painter.updateRegions([[1, { extends: 0, stroke: { add: region } }]]);
    await painter.show(1, 0);
    expect(Math.max(...painter.mask(1)!)).toBe(0);
    await painter.show(1, 1);
    expect(painter.mask(1)).toEqual(mask);
  });

  test('a stroke that smooths leads to what the server has blurred', async () => {
    const s = sheet(12);
    const blurred = new Uint8Array(s.n).fill(100);
    const asked: Region[] = [];
    const ask = (region: Region) => {
      asked.push(region);
      return Promise.resolve(blurred);
    };
    const painter = new Painter({ ...ground(s), ask }, s.positions, () => {});
    painter.updateRegions([[0, { painted: [] }]]);
    await painter.show(1, 0);
    await painter.prepareSmoothing(1, 0, 0.05);
    expect(asked).toEqual([{ blurred: { by: 0.05, region: { painted: [] } } }]);
    painter.stamp(1, [80], { ...BRUSH, mode: 'smooth', radius: 0.3, falloff: 0.3, strength: 0.5 });
    expect(painter.mask(1)![80]).toBe(50);
    painter.end(1);
    // Only the server computes the final mask.
    painter.updateRegions([
      [1, { extends: 0, stroke: { smooth: { region: stamp([80], 0.3, 0.5), by: 0.05 } } }],
    ]);
    await painter.show(1, 1);
    expect(painter.mask(1)).toEqual(blurred);
  });

  test('what undoes a stroke is packed, and gives back what was there', () => {
    const next = random(9);
    for (const n of [0, 1, 7, 500]) {
      const ranks = Uint32Array.from({ length: n }, () => Math.floor(3000 * next())).sort();
      const distinct = ranks.filter((rank, i) => rank !== ranks[i - 1]);
      const before = Uint8Array.from(distinct, (rank) => (rank % 900 < 700 ? 255 : rank % 251));
      const packed = packBefore(distinct, (i) => before[i]!);
      const seen: [number, number][] = [];
      unpackBefore(packed, (rank, value) => seen.push([rank, value]));
      expect(seen).toEqual(Array.from(distinct, (rank, i) => [rank, before[i]]));
    }
    const run = Uint32Array.from({ length: 20_000 }, (_, i) => 100 + i);
    expect(packBefore(run, () => 0).length).toBeLessThan(12);
  });

  test('a hundred strokes take less than a megabyte to undo', async () => {
    const s = sheet(220, 0.01);
    const g = ground(s);
    const next = random(11);
    const painter = new Painter(g, s.positions, () => {});
    const none: Region = { painted: [] };
    painter.updateRegions([[0, none]]);
    await painter.show(1, 0);
    const brush: BrushShape = { ...BRUSH, radius: 0.05 * Math.SQRT2, falloff: 0.05 * Math.SQRT2 };
    const regions: Region[] = [none];
    for (let id = 1; id <= 100; id++) {
      // A line of stamps, 0.15 radii apart.
      const [x, y, angle] = [next(), next(), 7 * next()];
      for (let k = 0; k < 40; k++) {
        const t = 0.15 * brush.radius * k;
        const [px, py] = [x + t * Math.cos(angle), y + t * Math.sin(angle)];
        if (px < 0 || px > 1 || py < 0 || py > 1) continue;
        painter.stamp(1, [Math.round(220 * px) * 221 + Math.round(220 * py)], brush);
      }
      const region = appendStroke(regions.at(-1)!, painter.end(id), brush);
      if (!('painted' in region)) throw new Error('not painted');
      painter.updateRegions([[id, { extends: id - 1, stroke: region.painted.at(-1)! }]]);
      await painter.show(1, id);
      regions.push(region);
    }
    // Documents of the page, and their copies in the worker, which receives each stroke once.
    const documents = 2 * bytesOf(regions);
    expect(painter.undoSize).toBeGreaterThan(1000);
    console.log(documents, painter.undoSize);
    expect(documents + painter.undoSize).toBeLessThan(1e6);
    const last = painter.mask(1)!.slice();
    await painter.show(1, 99);
    expect(painter.mask(1)).toEqual(await computeMask(regions[99]!, g));
    await painter.show(1, 100);
    expect(painter.mask(1)).toEqual(last);
  }, 60_000);
});

/** Estimated size in bytes of a value, each object once: 8 per number or reference, 16 per property list. */
function bytesOf(what: unknown, seen = new Set<unknown>()): number {
  if (typeof what !== 'object' || what === null || seen.has(what)) return 8;
  seen.add(what);
  const parts = Object.values(what);
  return parts.reduce(
    (sum: number, part) => sum + 8 + (typeof part === 'object' ? bytesOf(part, seen) : 0),
    16,
  );
}
