/** Coloring by a scalar field, with a legend in its units. */

import { colorAt, type MapName, movedOnly, type RangeRule, rangeOf } from './colors';
import { h, select } from './dom';
import { formatNumber } from './lengths';
import type { FieldName } from './protocol';
import type { Studio } from './studio';
import { text } from './text';

/** True for fields of the server; the page computes displacement and band sizes itself. */
function isServerField(field: FieldName): boolean {
  return field.name !== 'change' && !/^band-\d+$/.test(field.name);
}

export interface Coloring {
  controls: HTMLElement[];
  legend: HTMLElement;
  toggleChange(): void;
  /** Text with the value at a vertex; empty without coloring. */
  valueAt(v: number): string;
}

export function coloring(studio: Studio): Coloring {
  const { view } = studio;
  let colored = 'none';
  let values: Float32Array | null = null;
  let title = '';
  let unit = '';
  let diverging = false;
  let map: MapName = 'viridis';
  let rule: RangeRule = 'most';

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
  const byHand = () => {
    if (!Number.isFinite(low.valueAsNumber) || !Number.isFinite(high.valueAsNumber)) return;
    if (low.valueAsNumber >= high.valueAsNumber) {
      studio.showMessage(text.badRange, 'error');
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
  const numbers = h('div', { class: 'legend-numbers' });
  const legend = h(
    'figure',
    { class: 'legend', hidden: true },
    h('figcaption', {}, legendTitle),
    bar,
    numbers,
  );

  function paintLegend(): void {
    if (!values) {
      legend.hidden = true;
      return;
    }
    const range = rangeOf(colored === 'change' ? movedOnly(values) : values, rule, diverging);
    view.setScalarRange(range, map);
    const context = bar.getContext('2d')!;
    for (let i = 0; i < 256; i++) {
      const [r, g, b] = colorAt(map, i / 255);
      context.fillStyle = `rgb(${r} ${g} ${b})`;
      context.fillRect(i, 0, 1, 1);
    }
    legendTitle.textContent = unit ? `${title} (${unit})` : title;
    numbers.replaceChildren(
      ...[0, 0.5, 1].map((t) => h('span', {}, formatNumber(range[0] + t * (range[1] - range[0])))),
    );
    if (document.activeElement !== low) low.value = range[0].toPrecision(4);
    if (document.activeElement !== high) high.value = range[1].toPrecision(4);
    legend.hidden = false;
  }

  let asked = 0;
  async function color(name: string): Promise<void> {
    const mine = ++asked;
    const changed = name !== colored;
    colored = name;
    colorSelect.value = name;
    colorOptions.hidden = name === 'none';
    if (name === 'none') {
      values = null;
      view.setScalar(null);
      paintLegend();
      return;
    }
    try {
      if (name === 'change' || name.startsWith('band-')) {
        const level = name === 'change' ? 0 : Number(name.slice(5));
        if (name === 'change') await studio.display.waitUntilSettled();
        const answer = await studio.engine.call('scalar', level ? { band: level } : 'change');
        if (mine !== asked) return;
        values = answer.values;
        title = level ? text.bandSize(level) : text.change;
        unit = '';
        diverging = false;
      } else {
        const answer = await studio.api.field(studio.shape!.id, name.slice(6));
        if (mine !== asked) return;
        values = answer.values;
        title = answer.info.label;
        unit = answer.info.unit;
        diverging = answer.info.diverging;
      }
    } catch (error) {
      if (mine !== asked) return;
      studio.showMessage((error as Error).message, 'error');
      if (changed) void color('none');
      return;
    }
    if (changed) {
      rule = 'most';
      map = diverging ? 'diverging' : 'viridis';
      mapSelect.querySelector('select')!.value = map;
      ruleSelect.querySelector('select')!.value = 'most';
    }
    view.setScalar(values, [0, 1], map);
    paintLegend();
  }

  /** Shape whose fields are listed. */
  let listedId = 0;
  function listColors(): void {
    const shape = studio.shape;
    if (!shape) return;
    colorSelect.replaceChildren(
      h('option', { value: 'none' }, text.noColors),
      h('option', { value: 'change' }, text.change),
      h(
        'optgroup',
        { label: text.fields },
        ...shape.fields.filter(isServerField).map((f) => h('option', { value: `field-${f.name}` }, f.label)),
      ),
      h(
        'optgroup',
        { label: text.bandSizes },
        ...shape.levels.map((l) =>
          h('option', { value: `band-${l.level}` }, text.band(l.level, formatNumber(l.sigma))),
        ),
      ),
    );
    const kept = [...colorSelect.options].some((option) => option.value === colored);
    void color(kept && shape.id === listedId ? colored : 'none');
    listedId = shape.id;
  }
  studio.on('levels', listColors);
  // Fields of the edited shape are fetched again after an edit.
  let later = 0;
  studio.on('moved', () => {
    const edited =
      colored === 'change' || studio.shape?.fields.some((f) => f.edited && colored === `field-${f.name}`);
    if (!edited || (colored !== 'change' && studio.saver?.state !== 'saved')) return;
    window.clearTimeout(later);
    later = window.setTimeout(() => void color(colored), 60);
  });

  return {
    controls: [h('label', { class: 'field' }, h('span', {}, text.colors), colorSelect), colorOptions],
    legend,
    toggleChange: () => void color(colored === 'change' ? 'none' : 'change'),
    valueAt: (v) => (values ? `, ${title} ${formatNumber(values[v]!)}${unit ? ` ${unit}` : ''}` : ''),
  };
}
