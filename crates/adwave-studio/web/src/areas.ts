/** Where the selected layer acts: everywhere, painted, a ball, a box, a half-space, by a field; inverted. */

import { h, iconButton, select, slider } from './dom';
import { lengthOf, short } from './lengths';
import type { FieldName, Region, Shape } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** Fields of the file: what is computed of the shape is no region, since a recipe would not know it. */
function fileFields(shape: Shape): FieldName[] {
  return shape.fields.filter((f) => !f.edited && !/^band-\d+$/.test(f.name));
}

type Kind = 'everywhere' | 'painted' | 'ball' | 'box' | 'half-space' | 'field' | 'other';

/** A region without the inversions round it, and whether they leave it inverted. */
function bare(region: Region | null): { inner: Region | null; inverted: boolean } {
  let inner = region;
  let inverted = false;
  while (inner && 'not' in inner) {
    inner = inner.not;
    inverted = !inverted;
  }
  return { inner, inverted };
}

function kindOf(region: Region | null): Kind {
  if (!region) return 'everywhere';
  const kind = Object.keys(region)[0] as string;
  if (kind === 'vertices' || kind === 'painted') return 'painted';
  return ['ball', 'box', 'half-space', 'field'].includes(kind) ? (kind as Kind) : 'other';
}

export function regionChooser(studio: Studio): HTMLElement {
  const shape = studio.shape;
  if (!shape) return h('div');
  const { region, key } = studio.layer;
  const { inner, inverted } = bare(region);
  const kind = kindOf(inner);
  const { diagonal, centre } = shape;
  const wrap = (r: Region | null): Region | null => (inverted && r ? { not: r } : r);
  const set = (r: Region | null, step: boolean) => studio.changeLayer({ region: wrap(r) }, step, key);

  const start = (next: Kind): Region | null => {
    const half = diagonal / 4;
    switch (next) {
      case 'painted':
        return { painted: [] };
      case 'ball':
        return { ball: { centre: { vertex: studio.lastVertex ?? 0 }, radius: 0.15 * diagonal } };
      case 'box':
        return {
          box: {
            min: centre.map((c) => c - half),
            max: centre.map((c) => c + half),
            falloff: 0.05 * diagonal,
          },
        };
      case 'half-space':
        return { 'half-space': { point: [...centre], normal: [1, 0, 0], falloff: 0.1 * diagonal } };
      case 'field': {
        const name = fileFields(shape)[0]?.name;
        return name ? { field: { name, low: 0, high: 1 } } : null;
      }
      default:
        return null;
    }
  };
  const choices = text.regionChoices.filter(
    ([k]) =>
      (k !== 'field' || fileFields(shape).length > 0 || kind === 'field') &&
      (k !== 'other' || kind === 'other'),
  ) as [Kind, string][];
  const chooser = select<Kind>(text.where, choices, kind, (next) => {
    if (next === 'painted') studio.setBrush(true);
    set(start(next), true);
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
      (v) => short((v / 100) * diagonal),
      (v, done) => {
        // Regions of the server are asked for at the end of a movement only.
        if (done) set(moved((v / 100) * diagonal), true);
      },
    );
  if (inner && 'ball' in inner) {
    const ball = inner.ball;
    parts.push(
      h('p', { class: 'hint' }, text.ballHint),
      length(text.radius, lengthOf(ball.radius, diagonal), 60, (radius) => ({ ball: { ...ball, radius } })),
      h(
        'button',
        {
          type: 'button',
          onclick: () => {
            studio.say(text.clickCentre);
            studio.pickNext = (vertex) => set({ ball: { ...ball, centre: { vertex } } }, true);
          },
        },
        text.moveCentre,
      ),
    );
  } else if (inner && 'box' in inner) {
    const box = inner.box;
    for (const c of [0, 1, 2]) {
      for (const end of ['min', 'max'] as const) {
        parts.push(
          slider(
            `${end === 'min' ? text.from : text.to} ${'xyz'[c]}`,
            { min: -50, max: 50, step: 0.5, value: (100 * (box[end][c]! - centre[c]!)) / diagonal },
            (v) => short(centre[c]! + (v / 100) * diagonal),
            (v, done) => {
              if (!done) return;
              set({ box: { ...box, [end]: box[end].with(c, centre[c]! + (v / 100) * diagonal) } }, true);
            },
          ),
        );
      }
    }
    parts.push(
      length(text.falloff, lengthOf(box.falloff ?? '5%', diagonal), 30, (falloff) => ({
        box: { ...box, falloff },
      })),
    );
  } else if (inner && 'half-space' in inner) {
    const half = inner['half-space'];
    const axis = half.normal.findIndex((x) => x !== 0);
    const side = `${(half.normal[axis] ?? 1) < 0 ? '-' : '+'}${'xyz'[Math.max(0, axis)]}`;
    parts.push(
      select(
        text.towards,
        ['+x', '-x', '+y', '-y', '+z', '-z'].map((s) => [s, s.replace('-', '−')] as const),
        side,
        (s) => {
          const normal = [0, 0, 0].with('xyz'.indexOf(s[1]!), s[0] === '-' ? -1 : 1);
          set({ 'half-space': { ...half, point: [...centre], normal } }, true);
        },
      ),
      slider(
        text.plane,
        {
          min: -50,
          max: 50,
          step: 0.5,
          value: (100 * ((half.point[axis] ?? 0) - centre[Math.max(0, axis)]!)) / diagonal,
        },
        (v) => short(centre[Math.max(0, axis)]! + (v / 100) * diagonal),
        (v, done) => {
          if (!done) return;
          const a = Math.max(0, axis);
          set(
            { 'half-space': { ...half, point: half.point.with(a, centre[a]! + (v / 100) * diagonal) } },
            true,
          );
        },
      ),
      length(text.falloff, lengthOf(half.falloff ?? '5%', diagonal), 60, (falloff) => ({
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
        fileFields(shape).map((f) => [f.name, f.label] as const),
        field.name,
        (name) => {
          set({ field: { ...field, name } }, true);
        },
      ),
      number('low', text.fieldLow),
      number('high', text.fieldHigh),
      h(
        'button',
        {
          type: 'button',
          onclick: () => {
            studio.fieldRange(field.name).then(
              ([low, high]) => set({ field: { ...field, low, high } }, true),
              (e: Error) => studio.say(e.message, 'error'),
            );
          },
        },
        text.fieldFit,
      ),
    );
  }
  return h('div', { class: 'area' }, ...parts);
}
