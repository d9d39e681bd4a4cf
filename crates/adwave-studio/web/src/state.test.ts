import { describe, expect, test } from 'vitest';
import { appendStroke } from './brush';
import { colorAt, rangeOf } from './colors';
import { gainOf, gainText, positionOf, SLIDER_MAX } from './gain';
import { formatCount, formatNumber, toModelUnits } from './lengths';
import { maskPacks, vertexShader } from './shader';
import { fromEdit, History, isNeutral, toEdit, withGain, withLayer } from './state';

const edit = {
  revision: 3,
  layers: [{ name: 'a', on: true, opacity: 1, gains: [1, 2], region: null }],
  along: null,
  border: 'natural' as const,
  volume: 'free' as const,
};

describe('the document', () => {
  test('goes to the server as it came', () => {
    expect(toEdit(fromEdit(edit, 2), 3)).toEqual(edit);
  });

  test('always has a layer, with a gain a band', () => {
    expect(fromEdit({ ...edit, layers: [] }, 3).layers[0]!.gains).toEqual([1, 1, 1]);
    expect(fromEdit(edit, 3).layers[0]!.gains).toEqual([1, 2, 1]);
  });

  test('a gesture is one step, and one that ends where it began is none', () => {
    let commits = 0;
    const first = fromEdit(edit, 2);
    const history = new History(first, (committed) => {
      if (committed) commits++;
    });
    const { key } = first.layers[0]!;
    for (const g of [1.5, 2, 3]) history.preview(withGain(history.doc, key, 1, g));
    history.end();
    expect([commits, history.nSteps]).toEqual([1, 1]);
    history.preview(withGain(history.doc, key, 1, 4));
    history.preview(withGain(history.doc, key, 1, 3));
    history.end();
    expect([commits, history.nSteps]).toEqual([1, 1]);
    history.undo();
    expect(history.doc).toBe(first);
    expect(history.undo()).toBe(false);
    history.redo();
    expect(history.doc.layers[0]!.gains).toEqual([3, 2]);
  });

  test('shares what stays the same', () => {
    const two = fromEdit({ ...edit, layers: [...edit.layers, ...edit.layers] }, 2);
    const next = withLayer(two, two.layers[1]!.key, { opacity: 0.5 });
    expect(next.layers[0]).toBe(two.layers[0]);
  });

  test('is neutral where nothing acts', () => {
    const doc = fromEdit(edit, 2);
    expect(isNeutral(doc)).toBe(false);
    expect(isNeutral(withLayer(doc, doc.layers[0]!.key, { on: false }))).toBe(true);
    expect(isNeutral(withGain(doc, doc.layers[0]!.key, 2, 1))).toBe(true);
  });
});

describe('a slider', () => {
  test('has 0, 1 and 4 at bottom, middle and top, and every step its own gain', () => {
    expect([gainOf(0), gainOf(100), gainOf(SLIDER_MAX)]).toEqual([0, 1, 4]);
    for (let s = 0; s <= SLIDER_MAX; s++) expect(positionOf(gainOf(s))).toBe(s);
    expect(positionOf(17)).toBe(SLIDER_MAX);
    expect(gainText(0.5)).toBe('0.50');
  });
});

test('a stroke on a region that was not painted begins with it', () => {
  const shape = {
    radius: 1,
    falloff: 1,
    strength: 0.5,
    mode: 'subtract' as const,
    facing: null,
    mirror: null,
  };
  const ball = { ball: { center: { vertex: 1 }, radius: 2 } };
  expect(appendStroke(ball, [4], shape)).toEqual({
    painted: [
      { add: ball },
      { subtract: { faded: { factor: 0.5, region: { vertices: { indices: [4], radius: 1, falloff: 1 } } } } },
    ],
  });
});

test('lengths and numbers', () => {
  expect([toModelUnits(3, 10), toModelUnits('2%', 10), toModelUnits('0.5', 10)]).toEqual([3, 0.2, 0.5]);
  expect([formatNumber(0.0123456), formatNumber(-2), formatNumber(1e6), formatNumber(Number.NaN)]).toEqual([
    '0.0123',
    '−2',
    '1.00e6',
    '–',
  ]);
  expect(formatCount(1234567)).toBe('1\u202f234\u202f567');
});

test('colors', () => {
  // Ends of viridis, as its authors have them: (68, 1, 84) and (253, 231, 37).
  for (const [t, rgb] of [
    [0, [68, 1, 84]],
    [1, [253, 231, 37]],
  ] as const) {
    for (const [c, x] of colorAt('viridis', t).entries()) expect(Math.abs(x - rgb[c]!)).toBeLessThan(6);
  }
  expect(rangeOf(Float32Array.from([-1, Number.NaN, 3]), 'all', true)).toEqual([-3, 3]);
  expect(rangeOf(Float32Array.from([5, 5]), 'all', false)).toEqual([5, 10]);
});

test('the shader holds 13 bands, fewer with many masks', () => {
  expect(maskPacks(8, 8)).toBe(2);
  expect(maskPacks(13, 0)).toBe(0);
  expect(maskPacks(13, 1)).toBeNull();
  expect(maskPacks(8, 9)).toBeNull();
  const source = vertexShader({
    nLevels: 2,
    packs: 1,
    cloud: false,
    clay: false,
    flat: true,
    scalar: false,
    tint: false,
  });
  expect(source).toContain('gains[1] * (1.0 + masks0.x * slopes[4])');
});
