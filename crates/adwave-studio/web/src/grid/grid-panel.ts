/** Panel of an image or a volume: how values are shown, the place of the cross, and what an edit changes. */

import { check, h, segments, slider } from '../dom';
import { timeOf } from '../frames';
import { formatNumber } from '../lengths';
import type { GridInfo } from '../protocol';
import type { Studio } from '../studio';
import { text } from '../text';
import type { GridView } from './grid-view';
import { positionOf } from './plane';
import type { ShadeMode } from './shade';

/** Steps of the sliders of the window. */
const STEPS = 1000;

/** Sliders of the darkest and the brightest value, with fields for their numbers. */
function windowControls(view: GridView) {
  const field = (label: string, end: 0 | 1) => {
    const number = h('input', { type: 'text', inputMode: 'decimal', 'aria-label': label });
    const range = h('input', { type: 'range', min: '0', max: String(STEPS), step: '1', 'aria-label': label });
    const set = (value: number) => {
      const window: [number, number] = [...view.look.window];
      window[end] = value;
      if (Number.isFinite(value) && window[1] > window[0]) view.setLook({ window });
      show();
    };
    range.addEventListener('input', () => {
      const [low, high] = ends();
      set(low + ((high - low) * range.valueAsNumber) / STEPS);
    });
    number.addEventListener('change', () => set(Number(number.value.replace(',', '.').replace('−', '-'))));
    const row = h('div', { class: 'window-row' }, h('span', {}, label), number, range);
    return { number, range, row };
  };
  const fields = [field(text.windowLow, 0), field(text.windowHigh, 1)] as const;
  /** Range of the sliders: that of the values, or more if the window is wider. */
  function ends(): [number, number] {
    const { least, greatest } = view.grid!.range;
    const [low, high] = view.look.window;
    return [Math.min(least, low), Math.max(greatest, high)];
  }
  function show(): void {
    if (!view.grid) return;
    const [low, high] = ends();
    for (const [k, { number, range }] of fields.entries()) {
      const value = view.look.window[k]!;
      if (document.activeElement !== number) number.value = formatNumber(value, 5);
      range.value = String(Math.round((STEPS * (value - low)) / (high - low || 1)));
      range.setAttribute('aria-valuetext', formatNumber(value, 5));
    }
  }
  const choose = (which: 'most' | 'all') => {
    const { least, greatest, low, high } = view.grid!.range;
    const [a, b] = which === 'most' ? [low, high] : [least, greatest];
    view.setLook({ window: b > a ? [a, b] : [a, a + 1] });
    show();
  };
  const button = (label: string, which: 'most' | 'all', title?: string) =>
    h('button', { type: 'button', title, onclick: () => choose(which) }, label);
  const buttons = h(
    'div',
    { class: 'row' },
    button(text.windowAuto, 'most', text.windowAutoHint),
    button(text.windowAll, 'all'),
  );
  return { rows: [...fields.map(({ row }) => row), buttons], show };
}

/** Sliders of the slices of a volume, one for each view. */
function sliceControls(view: GridView) {
  const list = h('div', { class: 'stack' });
  let sliders: { axis: number; set: (value: number) => void }[] = [];
  const rebuild = (grid: GridInfo) => {
    const slices = grid.views.filter((v) => v.fixed !== null);
    const made = slices.map(({ name, fixed }) => {
      const most = grid.sizes[fixed!]! - 1;
      const shown = (k: number) => `${k} / ${most}`;
      const range = { min: 0, max: most, step: 1, value: view.cross[fixed!]! };
      const row = slider(text.slice(name), range, shown, (k) => view.step(fixed!, k - view.cross[fixed!]!));
      return { axis: fixed!, row };
    });
    sliders = made.map(({ axis, row }) => ({ axis, set: row.set }));
    list.replaceChildren(...made.map(({ row }) => row));
  };
  const show = () => {
    for (const { axis, set } of sliders) set(view.cross[axis]!);
  };
  return { list, rebuild, show };
}

/** Facts about the place under the pointer or at the cross. */
function placeReadout(studio: Studio, view: GridView): HTMLElement {
  const list = h('dl', { class: 'facts' });
  const hint = h('p', { class: 'hint' }, text.placeHint);
  const show = () => {
    const { grid, place } = view;
    hint.hidden = place !== null;
    list.hidden = place === null;
    if (!grid || !place) return;
    const numbers = (values: readonly number[]) =>
      values.some(Number.isNaN) ? text.noData : values.map((x) => formatNumber(x, 5)).join(', ');
    const unit = unitOf(grid);
    const position = positionOf(grid, place.at).slice(0, Math.max(2, grid.sizes.length));
    const index = place.at.map((k, axis) => `${grid.axes[axis]} ${k}`).join(', ');
    const pair = (name: string, value: string) => [h('dt', {}, name), h('dd', {}, value)];
    const { frames } = grid;
    const frame = (k: number) => text.frameOf(k + 1, frames!.n, timeOf(frames!.step, k));
    const isEdited = place.after.some((x, c) => x !== place.before[c]) && !Number.isNaN(place.before[0]);
    list.replaceChildren(
      ...pair(text.valueHere, numbers(studio.view.showsOriginal ? place.before : place.after)),
      ...(isEdited ? pair(text.valueOfFile, numbers(place.before)) : []),
      ...(place.frame === null ? [] : pair(text.frameSlider, frame(place.frame))),
      ...pair(text.indexHere, index),
      ...pair(text.positionHere(unit), position.map((x) => formatNumber(x, 6)).join(', ')),
    );
  };
  view.onPlace(show);
  studio.on(['shape', 'before'], show);
  return h('div', {}, hint, list);
}

/** Unit of lengths for display; empty if the file states none. */
export function unitOf({ unit }: GridInfo): string {
  return (unit && text.lengthUnits[unit]) ?? unit ?? '';
}

/** Facts about the file and the edit. */
function facts(studio: Studio): HTMLElement {
  const list = h('dl', { class: 'facts' });
  const show = () => {
    const grid = studio.shape?.grid;
    if (!grid) return;
    const pair = (name: string, value: string) => [h('dt', {}, name), h('dd', {}, value)];
    const moved = studio.displacement;
    const unit = unitOf(grid);
    const spacings = grid.spacings.map((x) => formatNumber(x, 4)).join(' × ');
    list.replaceChildren(
      ...pair(text.fieldGreatest, moved ? formatNumber(moved.greatest) : '0'),
      ...pair(text.fieldRms, moved ? formatNumber(moved.rms) : '0'),
      ...pair(text.gridSizes(grid.axes.join(' × ')), grid.sizes.join(' × ')),
      ...pair(text.gridSpacings, unit ? `${spacings} ${unit}` : spacings),
      ...(grid.frames
        ? pair(text.gridFrames, text.framesEvery(grid.frames.n, timeOf(grid.frames.step, 1)))
        : []),
      ...pair(text.gridNumbers, text.numberTypes[grid.value_type] ?? grid.value_type),
      ...(grid.n_missing > 0 ? pair(text.gridMissing, String(grid.n_missing)) : []),
    );
  };
  studio.on(['shape', 'moved'], show);
  return list;
}

export function gridPanel(studio: Studio, view: GridView): HTMLElement {
  const modes = h('div', {});
  const relief = slider(
    text.relief,
    { min: -40, max: 40, step: 1, value: 0 },
    (v) => `${formatNumber(10 ** (v / 40), 2)} ×`,
    (v) => view.setLook({ relief: 10 ** (v / 40) }),
  );
  const smooth = check(text.smoothPixels, false, (on) => view.setLook({ smooth: on }));
  const window = windowControls(view);
  const slices = sliceControls(view);
  const windowRows = h('div', { class: 'stack' }, ...window.rows);
  const showMode = () => {
    windowRows.hidden = view.look.mode === 'relief';
    relief.hidden = view.look.mode !== 'relief';
  };
  const sliceTitle = h('h3', {}, text.slices);
  studio.on('shape', () => {
    const grid = studio.shape?.grid;
    if (!grid) return;
    const isImage = grid.sizes.length === 2;
    const choices: [ShadeMode, string][] = [
      ...(grid.n_channels >= 3 ? ([['color', text.shadeModes.color]] as [ShadeMode, string][]) : []),
      ['gray', text.shadeModes.gray],
      ['map', text.shadeModes.map],
      ...(isImage && grid.n_channels === 1
        ? ([['relief', text.shadeModes.relief]] as [ShadeMode, string][])
        : []),
    ];
    const choice = segments(text.shadeMode, choices, view.look.mode, (mode) => {
      view.setLook({ mode });
      choice.set(mode);
      showMode();
    });
    modes.replaceChildren(choice);
    sliceTitle.hidden = isImage;
    slices.list.hidden = isImage;
    slices.rebuild(grid);
    relief.set(Math.round(40 * Math.log10(view.look.relief)));
    smooth.querySelector('input')!.checked = view.look.smooth;
    window.show();
    showMode();
  });
  view.onPlace(slices.show);
  const zoom = (label: string, title: string, onclick: () => void) =>
    h('button', { type: 'button', 'aria-label': title, title, onclick }, label);
  return h(
    'section',
    { id: 'grid', role: 'tabpanel', 'aria-label': text.look },
    h('h2', {}, text.look),
    modes,
    windowRows,
    relief,
    smooth,
    h(
      'div',
      { class: 'row' },
      zoom('−', text.zoomOut, () => view.enlarge(0.8)),
      zoom('+', text.zoomIn, () => view.enlarge(1.25)),
      h('button', { type: 'button', onclick: () => view.fitAll() }, text.fitAll),
    ),
    sliceTitle,
    slices.list,
    h('h3', {}, text.placeTitle),
    placeReadout(studio, view),
    h('h3', {}, text.aboutGrid),
    facts(studio),
  );
}
