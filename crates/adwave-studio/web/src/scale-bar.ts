/** Axes and a scale bar in model units, for the depth of the pivot. */

import { Vector3 } from 'three';
import { h } from './dom';
import { formatNumber } from './lengths';
import { text } from './text';
import type { View } from './view';

/** Lengths of the bar in pixels. */
const BAR = { least: 40, most: 120 };
/** Length of an axis in pixels, and half the size of its drawing. */
const AXIS = { length: 17, half: 26 };

/** Largest of 1, 2 and 5 times a power of ten that is at most `most`. */
export function roundLength(most: number): number {
  if (!(most > 0) || !Number.isFinite(most)) return 0;
  const ten = 10 ** Math.floor(Math.log10(most));
  const digit = [5, 2, 1].find((d) => d * ten <= most * (1 + 1e-12)) ?? 1;
  return digit * ten;
}

function svg<K extends keyof SVGElementTagNameMap>(
  tag: K,
  attributes: Record<string, string>,
): SVGElementTagNameMap[K] {
  const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}

/** Creates the axes and the bar, which follow the camera. */
export function scaleBar(view: View): HTMLElement {
  const { half } = AXIS;
  const axes = svg('svg', { viewBox: `${-half} ${-half} ${2 * half} ${2 * half}`, class: 'axes' });
  const arms = (['x', 'y', 'z'] as const).map((name, axis) => {
    const line = svg('line', { x1: '0', y1: '0', class: `axis-${name}` });
    const label = svg('text', { class: `axis-${name}` });
    label.textContent = name;
    axes.append(line, label);
    return { axis, line, label };
  });
  const bar = h('span', { class: 'bar-line' });
  const length = h('span', {});
  const element = h(
    'div',
    { class: 'scale-bar', title: text.scaleBar, 'aria-hidden': 'true' },
    axes,
    h('span', { class: 'bar-box' }, length, bar),
  );
  let shown = '';
  view.afterFrame(() => {
    const { camera } = view;
    const q = camera.three.quaternion;
    const pixel = camera.pixel;
    const state = `${q.x} ${q.y} ${q.z} ${q.w} ${pixel}`;
    if (state === shown) return;
    shown = state;
    const turned = q.clone().invert();
    for (const { axis, line, label } of arms) {
      const end = new Vector3().setComponent(axis, AXIS.length).applyQuaternion(turned);
      line.setAttribute('x2', end.x.toFixed(1));
      line.setAttribute('y2', (-end.y).toFixed(1));
      // The label of an axis toward the viewer stays beside the center.
      label.setAttribute('x', (1.32 * end.x).toFixed(1));
      label.setAttribute('y', (-1.32 * end.y).toFixed(1));
      label.style.opacity = end.z < -0.8 * AXIS.length ? '0.4' : '1';
    }
    const size = roundLength(pixel * BAR.most);
    bar.style.width = `${Math.max(BAR.least, size / pixel).toFixed(1)}px`;
    length.textContent = text.units(formatNumber(size));
  });
  return element;
}
