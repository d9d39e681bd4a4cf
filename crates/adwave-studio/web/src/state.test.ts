import { describe, expect, test, vi } from 'vitest';
import { appendStroke } from './brush';
import { Camera } from './camera';
import { clipEquation, isClipped, parseClip } from './clip';
import { classesOf, colorAt, hasValues, histogram, movedOnly, rangeOf } from './colors';
import { effectGains, effectOf, matchingGains } from './effects';
import { gainOf, gainText, positionOf, SLIDER_MAX } from './gain';
import { farthestVertex, withMotion, withoutPins, withPins } from './grab';
import { restoreHistory, storeHistory } from './history-store';
import { formatCount, formatNumber, toModelUnits } from './lengths';
import { parseChoice } from './levels-dialog';
import type { Shape } from './protocol';
import { roundLength } from './scale-bar';
import { maskPacks, vertexShader } from './shader';
import {
  changedTarget,
  fromEdit,
  History,
  isNeutral,
  layersOf,
  mapGains,
  needsServer,
  newLayer,
  soloLayers,
  toEdit,
  withGain,
  withLayer,
  withLayersOf,
  withLevels,
  withoutPositions,
} from './state';
import { text } from './text';
import { parseView, placeCamera, recallView, rememberView, uprightAxis } from './view-memory';

const edit = {
  revision: 3,
  layers: [{ name: 'a', on: true, opacity: 1, gains: [1, 2], region: null }],
  along: null,
  border: 'natural' as const,
  volume: 'free' as const,
  clones: [],
  pose: null,
  turned: [],
  fields: [],
};

test('a histogram counts every number once, those beyond an end in the last part', () => {
  const values = Float32Array.of(-5, 0, 0.4, 0.5, Number.NaN, 1, 9, Number.POSITIVE_INFINITY);
  expect(histogram(values, [0, 1], 2)).toEqual([3, 3]);
});

describe('a clipping plane', () => {
  const box = { low: [-1, 0, 2], high: [3, 4, 6] };

  test('cuts away one side', () => {
    const equation = clipEquation({ axis: 0, at: 0.25, flipped: false }, box);
    expect([isClipped(equation, [0.1, 9, 9]), isClipped(equation, [-0.1, 9, 9])]).toEqual([true, false]);
    const other = clipEquation({ axis: 2, at: 0.5, flipped: true }, box);
    expect([isClipped(other, [0, 0, 4.1]), isClipped(other, [9, 0, 0, 3.9], 1)]).toEqual([false, true]);
  });

  test('is read from storage only if it is one', () => {
    const clip = { axis: 1, at: 0.5, flipped: true };
    expect(parseClip({ ...clip, more: 1 })).toEqual(clip);
    for (const bad of [
      null,
      undefined,
      3,
      { ...clip, axis: 3 },
      { ...clip, at: 1.5 },
      { ...clip, flipped: 1 },
    ])
      expect(parseClip(bad)).toBe(null);
  });
});

describe('the document', () => {
  test('goes to the server as it came', () => {
    expect(toEdit(fromEdit(edit, 2), 3)).toEqual(edit);
  });

  test('always has a layer, with a gain a band', () => {
    expect(fromEdit({ ...edit, layers: [] }, 3).layers[0]!.gains).toEqual([1, 1, 1]);
    expect(fromEdit(edit, 3).layers[0]!.gains).toEqual([1, 2, 1]);
  });

  test('keeps an edit of its own for each field', () => {
    const layers = [{ name: '', on: true, opacity: 1, gains: [0.5, 1], region: null }];
    const withField = { ...edit, fields: [{ field: 'thickness', layers }] };
    const doc = fromEdit(withField, 2);
    expect(toEdit(doc, 3)).toEqual(withField);
    expect(isNeutral({ ...doc, layers: [newLayer('', 2)] }), 'positions do not move').toBe(true);
    const { key } = layersOf(doc, 'thickness')![0]!;
    const next = withGain(doc, key, 2, 3);
    expect(layersOf(next, 'thickness')![0]!.gains).toEqual([0.5, 3]);
    expect(next.layers, 'the other layers are the same').toBe(doc.layers);
    expect([changedTarget(doc, next), changedTarget(doc, doc)]).toEqual(['thickness', undefined]);
    const moved = withGain(doc, doc.layers[0]!.key, 1, 3);
    expect([changedTarget(doc, moved), changedTarget(next, moved)]).toEqual([null, undefined]);
    const curvature = withLayersOf(doc, 'curvature', [newLayer('', 2)]);
    expect(layersOf(curvature, 'curvature')).toHaveLength(1);
    expect(layersOf(doc, 'curvature')).toBe(null);
    const halved = withLevels(
      { ...doc, levels: { choice: {}, sigmas: [1, 2] } },
      { choice: {}, sigmas: [1, 2, 4] },
    );
    expect(layersOf(halved, 'thickness')![0]!.gains).toEqual([0.5, 1, 1]);
  });

  test('a field that is touched and left as it was is no step', () => {
    const doc = fromEdit(edit, 2);
    const history = new History(doc, () => {});
    const layer = newLayer('', 2);
    const touched = withLayersOf(doc, 'thickness', [layer]);
    history.preview(withGain(touched, layer.key, 1, 2));
    history.preview(withGain(history.doc, layer.key, 1, 1));
    history.end();
    expect(history.nSteps).toBe(0);
  });

  test('a graph without positions keeps the edits of its fields alone', () => {
    const doc = fromEdit(edit, 2);
    const neutral = withoutPositions({ ...doc, clones: [], pose: null, turned: [] });
    const history = new History(neutral, () => {}, withoutPositions);
    history.commit(withGain(history.doc, history.doc.layers[0]!.key, 1, 3));
    expect([history.nSteps, history.doc.layers[0]!.gains]).toEqual([0, [1, 1]]);
    const layer = { ...newLayer('', 2), gains: [0.5, 1] };
    history.commit({ ...withLayersOf(history.doc, 'load', [layer]), turned: [4] });
    expect([history.nSteps, history.doc.turned]).toEqual([1, []]);
    expect(layersOf(history.doc, 'load')![0]!.gains).toEqual([0.5, 1]);
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
    posed: false,
    cloud: false,
    lit: 'front',
    clay: false,
    flat: true,
    scalar: false,
    classes: false,
    original: false,
    clip: false,
    rgb: false,
    tint: false,
  });
  expect(source).toContain('gains[1] * (1.0 + masks0.x * slopes[4])');
  expect(source).not.toContain('turned');
  // In a pose the sum turns with the frames, which take an attribute.
  expect(maskPacks(12, 0, true)).toBe(0);
  expect(maskPacks(13, 0, true)).toBeNull();
});

describe('a pose', () => {
  const handle = (vertex: number) => ({
    by: [0, 0, 0],
    region: { vertices: { indices: [vertex], radius: 0 } },
  });
  const pose = { fixed: null, handle: [handle(3), handle(5)] };

  test('pins, releases and moves', () => {
    const spots = { vertices: { indices: [1, 2, 9], radius: 0.1 } };
    const part = { component: { vertex: 4 } };
    const pinned = withPins(pose, [spots, part]);
    expect(pinned.fixed).toEqual({ any: [spots, part] });
    expect(withoutPins([spots, part], (v) => v === 2)).toEqual([
      { vertices: { indices: [1, 9], radius: 0.1 } },
      part,
    ]);
    expect(withoutPins([spots], () => true)).toEqual([]);
    expect(withoutPins([spots], () => false)[0]).toBe(spots);
    expect(withPins(pinned, []).fixed).toBeNull();
    const moved = withMotion(pinned, 1, [1, 2, 3]);
    expect(moved.handle.map((one) => one.by)).toEqual([
      [0, 0, 0],
      [1, 2, 3],
    ]);
    expect(pose.handle[1]!.by).toEqual([0, 0, 0]);
    expect(farthestVertex([0, 0, 0, 3, 0, 0, -4, 1, 0], [1, 0, 0])).toBe(2);
  });

  test('is part of the edit and of its steps', () => {
    const doc = fromEdit({ ...edit, pose }, 2);
    expect(toEdit(doc, 3)).toEqual({ ...edit, pose });
    const neutral = { ...doc, layers: [newLayer('', 2)] };
    expect(isNeutral(neutral)).toBe(false);
    expect(isNeutral({ ...neutral, pose: { handle: [] } })).toBe(true);
    // The page bends a shape whose bands are unchanged without the server's positions.
    expect(needsServer(neutral, { kind: 'cloud', closed: false })).toBe(false);
    const history = new History(neutral, () => {});
    history.preview({ ...neutral, pose: withMotion(pose, 0, [1, 0, 0]) });
    history.preview({ ...neutral, pose: withMotion(pose, 0, [2, 0, 0]) });
    history.end();
    expect(history.nSteps).toBe(1);
    history.undo();
    expect(history.doc).toBe(neutral);
  });

  test('moves a handle in the plane of the picture', () => {
    const camera = new Camera();
    camera.resize(800, 600);
    camera.setBounds([0, 0, 0], 1);
    camera.start();
    const place = [0.2, -0.1, 0.4];
    const at = camera.project(place);
    for (const [c, x] of camera.pointInPlane(place, at.x, at.y).entries())
      expect(x).toBeCloseTo(place[c]!, 9);
    const moved = camera.pointInPlane(place, at.x + 30, at.y - 40);
    const seen = camera.project(moved);
    expect([seen.x, seen.y]).toEqual([expect.closeTo(at.x + 30, 6), expect.closeTo(at.y - 40, 6)]);
    expect(Math.hypot(...moved.map((x, c) => x - place[c]!)) * at.scale).toBeCloseTo(50, 6);
  });
});

describe('other levels', () => {
  test('take the gains of their widths, and undo brings back the old ones', () => {
    const widths = [1, 2, 4];
    expect(mapGains([0.5, 3, 2], widths, widths)).toEqual([0.5, 3, 2]);
    expect(mapGains([0.5, 3, 2], widths, [1, 2, 4, 8])).toEqual([0.5, 3, 2, 1]);
    expect(mapGains([0.5, 3, 2], widths, [1, 4])).toEqual([0.5, 2.5]);
    expect(mapGains([0.5, 3], [1, 2], [1, 1.5, 2])).toEqual([0.5, 3, 3]);
    expect(mapGains([0.5, 3], [1, 2], [0.25, 1, 2])).toEqual([0.5, 0.5, 3]);
    const before = fromEdit(edit, 2, { choice: { levels: 2 }, sigmas: [1, 2] });
    const history = new History(before, () => {});
    history.commit(withLevels(before, { choice: { steps: [1, 2, 4] }, sigmas: [1, 1.5, 2] }));
    expect(history.doc.layers[0]!.gains).toEqual([1, 2, 2]);
    expect(history.peek('undo')).toBe(before);
    history.undo();
    expect(history.doc).toBe(before);
  });

  test('are chosen in words that say what is wrong', () => {
    const input = { count: '8', voices: '1', lengths: '1%, 2 %' };
    expect(parseChoice('auto', input, 10)).toEqual({});
    expect(parseChoice('count', input, 10)).toEqual({ levels: 8 });
    expect(parseChoice('count', { ...input, count: '30' }, 10)).toBe(
      'Enter a whole number of bands from 1 to 24.',
    );
    expect(parseChoice('count', { ...input, voices: '1.5' }, 10)).toContain('per octave');
    expect(parseChoice('lengths', { ...input, lengths: '0.1, 2%, 1' }, 10)).toEqual({
      lengths: [0.1, '2%', 1],
    });
    expect(parseChoice('lengths', { ...input, lengths: 'a, 1' }, 10)).toContain('“a”');
    expect(parseChoice('lengths', { ...input, lengths: '2, 1' }, 10)).toContain('increasing');
    expect(parseChoice('lengths', { ...input, lengths: '' }, 10)).toContain('increasing');
  });
});

describe('solo', () => {
  test('shows one band alone and leaves the document as it is', () => {
    const doc = fromEdit({ ...edit, layers: [{ ...edit.layers[0]!, gains: [0, 2] }] }, 2);
    const { key } = doc.layers[0]!;
    expect(soloLayers(doc.layers, { key, level: 1 })[0]!.gains).toEqual([1, 0]);
    expect(soloLayers(doc.layers, { key, level: 2 })[0]!.gains).toEqual([0, 2]);
    expect(soloLayers(doc.layers, null)).toBe(doc.layers);
  });
});

describe('the server', () => {
  test('is needed for borders by default, and not for an edit that changes nothing', () => {
    const doc = fromEdit(edit, 2);
    const neutral = fromEdit({ ...edit, layers: [] }, 2);
    expect(needsServer(doc, { kind: 'mesh', closed: true })).toBe(false);
    expect(needsServer(doc, { kind: 'mesh', closed: false })).toBe(true);
    expect(needsServer({ ...doc, border: 'free' }, { kind: 'mesh', closed: false })).toBe(false);
    expect(needsServer({ ...doc, along: 'free' }, { kind: 'mesh', closed: false })).toBe(false);
    expect(needsServer(doc, { kind: 'cloud', closed: false })).toBe(true);
    expect(needsServer(neutral, { kind: 'cloud', closed: false })).toBe(false);
  });
});

describe('the history', () => {
  test('survives a reload if the stored edit is the present one', () => {
    const items = new Map<string, string>();
    vi.stubGlobal('sessionStorage', {
      getItem: (key: string) => items.get(key) ?? null,
      setItem: (key: string, value: string) => items.set(key, value),
      removeItem: (key: string) => items.delete(key),
    });
    const shape = { id: 1, name: 'a.obj', n_vertices: 3 } as Shape;
    const region = { painted: [{ add: { vertices: { indices: [1], radius: 1 } } }] };
    const levels = { choice: {}, sigmas: [1, 2] };
    const first = fromEdit(edit, 2, levels);
    const history = new History(first, () => {});
    const { key } = first.layers[0]!;
    history.commit(withLayer(history.doc, key, { region }));
    history.commit(withGain(history.doc, key, 1, 3));
    history.commit(withGain(history.doc, key, 1, 4));
    history.undo();
    storeHistory(shape, history);
    const again = new History(fromEdit(toEdit(history.doc, 0), 2, levels), () => {});
    expect(restoreHistory(shape, again)).toBe(true);
    again.redo();
    expect(again.doc.layers[0]!.gains).toEqual([4, 2]);
    for (let i = 0; i < 3; i++) again.undo();
    expect(toEdit(again.doc, 3)).toEqual(edit);
    storeHistory(shape, history);
    expect(restoreHistory(shape, new History(first, () => {}))).toBe(false);
    vi.unstubAllGlobals();
  });
});

describe('an effect of the brush', () => {
  test('acts on detail of its size', () => {
    const sigmas = [0.5, 1, 2, 4, 8, 16];
    expect(effectGains('smooth', sigmas, 4)).toEqual([0, 0, 0.5, 1, 1, 1]);
    expect(effectGains('enhance', sigmas, 6)).toEqual([1.25, 2.5, 2.5, 1.554, 1, 1]);
    expect(effectGains('flatten', sigmas, 4)).toEqual([0, 0, 0, 0, 0, 1]);
    // A brush finer than all bands acts on the finest.
    expect(effectGains('smooth', sigmas, 0.1)[0]).toBe(0);
    expect(matchingGains([1, 0.1, 9], [2, 0, 1])).toEqual([0.5, 1, 4]);
  });

  test('is that of the layer with its name', () => {
    const layer = { ...newLayer(text.effects.smooth, 2), region: { painted: [] } };
    expect(effectOf(layer)).toBe('smooth');
    expect(effectOf({ ...layer, name: 'mine' })).toBe(null);
    expect(effectOf({ ...layer, region: null })).toBe(null);
  });
});

test('the range of displacements is that of the vertices that moved', () => {
  const values = new Float32Array(10_000);
  for (let v = 0; v < 100; v++) values[v] = 1 + v / 100;
  const [low, high] = rangeOf(movedOnly(values), 'most', false);
  expect(low).toBeGreaterThan(0.9);
  expect(high).toBeGreaterThan(1.9);
  expect(movedOnly(new Float32Array(3))).toHaveLength(3);
});

describe('colors of a field', () => {
  test('are a palette for whole numbers, and say that there are no values', () => {
    expect(classesOf(new Float32Array([3, 1, Number.NaN, 1]))).toEqual([1, 3]);
    expect(classesOf(new Float32Array([1, 1.5]))).toBe(null);
    expect(classesOf(Float32Array.from({ length: 100 }, (_, v) => v))).toBe(null);
    expect(colorAt('classes', 0)).not.toEqual(colorAt('classes', 1 / 255));
    expect(hasValues(new Float32Array([Number.NaN, Number.NaN]))).toBe(false);
    expect(hasValues(new Float32Array([Number.NaN, 0]))).toBe(true);
  });
});

test('the scale bar has a round length', () => {
  expect([0.3, 1, 7.2, 49, 1999, 0.0051].map(roundLength)).toEqual([0.2, 1, 5, 20, 1000, 0.005]);
  expect([roundLength(0), roundLength(Number.POSITIVE_INFINITY)]).toEqual([0, 0]);
});

test('zooming stops in front of the surface under the pointer', () => {
  const camera = new Camera();
  camera.setBounds([0, 0, 0], 1);
  camera.resize(400, 300);
  camera.start();
  // A point on the near side of the shape, whose pivot is at the center.
  const [x, y, z] = camera.toward() as [number, number, number];
  const point = [0.8 * x, 0.8 * y, 0.8 * z];
  for (let i = 0; i < 60; i++) {
    camera.focusDepth(point);
    camera.zoom(0.8, 200, 150);
    const { x: u, y: v, scale } = camera.project(point);
    expect(Math.hypot(u - 200, v - 150)).toBeLessThan(1e-3);
    expect(scale).toBeGreaterThan(0);
  }
  expect(camera.distance).toBeLessThan(0.01);
});

test('a frame is filled by the shape from every side, and a shape near the eye is not reached', () => {
  const camera = new Camera();
  // A long bar beside the origin.
  const bar = Float32Array.from({ length: 900 }, (_, i) => [9, 1, 0.5][i % 3]! * (0.5 + Math.sin(i * i)));
  camera.setBounds([4.5, 0.5, 0.25], 10);
  camera.outline = bar;
  camera.resize(400, 300);
  for (const name of ['front', 'top', 'back'] as const) {
    camera.look(name);
    camera.frame();
    const seen: { x: number; y: number }[] = [];
    for (let i = 0; i < bar.length; i += 3) seen.push(camera.project(bar.subarray(i, i + 3) as never));
    const across = Math.max(
      ...seen.map(({ x, y }) => Math.max(Math.abs(x / 200 - 1), Math.abs(y / 150 - 1))),
    );
    expect(across).toBeCloseTo(0.92, 6);
  }
  // Along the bar the ends are 9 from the center: the eye stays as far before the near one.
  camera.look('right');
  camera.frame();
  expect(camera.distance).toBeGreaterThan(17);
  camera.outline = new Float32Array(3);
  camera.setBounds([0, 0, 0], 0);
  camera.frame();
  expect(camera.distance).toBeGreaterThan(1);
});

describe('a view', () => {
  test('is remembered by shape, and begins upright by its format', () => {
    const items = new Map<string, string>();
    vi.stubGlobal('localStorage', {
      getItem: (key: string) => items.get(key) ?? null,
      setItem: (key: string, value: string) => items.set(key, value),
    });
    const shape = { name: 'a.las', n_vertices: 3, format: 'las' } as Shape;
    const camera = new Camera();
    camera.setBounds([0, 0, 0], 1);
    placeCamera(camera, shape);
    expect(camera.up).toBe('z');
    camera.turn(30, 10);
    camera.zoom(0.5, 0, 0);
    rememberView(shape, { camera: camera.state, style: 'flat', colors: 'change' });
    const again = new Camera();
    again.setBounds([0, 0, 0], 1);
    placeCamera(again, shape);
    expect(again.state.distance).toBe(camera.state.distance);
    expect(again.toward()).toEqual(camera.toward());
    expect(recallView({ ...shape, n_vertices: 4 })).toBe(null);
    items.set('adwave-views', '[["a.las 3", {"camera": {"distance": "far"}}]]');
    expect(recallView(shape)).toBe(null);
    const view = { camera: camera.state, style: 'flat', colors: 'none' };
    expect(parseView(JSON.stringify(view))).toEqual(view);
    expect([parseView('{}'), parseView('no'), parseView('null')]).toEqual([null, null, null]);
    expect(uprightAxis({ name: 'a.obj', format: 'obj' })).toBe('y');
    vi.unstubAllGlobals();
  });
});
