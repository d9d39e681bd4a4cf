import { expect, test } from 'vitest';
import type { GridInfo, SliceView } from '../protocol';
import { type Part, Plane, partFor, positionOf, queryOf, sizesOf } from './plane';
import { type Shading, shade, usualHeight } from './shade';

const whole: Part = { index: 0, frame: null, from: [0, 0], to: [2, 3], step: 1 };

test('the edited values are the sum of the bands with their gains', () => {
  const values = [1, 2, 3, 4, Number.NaN, 6];
  const bands = [
    [1, -1, 0.5, 0, 0, 2],
    [0.25, 0.5, 1, 2, 0, 4],
  ];
  const plane = new Plane(whole, 1, Float32Array.from([values, ...bands].flat()));
  expect(plane.nLevels).toBe(2);
  plane.edit([0, 3]);
  expect([...plane.edited]).toEqual([0.5, 4, 4.5, 8, Number.NaN, 12]);
  plane.edit([1, 1]);
  expect([...plane.edited]).toEqual(values);
  expect(plane.spectrumAt(plane.at(1, 2))).toEqual([2, 4]);
  expect(() => new Plane(whole, 1, new Float32Array(7))).toThrow('6 values has 7');
});

test('indices of the grid lead to the places that are loaded', () => {
  const part: Part = { index: 4, frame: null, from: [10, 20], to: [16, 25], step: 2 };
  expect(sizesOf(part)).toEqual([3, 3]);
  const plane = new Plane(part, 1, new Float32Array(9));
  expect([plane.at(10, 20), plane.at(12, 24), plane.at(14, 22)]).toEqual([0, 5, 7]);
  expect([plane.at(8, 20), plane.at(10, 26), plane.at(17, 20)]).toEqual([-1, -1, -1]);
  const view: SliceView = {
    name: 'Coronal',
    fixed: 1,
    axes: [0, 2],
    flips: [true, false],
    edges: ['', '', '', ''],
  };
  expect(queryOf(view, part)).toBe('axes=0,2&from=10,20&to=16,25&step=2&index=4');
  expect(queryOf(view, { ...part, frame: 3 })).toBe('axes=0,2&from=10,20&to=16,25&step=2&index=4&frame=3');
});

test('positions follow the affine matrix of the file', () => {
  const grid = {
    origin: [10, 20, 30],
    steps: [
      [0, 0, 2],
      [0, -1.5, 0],
      [-1, 0, 0],
    ],
  } as unknown as GridInfo;
  expect(positionOf(grid, [3, 2, 5])).toEqual([5, 17, 36]);
});

test('a large image is loaded where it is seen, as finely as the screen shows it', () => {
  const seen = { low: [100, 200], high: [300, 500], perPixel: 0.5 } as const;
  const part = partFor([10_000, 10_000], { ...seen, low: [100, 200], high: [300, 500] }, 1 << 20, null)!;
  expect(part).toEqual({ index: 0, frame: null, from: [49, 124], to: [352, 577], step: 1 });
  // Moving within the margin loads nothing.
  const moved = { low: [120, 210], high: [320, 510], perPixel: 0.5 } as const;
  expect(
    partFor([10_000, 10_000], { ...moved, low: [120, 210], high: [320, 510] }, 1 << 20, part),
  ).toBeNull();
  const all = partFor([10_000, 10_000], { low: [0, 0], high: [9999, 9999], perPixel: 12 }, 1 << 20, part)!;
  expect(all).toEqual({ index: 0, frame: null, from: [0, 0], to: [10_000, 10_000], step: 12 });
  const [rows, columns] = sizesOf(all);
  expect(rows * columns).toBeLessThanOrEqual(1 << 20);
  // Whatever the screen asks for, no more than the limit is loaded.
  const most = partFor([10_000, 10_000], { low: [0, 0], high: [9999, 9999], perPixel: 1 }, 1 << 16, null)!;
  expect(most.step).toBe(40);
  // A small image is loaded as a whole, and nothing outside of it.
  expect(partFor([50, 60], { low: [-20, 10], high: [20, 30], perPixel: 3 }, 1 << 20, null)).toEqual({
    index: 0,
    frame: null,
    from: [0, 0],
    to: [50, 60],
    step: 1,
  });
  expect(partFor([50, 60], { low: [70, 10], high: [90, 30], perPixel: 1 }, 1 << 20, null)).toBeNull();
});

const shading: Shading = { mode: 'gray', window: [0, 10], spacings: [1, 1], height: 1, opacity: null };

function shaded(values: number[], columns: number, change: Partial<Shading>, nChannels = 1): number[][] {
  const rows = values.length / columns / nChannels;
  const rgba = new Uint8ClampedArray(4 * rows * columns);
  const shown = { values: Float32Array.from(values), rows, columns, nChannels };
  shade(shown, { ...shading, ...change }, rgba);
  return Array.from({ length: rows * columns }, (_, i) => [...rgba.subarray(4 * i, 4 * i + 4)]);
}

test('gray values fill the window, and a place without data is transparent', () => {
  expect(shaded([0, 5, 10, -3, 99, Number.NaN], 6, {})).toEqual([
    [0, 0, 0, 255],
    [128, 128, 128, 255],
    [255, 255, 255, 255],
    [0, 0, 0, 255],
    [255, 255, 255, 255],
    [0, 0, 0, 0],
  ]);
});

test('channels are colors, and the last one may be the opacity', () => {
  const pixels = [0, 5, 10, 128, 10, 0, 20, 255];
  expect(shaded(pixels, 2, { mode: 'color', opacity: { full: 255 } }, 4)).toEqual([
    [0, 128, 255, 128],
    [255, 0, 255, 255],
  ]);
  expect(shaded(pixels, 2, { mode: 'color' }, 4).map((p) => p[3])).toEqual([255, 255]);
});

test('a relief is lit from the upper left: planes have the brightness of their normals', () => {
  const plane = (gx: number, gy: number) =>
    Array.from({ length: 25 }, (_, i) => gx * (i % 5) + gy * Math.floor(i / 5));
  const middle = (values: number[], change: Partial<Shading> = {}) =>
    shaded(values, 5, { mode: 'relief', ...change })[12]![0]!;
  const expected = (gx: number, gy: number) => {
    const dot = (0.5 * gx + 0.5 * gy + Math.SQRT1_2) / Math.sqrt(1 + gx * gx + gy * gy);
    return Math.round(255 * Math.max(0, dot));
  };
  expect(middle(plane(0, 0))).toBe(180);
  for (const [gx, gy] of [
    [0.5, 0],
    [0, 0.5],
    [-0.4, 0.1],
    [-3, -3],
  ] as const)
    expect(middle(plane(gx, gy))).toBe(expected(gx, gy));
  // Slopes are heights by lengths of each axis.
  expect(middle(plane(1, 0), { spacings: [1, 2] })).toBe(expected(0.5, 0));
  expect(middle(plane(0, 1), { spacings: [2, 1], height: 0.5 })).toBe(expected(0, 0.25));
  // A gap next to a place makes no cliff.
  const gap = plane(0, 0);
  gap[13] = Number.NaN;
  expect(middle(gap)).toBe(180);
});

test('the usual height of a relief gives slopes of 0.4', () => {
  const values = Float32Array.from({ length: 100 }, (_, i) => 50 * (i % 10));
  const height = usualHeight({ values, rows: 10, columns: 10, nChannels: 1 }, [10, 25]);
  expect(height * (50 / 25)).toBeCloseTo(0.4, 6);
  expect(usualHeight({ values: new Float32Array(100), rows: 10, columns: 10, nChannels: 1 }, [1, 1])).toBe(1);
});
