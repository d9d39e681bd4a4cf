/** The brush: its settings, and a stroke from pointer to region. */

import type { BrushShape } from './compute/messages';
import { check, h, segments, slider } from './dom';
import { short } from './lengths';
import type { BrushStroke, Region } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** Stamps along a stroke, in radii. */
export const SPACING = 0.15;

export interface Brush {
  /** In percent of the diagonal. */
  radius: number;
  strength: number;
  /** Width of the fall, as part of the radius. */
  falloff: number;
  subtract: boolean;
  symmetric: boolean;
}

export const brush: Brush = { radius: 5, strength: 1, falloff: 1, subtract: false, symmetric: false };

/** The brush in model units. `pressure` of a pen makes it smaller; `invert` swaps adding and subtracting. */
export function brushShape(studio: Studio, pressure: number, invert: boolean): BrushShape {
  const { diagonal, centre } = studio.shape!;
  const radius = (brush.radius / 100) * diagonal * pressure;
  // The plane of symmetry is x = 0 where the shape is about it, else the middle.
  const mirror = Math.abs(centre[0]) < 0.02 * diagonal ? -centre[0] : 0;
  return {
    radius,
    falloff: brush.falloff * radius,
    strength: brush.strength,
    subtract: brush.subtract !== invert,
    mirror: brush.symmetric ? mirror : null,
  };
}

/** Distance from the middle at which the brush has half its weight. */
export function halfRadius(shape: BrushShape): number {
  return shape.radius - shape.falloff / 2;
}

/** What a stroke makes of the region that was there. */
export function painted(before: Region | null, indices: number[], shape: BrushShape): Region {
  const stamps: Region = { vertices: { indices, radius: shape.radius, falloff: shape.falloff } };
  const region: Region = shape.strength < 1 ? { faded: { factor: shape.strength, region: stamps } } : stamps;
  const stroke: BrushStroke = shape.subtract ? { subtract: region } : { add: region };
  const strokes = !before ? [] : 'painted' in before ? before.painted : [{ add: before }];
  return { painted: [...strokes, stroke] };
}

export function brushPanel(studio: Studio): HTMLElement {
  const toggle = h(
    'button',
    {
      type: 'button',
      class: 'wide',
      'aria-pressed': 'false',
      onclick: () => studio.setBrush(!studio.brushOn),
    },
    text.brushOn,
  );
  const radius = slider(
    text.radius,
    { min: 0.5, max: 30, step: 0.5, value: brush.radius },
    (v) => (studio.shape ? short((v / 100) * studio.shape.diagonal) : `${v} %`),
    (v) => {
      brush.radius = v;
    },
  );
  const mode = segments(
    text.brushMode,
    [
      ['add', text.add],
      ['subtract', text.subtract],
    ],
    'add',
    (m) => {
      brush.subtract = m === 'subtract';
      mode.set(m);
    },
  );
  const match = h('div', { class: 'row' });
  match.append(
    h(
      'button',
      {
        type: 'button',
        title: text.takeHint,
        onclick: () => {
          studio.say(text.takeClick);
          studio.pickNext = (vertex) =>
            studio.takeDetail(vertex, (brush.radius / 100) * studio.shape!.diagonal);
        },
      },
      text.take,
    ),
    h('button', { type: 'button', title: text.giveHint, onclick: () => studio.giveDetail() }, text.give),
  );
  studio.on('tool', () => {
    toggle.setAttribute('aria-pressed', String(studio.brushOn));
    radius.set(brush.radius);
    mode.set(brush.subtract ? 'subtract' : 'add');
  });
  studio.on('shape', () => radius.set(brush.radius));
  return h(
    'section',
    { class: 'brush-panel', id: 'brush', 'aria-label': text.brush },
    h('header', {}, h('h2', {}, text.brush)),
    toggle,
    mode,
    radius,
    slider(
      text.strength,
      { min: 5, max: 100, step: 5, value: 100 },
      (v) => `${v} %`,
      (v) => {
        brush.strength = v / 100;
      },
    ),
    slider(
      text.falloff,
      { min: 0, max: 100, step: 5, value: 100 },
      (v) => `${v} %`,
      (v) => {
        brush.falloff = v / 100;
      },
    ),
    check(text.symmetry, false, (on) => {
      brush.symmetric = on;
    }),
    h('details', {}, h('summary', {}, text.matching), match),
  );
}
