/** Controls of the selected layer's region: its kind and parameters, inversion, growing and blurring. */

import { h, iconButton, select, slider } from './dom';
import { firstField, regionFields } from './fields';
import { formatNumber, toModelUnits } from './lengths';
import type { Region } from './protocol';
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

export function regionChooser(studio: Studio): HTMLElement {
  const shape = studio.shape;
  if (!shape) return h('div');
  const { region, key } = studio.layer;
  const { inner, inverted } = stripInversions(region);
  const kind = regionKind(inner);
  const { diagonal, center } = shape;
  const wrap = (r: Region | null): Region | null => (inverted && r ? { not: r } : r);
  const set = (r: Region | null, step: boolean) => studio.changeLayer({ region: wrap(r) }, step, key);

  const start = (next: RegionChoice): Region | null => {
    const half = diagonal / 4;
    switch (next) {
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
  };
  const choices = text.regionChoices
    .filter(([k]) => k !== 'other' || kind === 'other')
    .map(([k, name]) => [k, k === 'other' ? text.otherRegion(describeRegion(region)) : name]) as [
    RegionChoice,
    string,
  ][];
  /** Fits the range of a field to its values. */
  const fit = (name: string) =>
    studio.fieldRange(name).then(
      ([low, high]) => set({ field: { name, low, high } }, true),
      (e: Error) => studio.showMessage(e.message, 'error'),
    );
  const pickPart = () => {
    studio.showMessage(text.clickPart);
    studio.onPickVertex = (vertex) => set({ component: { vertex } }, true);
  };
  const chooser = select<RegionChoice>(text.where, choices, kind, (next) => {
    if (next === 'painted') studio.setBrush(true);
    if (next === 'stroke') {
      drawLine(studio, key, 0.04 * diagonal);
      return;
    }
    const region = start(next);
    if (region && 'field' in region) {
      void fit(region.field.name);
      return;
    }
    set(region, true);
    if (next === 'component') pickPart();
  });
  const parts: (Node | null)[] = [
    h(
      'div',
      { class: 'row' },
      chooser,
      region
        ? iconButton(
            'invert',
            text.invert,
            () => studio.changeLayer({ region: inverted ? inner : { not: region } }, true, key),
            { 'aria-pressed': String(inverted) },
          )
        : null,
    ),
  ];
  const length = (label: string, value: number, most: number, moved: (v: number) => Region) =>
    slider(
      label,
      { min: 0.5, max: most, step: 0.5, value: Math.min(most, (100 * value) / diagonal) },
      (v) => formatNumber((v / 100) * diagonal),
      (v, done) => {
        // Some regions are computed by the server, hence only when the slider is released.
        if (done) set(moved((v / 100) * diagonal), true);
      },
    );
  if (inner && 'ball' in inner) {
    const ball = inner.ball;
    parts.push(
      h('p', { class: 'hint' }, text.ballHint),
      length(text.radius, toModelUnits(ball.radius, diagonal), 60, (radius) => ({
        ball: { ...ball, radius },
      })),
      button(text.moveCenter, () => {
        studio.showMessage(text.clickCenter);
        studio.onPickVertex = (vertex) => set({ ball: { ...ball, center: { vertex } } }, true);
      }),
    );
  } else if (inner && 'stroke' in inner) {
    const { stroke } = inner;
    parts.push(
      length(text.radius, toModelUnits(stroke.radius, diagonal), 30, (radius) => ({
        stroke: { ...stroke, radius },
      })),
      studio.lineDrawing
        ? button(text.lineEnd, () => studio.lineDrawing?.end())
        : button(text.lineAgain, () => drawLine(studio, key, toModelUnits(stroke.radius, diagonal))),
    );
  } else if (inner && 'component' in inner) {
    parts.push(button(text.choosePart, pickPart));
  } else if (inner && 'box' in inner) {
    const box = inner.box;
    for (const c of [0, 1, 2]) {
      for (const end of ['min', 'max'] as const) {
        parts.push(
          slider(
            `${end === 'min' ? text.from : text.to} ${'xyz'[c]}`,
            { min: -50, max: 50, step: 0.5, value: (100 * (box[end][c]! - center[c]!)) / diagonal },
            (v) => formatNumber(center[c]! + (v / 100) * diagonal),
            (v, done) => {
              if (!done) return;
              set({ box: { ...box, [end]: box[end].with(c, center[c]! + (v / 100) * diagonal) } }, true);
            },
          ),
        );
      }
    }
    parts.push(
      length(text.falloff, toModelUnits(box.falloff ?? '5%', diagonal), 30, (falloff) => ({
        box: { ...box, falloff },
      })),
    );
  } else if (inner && 'half-space' in inner) {
    const half = inner['half-space'];
    const axis = half.normal.findIndex((x) => x !== 0);
    const side = `${(half.normal[axis] ?? 1) < 0 ? '-' : '+'}${'xyz'[Math.max(0, axis)]}`;
    parts.push(
      select(
        text.toward,
        ['+x', '-x', '+y', '-y', '+z', '-z'].map((s) => [s, s.replace('-', '−')] as const),
        side,
        (s) => {
          const normal = [0, 0, 0].with('xyz'.indexOf(s[1]!), s[0] === '-' ? -1 : 1);
          set({ 'half-space': { ...half, point: [...center], normal } }, true);
        },
      ),
      slider(
        text.plane,
        {
          min: -50,
          max: 50,
          step: 0.5,
          value: (100 * ((half.point[axis] ?? 0) - center[Math.max(0, axis)]!)) / diagonal,
        },
        (v) => formatNumber(center[Math.max(0, axis)]! + (v / 100) * diagonal),
        (v, done) => {
          if (!done) return;
          const a = Math.max(0, axis);
          set(
            { 'half-space': { ...half, point: half.point.with(a, center[a]! + (v / 100) * diagonal) } },
            true,
          );
        },
      ),
      length(text.falloff, toModelUnits(half.falloff ?? '5%', diagonal), 60, (falloff) => ({
        'half-space': { ...half, falloff },
      })),
    );
  } else if (inner && 'field' in inner) {
    const field = inner.field;
    const number = (name: 'low' | 'high', label: string) => {
      const input = h('input', {
        type: 'number',
        step: 'any',
        value: String(field[name]),
        onchange: () => {
          if (Number.isFinite(input.valueAsNumber))
            set({ field: { ...field, [name]: input.valueAsNumber } }, true);
        },
      });
      return h('label', { class: 'field' }, h('span', {}, label), input);
    };
    parts.push(
      select(
        text.field,
        regionFields(shape).map((f) => [f.name, f.label] as const),
        field.name,
        (name) => void fit(name),
      ),
      number('low', text.fieldLow),
      number('high', text.fieldHigh),
      button(text.fieldFit, () => void fit(field.name)),
    );
  }
  if (region) {
    const change = (label: string, title: string, what: Change) =>
      h('button', { type: 'button', title, onclick: () => reshape(studio, what) }, label);
    parts.push(
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
        (v) => formatNumber((v / 100) * diagonal),
        (v) => {
          amount = v;
        },
      ),
    );
  }
  return h('div', { class: 'area' }, ...parts);
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
    studio.onPickVertex = next;
  };
  studio.showMessage(text.lineClick);
  studio.onPickVertex = next;
}

/** Describes a region in a few words. */
export function describeRegion(region: Region | null): string {
  if (!region) return text.everywhere;
  const kind = Object.keys(region)[0] as string;
  if ('painted' in region) return text.strokes(region.painted.length);
  if ('not' in region && 'grown' in region.not) return text.shrunk;
  return text.regionNames[kind] ?? kind;
}
