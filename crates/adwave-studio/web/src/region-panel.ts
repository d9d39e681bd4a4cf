/** Controls of the selected layer's region: its kind and parameters, inversion, growing and blurring. */

import { h, iconButton, select, slider } from './dom';
import { firstField, regionFields } from './fields';
import { formatNumber, toModelUnits } from './lengths';
import type { Region, Shape } from './protocol';
import { type Change, reshapeRegion } from './reshape';
import type { Studio } from './studio';
import { text } from './text';

type RegionChoice =
  | 'everywhere'
  | 'painted'
  | 'ball'
  | 'stroke'
  | 'box'
  | 'half-space'
  | 'component'
  | 'field'
  | 'other';

/** Length by which a region is grown, shrunk or blurred, in percent of the diagonal. */
let amount = 1;

/** Grows, shrinks or blurs the region of the selected layer. */
export function reshape(studio: Studio, change: Change): void {
  const { region, key } = studio.layer;
  if (!region || !studio.shape) {
    studio.showMessage(text.reshapeNothing);
    return;
  }
  const { diagonal } = studio.shape;
  studio.changeLayer(
    { region: reshapeRegion(region, change, (amount / 100) * diagonal, diagonal) },
    true,
    key,
  );
}

/** Strips enclosing inversions; `inverted` tells if their number was odd. */
function stripInversions(region: Region | null): { inner: Region | null; inverted: boolean } {
  let inner = region;
  let inverted = false;
  while (inner && 'not' in inner) {
    inner = inner.not;
    inverted = !inverted;
  }
  return { inner, inverted };
}

function regionKind(region: Region | null): RegionChoice {
  if (!region) return 'everywhere';
  const kind = Object.keys(region)[0] as string;
  if (kind === 'vertices' || kind === 'painted') return 'painted';
  const known = ['ball', 'stroke', 'box', 'half-space', 'component', 'field'];
  return known.includes(kind) ? (kind as RegionChoice) : 'other';
}

/** Shared parameters of the controls of one layer's region. */
interface RegionContext {
  studio: Studio;
  shape: Shape;
  key: number;
  /** Replaces the region inside its inversions. */
  set: (region: Region | null) => void;
}

type Content<K extends string> = Extract<Region, Record<K, unknown>>[K &
  keyof Extract<Region, Record<K, unknown>>];

/** Default region of a kind. */
function defaultRegion({ studio, shape }: RegionContext, kind: RegionChoice): Region | null {
  const { diagonal, center } = shape;
  const half = diagonal / 4;
  switch (kind) {
    case 'painted':
      return { painted: [] };
    case 'ball':
      return { ball: { center: { vertex: studio.lastVertex ?? 0 }, radius: 0.15 * diagonal } };
    case 'box':
      return {
        box: {
          min: center.map((c) => c - half),
          max: center.map((c) => c + half),
          falloff: 0.05 * diagonal,
        },
      };
    case 'half-space':
      return { 'half-space': { point: [...center], normal: [1, 0, 0], falloff: 0.1 * diagonal } };
    case 'component':
      return { component: { vertex: studio.lastVertex ?? 0 } };
    case 'field': {
      const name = firstField(shape)?.name;
      return name ? { field: { name, low: 0, high: 1 } } : null;
    }
    default:
      return null;
  }
}

/** Fits the range of a field to its values. */
function fitField({ studio, set }: RegionContext, name: string): Promise<void> {
  return studio.fieldRange(name).then(
    ([low, high]) => set({ field: { name, low, high } }),
    (e: Error) => {
      studio.showMessage(e.message, 'error');
    },
  );
}

function pickPart({ studio, set }: RegionContext): void {
  studio.requestVertex(text.clickPart, (vertex) => set({ component: { vertex } }));
}

interface LengthOptions {
  label: string;
  /** In model units. */
  value: number;
  /** Largest value, in percent of the diagonal. */
  max: number;
  toRegion: (value: number) => Region;
}

/** Slider of a length, in percent of the diagonal. */
function lengthSlider(
  { shape, set }: RegionContext,
  { label, value, max, toRegion }: LengthOptions,
): HTMLElement {
  const { diagonal } = shape;
  return slider(
    label,
    { min: 0.5, max, step: 0.5, value: Math.min(max, (100 * value) / diagonal) },
    (v) => formatNumber((v / 100) * diagonal),
    (v, done) => {
      // Some regions are computed by the server, hence only when the slider is released.
      if (done) set(toRegion((v / 100) * diagonal));
    },
  );
}

/** Slider of a coordinate, in percent of the diagonal from the center of the shape. */
function coordinateSlider(
  { shape, set }: RegionContext,
  { label, value, axis, toRegion }: Omit<LengthOptions, 'max'> & { axis: number },
): HTMLElement {
  const { diagonal } = shape;
  const middle = shape.center[axis]!;
  return slider(
    label,
    { min: -50, max: 50, step: 0.5, value: (100 * (value - middle)) / diagonal },
    (v) => formatNumber(middle + (v / 100) * diagonal),
    (v, done) => {
      if (done) set(toRegion(middle + (v / 100) * diagonal));
    },
  );
}

function ballControls(context: RegionContext, ball: Content<'ball'>): Node[] {
  const { studio, shape, set } = context;
  return [
    h('p', { class: 'hint' }, `${text.ballHint} ${text.handlesHint}`),
    lengthSlider(context, {
      label: text.radius,
      value: toModelUnits(ball.radius, shape.diagonal),
      max: 60,
      toRegion: (radius) => ({ ball: { ...ball, radius } }),
    }),
    button(text.moveCenter, () => {
      studio.requestVertex(text.clickCenter, (vertex) => set({ ball: { ...ball, center: { vertex } } }));
    }),
  ];
}

function strokeControls(context: RegionContext, stroke: Content<'stroke'>): Node[] {
  const { studio, shape, key } = context;
  const radius = toModelUnits(stroke.radius, shape.diagonal);
  return [
    lengthSlider(context, {
      label: text.radius,
      value: radius,
      max: 30,
      toRegion: (r) => ({ stroke: { ...stroke, radius: r } }),
    }),
    studio.lineDrawing
      ? button(text.lineEnd, () => studio.lineDrawing?.end())
      : button(text.lineAgain, () => drawLine(studio, key, radius)),
  ];
}

function boxControls(context: RegionContext, box: Content<'box'>): Node[] {
  const bounds = [0, 1, 2].flatMap((axis) =>
    (['min', 'max'] as const).map((end) =>
      coordinateSlider(context, {
        label: `${end === 'min' ? text.from : text.to} ${'xyz'[axis]}`,
        value: box[end][axis]!,
        axis,
        toRegion: (value) => ({ box: { ...box, [end]: box[end].with(axis, value) } }),
      }),
    ),
  );
  const falloff = lengthSlider(context, {
    label: text.falloff,
    value: toModelUnits(box.falloff ?? '5%', context.shape.diagonal),
    max: 30,
    toRegion: (value) => ({ box: { ...box, falloff: value } }),
  });
  return [h('p', { class: 'hint' }, text.handlesHint), ...bounds, falloff];
}

function halfSpaceControls(context: RegionContext, half: Content<'half-space'>): Node[] {
  const { shape, set } = context;
  const axis = Math.max(
    0,
    half.normal.findIndex((x) => x !== 0),
  );
  const isTilted = half.normal.filter((x) => x !== 0).length > 1;
  const side = isTilted ? 'tilted' : `${(half.normal[axis] ?? 1) < 0 ? '-' : '+'}${'xyz'[axis]}`;
  const sides = ['+x', '-x', '+y', '-y', '+z', '-z'].map((s) => [s, s.replace('-', '−')] as const);
  return [
    h('p', { class: 'hint' }, text.handlesHint),
    select(text.toward, isTilted ? [...sides, ['tilted', text.tilted] as const] : sides, side, (s) => {
      if (s === 'tilted') return;
      const normal = [0, 0, 0].with('xyz'.indexOf(s[1]!), s[0] === '-' ? -1 : 1);
      set({ 'half-space': { ...half, point: [...shape.center], normal } });
    }),
    ...(isTilted
      ? []
      : [
          coordinateSlider(context, {
            label: text.plane,
            value: half.point[axis] ?? 0,
            axis,
            toRegion: (value) => ({ 'half-space': { ...half, point: half.point.with(axis, value) } }),
          }),
        ]),
    lengthSlider(context, {
      label: text.falloff,
      value: toModelUnits(half.falloff ?? '5%', shape.diagonal),
      max: 60,
      toRegion: (falloff) => ({ 'half-space': { ...half, falloff } }),
    }),
  ];
}

function fieldControls(context: RegionContext, field: Content<'field'>): Node[] {
  const { shape, set } = context;
  const number = (name: 'low' | 'high', label: string) => {
    const input = h('input', {
      type: 'number',
      step: 'any',
      value: String(Number(field[name].toPrecision(6))),
      onchange: () => {
        if (Number.isFinite(input.valueAsNumber)) set({ field: { ...field, [name]: input.valueAsNumber } });
      },
    });
    return h('label', { class: 'field' }, h('span', {}, label), input);
  };
  return [
    select(
      text.field,
      regionFields(shape).map((f) => [f.name, f.label] as const),
      field.name,
      (name) => void fitField(context, name),
    ),
    number('low', text.fieldLow),
    number('high', text.fieldHigh),
    button(text.fieldFit, () => void fitField(context, field.name)),
  ];
}

/** Controls of the parameters of a region, by its kind. */
function parameterControls(context: RegionContext, region: Region | null): Node[] {
  if (!region) return [];
  if ('ball' in region) return ballControls(context, region.ball);
  if ('stroke' in region) return strokeControls(context, region.stroke);
  if ('component' in region) return [button(text.choosePart, () => pickPart(context))];
  if ('box' in region) return boxControls(context, region.box);
  if ('half-space' in region) return halfSpaceControls(context, region['half-space']);
  if ('field' in region) return fieldControls(context, region.field);
  return [];
}

/** Buttons that grow, shrink and blur a region, and the length by which they do it. */
function reshapeControls({ studio, shape }: RegionContext): Node[] {
  const change = (label: string, title: string, what: Change) =>
    h('button', { type: 'button', title, onclick: () => reshape(studio, what) }, label);
  return [
    h(
      'div',
      { class: 'row reshape', role: 'group', 'aria-label': text.reshape },
      change(text.grow, text.growHint, 'grow'),
      change(text.shrink, text.shrinkHint, 'shrink'),
      change(text.blur, text.blurHint, 'blur'),
    ),
    slider(
      text.reshapeBy,
      { min: 0.2, max: 10, step: 0.2, value: amount },
      (v) => formatNumber((v / 100) * shape.diagonal),
      (v) => {
        amount = v;
      },
    ),
  ];
}

/** List of the kinds of regions. */
function kindSelect(context: RegionContext, region: Region | null, kind: RegionChoice): HTMLElement {
  const { studio, shape, key, set } = context;
  const choices = text.regionChoices
    .filter(([k]) => k !== 'other' || kind === 'other')
    .filter(([k]) => !shape.graph?.placed || (k !== 'box' && k !== 'half-space'))
    .map(([k, name]) => [k, k === 'other' ? text.otherRegion(describeRegion(region)) : name]) as [
    RegionChoice,
    string,
  ][];
  return select<RegionChoice>(text.where, choices, kind, (next) => {
    if (next === 'painted') studio.setTool('brush');
    if (next === 'stroke') {
      drawLine(studio, key, 0.04 * shape.diagonal);
      return;
    }
    const initial = defaultRegion(context, next);
    if (initial && 'field' in initial) {
      void fitField(context, initial.field.name);
      return;
    }
    set(initial);
    if (next === 'component') pickPart(context);
  });
}

/** Creates all controls of the selected layer's region. */
export function regionChooser(studio: Studio): HTMLElement {
  const { shape } = studio;
  if (!shape) return h('div');
  const { region, key } = studio.layer;
  const { inner, inverted } = stripInversions(region);
  const set = (r: Region | null) => studio.changeLayer({ region: inverted && r ? { not: r } : r }, true, key);
  const context: RegionContext = { studio, shape, key, set };
  const invert = region
    ? iconButton(
        'invert',
        text.invert,
        () => studio.changeLayer({ region: inverted ? inner : { not: region } }, true, key),
        { 'aria-pressed': String(inverted) },
      )
    : null;
  return h(
    'div',
    { class: 'area' },
    h('div', { class: 'row' }, kindSelect(context, region, regionKind(inner)), invert),
    ...parameterControls(context, inner),
    ...(region ? reshapeControls(context) : []),
  );
}

function button(label: string, onclick: () => void): HTMLButtonElement {
  return h('button', { type: 'button', onclick }, label);
}

/** Draws a line over the surface: each click adds a vertex, Enter or the button finishes it, Escape cancels it. */
function drawLine(studio: Studio, key: number, radius: number): void {
  const path: { vertex: number }[] = [];
  const finish = (keep: boolean) => {
    studio.lineDrawing = null;
    studio.onPickVertex = null;
    if (keep) studio.history.end();
    else studio.history.cancel();
    studio.emit('drawing');
  };
  const next = (vertex: number) => {
    path.push({ vertex });
    studio.lineDrawing = { end: () => finish(true), cancel: () => finish(false) };
    studio.changeLayer({ region: { stroke: { path: [...path], radius } } }, false, key);
    studio.requestVertex(text.lineClick, next);
  };
  studio.requestVertex(text.lineClick, next);
}

/** Describes a region in a few words. */
export function describeRegion(region: Region | null): string {
  if (!region) return text.everywhere;
  const kind = Object.keys(region)[0] as string;
  if ('painted' in region) return text.strokes(region.painted.length);
  if ('not' in region && 'grown' in region.not) return text.shrunk;
  return text.regionNames[kind] ?? kind;
}
