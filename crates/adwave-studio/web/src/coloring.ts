/** Coloring by a scalar field, with a legend in its units. */

import { DEVIATION } from './beside';
import {
  classesOf,
  colorAt,
  hasValues,
  histogram,
  type MapName,
  movedOnly,
  type RangeRule,
  rangeOf,
} from './colors';
import { h, select } from './dom';
import { type FrameBar, frameBar, framesOf } from './frames';
import { formatNumber } from './lengths';
import type { FieldName } from './protocol';
import { areNeutral, type DocLayer, layersOf } from './state';
import type { Studio } from './studio';
import { text } from './text';

/** True for fields of the server; the page computes displacement and band sizes itself. */
function isServerField(field: FieldName): boolean {
  return field.name !== 'change' && !/^band-\d+$/.test(field.name);
}

/** Largest number of classes in the legend. */
const MOST_SWATCHES = 12;

/** Bins of the histogram above the colors, its height in pixels, and a gray that is seen on light and dark. */
const HISTOGRAM = { bins: 32, height: 24, color: 'rgb(132 136 140)' };

export interface Coloring {
  controls: HTMLElement[];
  legend: HTMLElement;
  /** Slider over the frames of a field over time. */
  frames: HTMLElement;
  toggleChange(): void;
  /** Value of the list of colors that is shown. */
  readonly shown: string;
  show(name: string): void;
  /** Text with the value at a vertex; empty without coloring. */
  valueAt(v: number): string;
}

export function coloring(studio: Studio): Coloring {
  const { view } = studio;
  let colored = 'none';
  let values: Float32Array | null = null;
  /** Values of the shown field without its edit; `null` if it has none. */
  let unedited: Float32Array | null = null;
  /** Layers of the shown field, as far as they are known to the picture. */
  let shownLayers: readonly DocLayer[] | null = null;
  let title = '';
  let unit = '';
  let diverging = false;
  let map: MapName = 'viridis';
  let rule: RangeRule = 'most';
  /** Values from all frames of the series that is shown, which share the range of colors; `null` for other fields. */
  let series: { name: string; sample: Float32Array } | null = null;
  const frames: FrameBar = frameBar(showFrame);
  /** Values of the classes of the shown field; `null` for a field with a color map. */
  let classes: number[] | null = null;

  const colorSelect = h('select', {
    'aria-label': text.colors,
    onchange: () => void color(colorSelect.value),
  });
  const mapSelect = select<MapName>(text.map, text.maps, 'viridis', (m) => {
    map = m;
    paintLegend();
  });
  const ruleSelect = select<'most' | 'all'>(
    text.range,
    [
      ['most', text.rangeMost],
      ['all', text.rangeAll],
    ],
    'most',
    (r) => {
      rule = r;
      paintLegend();
    },
  );
  const low = h('input', {
    type: 'number',
    step: 'any',
    'aria-label': text.rangeLow,
    onchange: () => byHand(),
  });
  const high = h('input', {
    type: 'number',
    step: 'any',
    'aria-label': text.rangeHigh,
    onchange: () => byHand(),
  });
  let withdraw = () => {};
  const byHand = () => {
    if (!Number.isFinite(low.valueAsNumber) || !Number.isFinite(high.valueAsNumber)) return;
    withdraw();
    if (low.valueAsNumber >= high.valueAsNumber) {
      withdraw = studio.showMessage(text.badRange, 'error');
      return;
    }
    rule = { low: low.valueAsNumber, high: high.valueAsNumber };
    paintLegend();
  };
  const colorOptions = h(
    'div',
    { class: 'color-options', hidden: true },
    mapSelect,
    ruleSelect,
    h('div', { class: 'row' }, low, high),
  );

  const bar = h('canvas', { width: 256, height: 1, 'aria-hidden': 'true' });
  const legendTitle = h('span', { class: 'legend-title' });
  const bins = h('canvas', {
    width: 256,
    height: HISTOGRAM.height,
    class: 'histogram',
    'aria-hidden': 'true',
  });
  const numbers = h('div', { class: 'legend-numbers' });
  const swatches = h('ul', { class: 'swatches', hidden: true });
  const legend = h(
    'figure',
    { class: 'legend', hidden: true },
    h('figcaption', {}, legendTitle),
    bins,
    bar,
    numbers,
    swatches,
  );

  function paintLegend(): void {
    if (!values) {
      legend.hidden = true;
      return;
    }
    swatches.hidden = true;
    bar.hidden = false;
    bins.hidden = true;
    legendTitle.textContent = unit ? `${title} (${unit})` : title;
    if (classes) {
      paintClasses(classes);
      return;
    }
    const ranged = series?.sample ?? unedited ?? values;
    if (!hasValues(ranged)) {
      bar.hidden = true;
      numbers.replaceChildren(h('span', {}, text.noValues));
      legend.hidden = false;
      return;
    }
    // The colors of a field keep their meaning while it is edited.
    const range = rangeOf(colored === 'change' ? movedOnly(ranged) : ranged, rule, diverging);
    view.setScalarRange(range, map);
    const context = bar.getContext('2d')!;
    for (let i = 0; i < 256; i++) {
      const [r, g, b] = colorAt(map, i / 255);
      context.fillStyle = `rgb(${r} ${g} ${b})`;
      context.fillRect(i, 0, 1, 1);
    }
    paintHistogram(range);
    numbers.replaceChildren(
      ...[0, 0.5, 1].map((t) => {
        const x = range[0] + t * (range[1] - range[0]);
        return h('span', {}, formatNumber(Math.abs(x) < 1e-3 * (range[1] - range[0]) ? 0 : x));
      }),
    );
    if (document.activeElement !== low) low.value = range[0].toPrecision(4);
    if (document.activeElement !== high) high.value = range[1].toPrecision(4);
    legend.hidden = false;
  }

  /** Draws how many vertices have the values of each color. */
  function paintHistogram(range: [number, number]): void {
    const counts = histogram(values!, range, HISTOGRAM.bins);
    const most = Math.max(...counts);
    bins.hidden = most === 0;
    if (most === 0) return;
    const context = bins.getContext('2d')!;
    context.clearRect(0, 0, bins.width, bins.height);
    context.fillStyle = HISTOGRAM.color;
    const width = bins.width / HISTOGRAM.bins;
    for (const [i, count] of counts.entries()) {
      const height = Math.round((bins.height * count) / most);
      context.fillRect(i * width, bins.height - height, width - 1, height);
    }
  }

  /** Lists the classes; the colors of vertices are their numbers in this list. */
  function paintClasses(list: readonly number[]): void {
    view.setScalarRange([0, 255], 'classes');
    bar.hidden = true;
    numbers.replaceChildren();
    const shown = list.slice(0, MOST_SWATCHES);
    swatches.replaceChildren(
      ...shown.map((value, i) => {
        const [r, g, b] = colorAt('classes', i / 255);
        return h('li', {}, h('i', { style: `background: rgb(${r} ${g} ${b})` }), String(value));
      }),
      list.length > shown.length ? h('li', {}, `+ ${list.length - shown.length}`) : '',
    );
    swatches.hidden = false;
    legend.hidden = false;
  }

  let asked = 0;
  async function color(name: string): Promise<void> {
    const mine = ++asked;
    const changed = name !== colored;
    const entry = entryOf(colored);
    colored = name;
    colorSelect.value = entryOf(name);
    colorOptions.hidden = name === 'none';
    classes = null;
    const list = showFrames(name);
    if (name !== DEVIATION) view.setBesideScalar(null);
    const field = studio.shape?.fields.find((f) => `field-${f.name}` === name);
    showEditable(field?.editable ? field.name : null);
    if (name === 'none' || field?.rgb) {
      values = null;
      unedited = null;
      colorOptions.hidden = true;
      if (field?.rgb) {
        try {
          const colors = await studio.api.colors(studio.shape!.id, field.name);
          if (mine === asked) view.setRgb(colors);
        } catch (error) {
          studio.showMessage((error as Error).message, 'error');
        }
        paintLegend();
        return;
      }
      view.setScalar(null);
      paintLegend();
      return;
    }
    try {
      if (name === DEVIATION) {
        const found = await studio.beside.measure();
        if (mine !== asked) return;
        if (!found) {
          void color('none');
          return;
        }
        values = found.own;
        unedited = null;
        title = text.deviation(studio.beside.other!.name);
        unit = text.modelUnits;
        diverging = found.about.signed;
        view.setBesideScalar(found.other);
      } else if (name === 'change' || name.startsWith('band-')) {
        const level = name === 'change' ? 0 : Number(name.slice(5));
        if (name === 'change') await studio.display.waitUntilSettled();
        const answer = await studio.engine.call('scalar', level ? { band: level } : 'change');
        if (mine !== asked) return;
        values = answer.values;
        unedited = null;
        title = level ? text.bandSize(level) : text.change;
        unit = '';
        diverging = false;
      } else {
        const answer = await studio.api.field(studio.shape!.id, name.slice(6));
        if (mine !== asked) return;
        const after = field?.editable ? await editedValues(field.name) : null;
        if (mine !== asked) return;
        if (list.length < 2) series = null;
        else if (series?.name !== list[0]!.name) {
          const sample = await studio.api.seriesSample(studio.shape!.id, list[0]!.name);
          if (mine !== asked) return;
          series = { name: list[0]!.name, sample };
        }
        values = after ?? answer.values;
        unedited = after && answer.values;
        title = answer.info.label;
        unit = answer.info.unit;
        diverging = answer.info.diverging;
        if (!field?.edited && !after && !series) classes = classesOf(values);
      }
    } catch (error) {
      if (mine !== asked) return;
      studio.showMessage((error as Error).message, 'error');
      if (changed) void color('none');
      return;
    }
    if (!name.startsWith('field-')) series = null;
    if (changed && entry !== entryOf(name)) {
      rule = 'most';
      map = diverging ? 'diverging' : 'viridis';
      mapSelect.querySelector('select')!.value = map;
      ruleSelect.querySelector('select')!.value = 'most';
    }
    colorOptions.hidden = classes !== null;
    if (classes) {
      const numbered = new Map(classes.map((value, i) => [value, i]));
      view.setScalar(
        values.map((x) => numbered.get(x) ?? Number.NaN),
        [0, 255],
        'classes',
      );
    } else view.setScalar(values, [0, 1], map, unedited);
    paintLegend();
  }

  /** Entry of the list of colors for a field: that of the first frame for all frames of a series. */
  function entryOf(name: string): string {
    if (!name.startsWith('field-') || !studio.shape) return name;
    const first = framesOf(studio.shape, name.slice(6))[0];
    return first ? `field-${first.name}` : name;
  }

  /** Shows the slider over the frames of a field if it has several; returns them. */
  function showFrames(name: string): FieldName[] {
    const list = studio.shape && name.startsWith('field-') ? framesOf(studio.shape, name.slice(6)) : [];
    frames.set(
      list,
      list.findIndex((f) => `field-${f.name}` === name),
    );
    return list;
  }

  /** Colors the shape by a frame of the series that is shown; what can be edited changes when the picture rests. */
  async function showFrame(field: FieldName, rest: boolean): Promise<void> {
    if (rest) return color(`field-${field.name}`);
    const mine = ++asked;
    const layers = field.editable ? layersOf(studio.doc, field.name) : null;
    const { id } = studio.shape!;
    try {
      const isEdited = layers !== null && !areNeutral(layers);
      const next = isEdited
        ? await studio.api.editedField(id, field.name)
        : (await studio.api.field(id, field.name)).values;
      if (mine !== asked) return;
      colored = `field-${field.name}`;
      values = next;
      title = field.label;
      if (unedited) view.setScalar(values, [0, 1], map);
      else view.updateScalar(values);
      unedited = null;
      view.markMoving();
      paintLegend();
    } catch (error) {
      if (mine !== asked) return;
      frames.stop();
      studio.showMessage((error as Error).message, 'error');
    }
  }

  /** Tells which field can be edited; one that is not shown any more is edited no longer. */
  function showEditable(name: string | null): void {
    const isPlaced = studio.shape?.graph?.placed;
    // A graph without positions has nothing else to edit.
    if (isPlaced && name === null && studio.shownField !== null) return;
    const isOther = name !== studio.shownField;
    if (isOther) {
      studio.shownField = name;
      studio.emit('target');
    }
    const isEdited = studio.target !== null || (isOther && isPlaced);
    if (isEdited && studio.target !== name) void studio.setTarget(name);
  }

  /** Values of a field after its edit; `null` if it has none. */
  async function editedValues(name: string): Promise<Float32Array | null> {
    const { fieldEditor } = studio;
    shownLayers = layersOf(studio.doc, name);
    if (studio.target === name) return fieldEditor.loaded === name ? fieldEditor.values : null;
    if (!shownLayers || areNeutral(shownLayers)) return null;
    const id = studio.shape!.id;
    await studio.saver?.waitUntilSent();
    return studio.api.editedField(id, name);
  }

  /** The histogram follows a moving slider a few times a second. */
  let repaint = 0;
  function repaintLater(): void {
    if (repaint !== 0) return;
    repaint = window.setTimeout(() => {
      repaint = 0;
      paintLegend();
    }, 150);
  }

  studio.on('fieldEdited', () => {
    const { fieldEditor, shownField } = studio;
    if (!fieldEditor.values || fieldEditor.loaded !== shownField || colored !== `field-${shownField}`) return;
    if (!values) return;
    const hadClasses = classes !== null;
    classes = null;
    values = fieldEditor.values;
    shownLayers = layersOf(studio.doc, shownField!);
    const isFirst = unedited === null;
    unedited = fieldEditor.before;
    if (isFirst || hadClasses) {
      colorOptions.hidden = false;
      view.setScalar(values, [0, 1], map, unedited);
      paintLegend();
    } else {
      view.updateScalar(values);
      view.markMoving();
      repaintLater();
    }
  });
  // A field whose edit changed while the positions are edited, or whose band is not soloed any more.
  studio.on(['target', 'saving'], () => {
    const { shownField, target, saver, doc } = studio;
    if (shownField === null || target !== null || saver?.state !== 'saved') return;
    if (layersOf(doc, shownField) === shownLayers && !wasTarget) return;
    wasTarget = false;
    void color(colored);
  });
  let wasTarget = false;
  studio.on('target', () => {
    wasTarget ||= studio.target !== null;
  });

  const isListed = (name: string) =>
    [...colorSelect.options].some((option) => option.value === entryOf(name));

  /** Shape whose fields are listed. */
  let listedId = 0;
  function listColors(): void {
    const shape = studio.shape;
    if (!shape) return;
    // A series has one entry, that of its first frame.
    const counts = new Map<string, number>();
    const listed = shape.fields.filter(isServerField).filter((f) => {
      if (!f.series) return true;
      const n = counts.get(f.series.name) ?? 0;
      counts.set(f.series.name, n + 1);
      return n === 0;
    });
    const labelOf = (f: FieldName) =>
      f.series ? text.seriesOf(f.series.name, counts.get(f.series.name)!) : f.label;
    series = null;
    colorSelect.replaceChildren(
      h('option', { value: 'none' }, text.noColors),
      shape.graph?.placed ? '' : h('option', { value: 'change' }, text.change),
      studio.beside.other ? h('option', { value: DEVIATION }, text.deviation(studio.beside.other.name)) : '',
      h(
        'optgroup',
        { label: text.fields },
        ...listed.map((f) => h('option', { value: `field-${f.name}` }, labelOf(f))),
      ),
      h(
        'optgroup',
        { label: text.bandSizes },
        ...(shape.graph?.placed ? [] : shape.levels).map((l) =>
          h('option', { value: `band-${l.level}` }, text.band(l.level, formatNumber(l.sigma))),
        ),
      ),
    );
    const kept = isListed(colored);
    void color(kept && shape.id === listedId ? colored : 'none');
    listedId = shape.id;
  }
  studio.on(['levels', 'fields'], listColors);
  let besideId: number | null = null;
  studio.on('beside', () => {
    const id = studio.beside.other?.id ?? null;
    if (id !== besideId) listColors();
    besideId = id;
  });
  // Fields of the edited shape are fetched again after an edit.
  let later = 0;
  studio.on('moved', () => {
    const edited =
      colored === 'change' ||
      colored === DEVIATION ||
      studio.shape?.fields.some((f) => f.edited && colored === `field-${f.name}`);
    if (!edited || (colored !== 'change' && studio.saver?.state !== 'saved')) return;
    window.clearTimeout(later);
    later = window.setTimeout(() => void color(colored), 60);
  });

  return {
    controls: [h('label', { class: 'field' }, h('span', {}, text.colors), colorSelect), colorOptions],
    legend,
    frames: frames.element,
    get shown() {
      return colored;
    },
    show: (name) => {
      if (isListed(name)) void color(name);
    },
    toggleChange: () => {
      if (isListed('change')) void color(colored === 'change' ? 'none' : 'change');
    },
    valueAt: (v) => {
      if (!values) return '';
      const before =
        unedited && unedited[v] !== values[v] ? text.valueBefore(formatNumber(unedited[v]!)) : '';
      return `, ${title} ${formatNumber(values[v]!)}${unit ? ` ${unit}` : ''}${before}`;
    },
  };
}
