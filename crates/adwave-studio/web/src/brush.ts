/** Settings of the brush, its panel, and the conversion of strokes to regions. */

import type { BrushMode, BrushShape } from './compute/messages';
import { check, h, segments, slider } from './dom';
import type { Effect } from './effects';
import { grabPanel } from './grab';
import { formatNumber } from './lengths';
import { type BrushStroke, isInsideOut, type Region } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** Distance of stamps along a stroke, in radii. */
export const SPACING = 0.15;

export interface Brush {
  /** Effect of a stroke: that of a layer painted for it, or a region for the sliders only. */
  effect: Effect;
  /** Radius in percent of the diagonal. */
  radius: number;
  strength: number;
  /** Width of the soft edge, relative to the radius. */
  falloff: number;
  mode: BrushMode;
  symmetric: boolean;
  /** Paints only faces that are turned to the viewer. */
  frontOnly: boolean;
}

export const brush: Brush = {
  effect: 'smooth',
  radius: 5,
  strength: 1,
  falloff: 1,
  mode: 'add',
  symmetric: false,
  frontOnly: false,
};

/** Cosine between normal and viewing direction above which a front face is painted in full. */
const FRONT_FALLOFF = 0.2;
/** Blur length of a softening stroke, in radii. */
const SMOOTHING = 0.25;

/** Returns the brush in model units. The pressure of a pen scales it; `invert` swaps painting and erasing. */
export function brushShape(studio: Studio, pressure: number, invert: boolean): BrushShape {
  // The side that is seen is painted, also of faces that point inward.
  const outward = isInsideOut(studio.shape!) ? -1 : 1;
  const opposite: BrushMode = brush.mode === 'subtract' ? 'add' : 'subtract';
  const { diagonal, center } = studio.shape!;
  const radius = (brush.radius / 100) * diagonal * pressure;
  // The mirror plane is x = 0 if the shape is centered there, otherwise the center of the shape.
  const mirror = Math.abs(center[0]) < 0.02 * diagonal ? -center[0] : 0;
  return {
    radius,
    falloff: brush.falloff * radius,
    strength: brush.strength,
    mode: invert ? opposite : brush.mode,
    facing:
      brush.frontOnly && studio.shape!.kind === 'mesh'
        ? { direction: studio.view.camera.toward().map((x) => x * outward), falloff: FRONT_FALLOFF }
        : null,
    mirror: brush.symmetric ? mirror : null,
  };
}

/** Distance from the center at which the brush has half its weight. */
export function halfRadius(shape: BrushShape): number {
  return shape.radius - shape.falloff / 2;
}

/** Blur length of a softening stroke, in model units. */
export function smoothingRadius(shape: BrushShape): number {
  return SMOOTHING * shape.radius;
}

/** Converts a stroke to its form in a region. */
export function toStroke(indices: number[], shape: BrushShape): BrushStroke {
  const stamps: Region = { vertices: { indices, radius: shape.radius, falloff: shape.falloff } };
  const seen: Region = shape.facing ? { all: [stamps, { facing: shape.facing }] } : stamps;
  const region: Region = shape.strength < 1 ? { faded: { factor: shape.strength, region: seen } } : seen;
  if (shape.mode === 'smooth') return { smooth: { region, by: smoothingRadius(shape) } };
  return shape.mode === 'subtract' ? { subtract: region } : { add: region };
}

/** Appends a stroke to a region. */
export function appendStroke(before: Region | null, indices: number[], shape: BrushShape): Region {
  const strokes = !before ? [] : 'painted' in before ? before.painted : [{ add: before }];
  return { painted: [...strokes, toStroke(indices, shape)] };
}

/** Returns the stamped vertices of the last stroke, a list that is filled when the worker reports them. */
export function lastStamps(region: Region): number[] {
  if (!('painted' in region)) return [];
  const stroke = region.painted.at(-1)!;
  let inner = 'add' in stroke ? stroke.add : 'subtract' in stroke ? stroke.subtract : stroke.smooth.region;
  if ('faded' in inner) inner = inner.faded.region;
  if ('all' in inner) inner = inner.all[0]!;
  return 'vertices' in inner ? inner.vertices.indices : [];
}

/** True for effects that copy the detail of a surface or a cloud, which fields and graphs have not. */
function isOfShapes(effect: string): boolean {
  return effect === 'match' || effect === 'clone';
}

export function brushPanel(studio: Studio): HTMLElement {
  const radius = slider(
    text.radius,
    { min: 0.5, max: 30, step: 0.5, value: brush.radius },
    (v) => (studio.shape ? formatNumber((v / 100) * studio.shape.diagonal) : `${v} %`),
    (v) => {
      brush.radius = v;
    },
  );
  radius.classList.add('radius');
  const mode = segments<BrushMode>(
    text.brushMode,
    [
      ['add', text.add],
      ['subtract', text.subtract],
      ['smooth', text.smooth],
    ],
    null,
    (m) => {
      brush.mode = m;
      studio.setTool('brush');
    },
  );
  studio.on('tool', () => {
    section.classList.toggle('grabbing', studio.isGrabOn);
    title.textContent = studio.isGrabOn ? text.grab : text.brush;
    // A clone has its own soft edge, and undo takes it back.
    section.classList.toggle('cloning', brush.effect === 'clone');
    radius.set(brush.radius);
    mode.set(studio.isBrushOn ? brush.mode : null);
  });
  const lacksDetail = () => studio.target !== null || Boolean(studio.shape?.graph);
  const effects = (['smooth', 'enhance', 'flatten', 'match', 'clone', 'region'] as const).map((effect) =>
    h(
      'button',
      {
        type: 'button',
        'data-effect': effect,
        title: text.effectHints[effect],
        onclick: () => {
          if (lacksDetail() && isOfShapes(effect)) return;
          brush.effect = effect;
          studio.setTool('brush');
        },
      },
      text.effects[effect],
    ),
  );
  const effectHint = h('p', { class: 'hint' });
  const startPick = () => (brush.effect === 'clone' ? studio.pickCloneSource() : studio.detail.startPick());
  const pick = h('button', { type: 'button', onclick: startPick }, text.pickDetail);
  studio.on('tool', () => {
    for (const b of effects) {
      b.setAttribute('aria-pressed', String(studio.isBrushOn && b.dataset['effect'] === brush.effect));
      b.hidden = lacksDetail() && isOfShapes(b.dataset['effect']!);
    }
    effectHint.textContent = studio.isBrushOn ? text.effectHints[brush.effect] : text.brushOff;
    pick.hidden = !studio.isBrushOn || (brush.effect !== 'match' && brush.effect !== 'clone');
  });
  studio.on('target', () => {
    if (lacksDetail() && isOfShapes(brush.effect)) brush.effect = 'smooth';
    studio.emit('tool');
  });
  const front = check(text.frontOnly, false, (on) => {
    brush.frontOnly = on;
  });
  studio.on('shape', () => {
    radius.set(brush.radius);
    studio.emit('tool');
    // Points have no front side.
    front.hidden = studio.shape!.kind !== 'mesh';
  });
  const falloff = slider(
    text.falloff,
    { min: 0, max: 100, step: 5, value: 100 },
    (v) => `${v} %`,
    (v) => {
      brush.falloff = v / 100;
    },
  );
  falloff.classList.add('falloff');
  const title = h('h2', {}, text.brush);
  const section = h(
    'section',
    { class: 'brush-panel', id: 'brush', role: 'tabpanel', 'aria-label': text.brush },
    h('header', {}, title),
    grabPanel(studio),
    h('div', { class: 'effects', role: 'group', 'aria-label': text.effect }, ...effects),
    effectHint,
    pick,
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
    falloff,
    check(text.symmetry, false, (on) => {
      brush.symmetric = on;
    }),
    front,
  );
  return section;
}
