/** How the shape is looked at: style, colours, features, before and after. */

import { colourAt, type MapName, type RangeRule, rangeOf } from './colours';
import { check, h, iconButton, segments, select } from './dom';
import { count, short } from './lengths';
import type { Feature, FieldName } from './protocol';
import type { Stage } from './stage';
import type { Studio } from './studio';
import { text } from './text';
import type { Style } from './view';

/** σ of features, in radii of their balls. */
const BALL = 0.7;

/** Not the change and the bands, which the page knows by itself. */
function isOther(field: FieldName): boolean {
  return field.name !== 'change' && !/^band-\d+$/.test(field.name);
}

export interface Look {
  panel: HTMLElement;
  legend: HTMLElement;
  readouts: HTMLElement;
  divider: HTMLElement;
  style(next: Style): void;
  cycleStyle(): void;
  toggleChange(): void;
  toggleSplit(): void;
}

export function look(studio: Studio, stage: Stage): Look {
  const { view } = studio;
  let coloured = 'none';
  let values: Float32Array | null = null;
  let title = '';
  let unit = '';
  let diverging = false;
  let map: MapName = 'viridis';
  let rule: RangeRule = 'most';
  let features: Feature[] = [];

  // Style.
  const styles: Style[] = ['shaded', 'matcap', 'flat', 'edges'];
  const setStyle = (style: Style) => {
    view.style = style;
    styleButtons.set(style);
    if (style === 'edges' && !view.hasEdges && studio.shape && studio.shape.n_triangles > 0) {
      void studio.engine.call('edges', {}).then(({ pairs }) => view.setEdges(pairs));
    }
    view.request();
  };
  const styleButtons = segments<Style>(
    text.style,
    styles.map((s) => [s, text.styles[s]] as const),
    'shaded',
    setStyle,
  );
  studio.on('shape', () => setStyle(view.style));

  // Colours.
  const colourSelect = h('select', {
    'aria-label': text.colours,
    onchange: () => void colour(colourSelect.value),
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
      studio.say(text.badRange, 'error');
      return;
    }
    rule = { low: low.valueAsNumber, high: high.valueAsNumber };
    paintLegend();
  };
  const colourOptions = h(
    'div',
    { class: 'colour-options', hidden: true },
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
    const range = rangeOf(values, rule, diverging);
    view.setScalarRange(range, map);
    const context = bar.getContext('2d')!;
    for (let i = 0; i < 256; i++) {
      const [r, g, b] = colourAt(map, i / 255);
      context.fillStyle = `rgb(${r} ${g} ${b})`;
      context.fillRect(i, 0, 1, 1);
    }
    legendTitle.textContent = unit ? `${title} (${unit})` : title;
    numbers.replaceChildren(
      ...[0, 0.5, 1].map((t) => h('span', {}, short(range[0] + t * (range[1] - range[0])))),
    );
    if (document.activeElement !== low) low.value = range[0].toPrecision(4);
    if (document.activeElement !== high) high.value = range[1].toPrecision(4);
    legend.hidden = false;
  }

  let asked = 0;
  async function colour(name: string): Promise<void> {
    const mine = ++asked;
    const changed = name !== coloured;
    coloured = name;
    colourSelect.value = name;
    colourOptions.hidden = name === 'none';
    if (name === 'none') {
      values = null;
      view.setScalar(null);
      paintLegend();
      return;
    }
    try {
      if (name === 'change' || name.startsWith('band-')) {
        const level = name === 'change' ? 0 : Number(name.slice(5));
        if (name === 'change') await studio.settled();
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
      studio.say((error as Error).message, 'error');
      if (changed) void colour('none');
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

  function listColours(): void {
    const shape = studio.shape;
    if (!shape) return;
    colourSelect.replaceChildren(
      h('option', { value: 'none' }, text.noColours),
      h('option', { value: 'change' }, text.change),
      h(
        'optgroup',
        { label: text.fields },
        ...shape.fields.filter(isOther).map((f) => h('option', { value: `field-${f.name}` }, f.label)),
      ),
      h(
        'optgroup',
        { label: text.bandSizes },
        ...shape.levels.map((l) =>
          h('option', { value: `band-${l.level}` }, text.band(l.level, short(l.sigma))),
        ),
      ),
    );
    void colour('none');
  }
  studio.on('levels', listColours);
  // Fields of the edited shape follow it.
  let later = 0;
  studio.on('moved', () => {
    const edited =
      coloured === 'change' || studio.shape?.fields.some((f) => f.edited && coloured === `field-${f.name}`);
    if (!edited || (coloured !== 'change' && studio.saver?.state !== 'kept')) return;
    window.clearTimeout(later);
    later = window.setTimeout(() => void colour(coloured), 60);
  });

  // Features.
  const featureList = h('output', { class: 'feature', hidden: true });
  const setFeatures = (on: boolean) => {
    featureList.hidden = true;
    if (!on) {
      features = [];
      view.showFeatures([], 1);
      view.request();
      return;
    }
    const { id } = studio.shape!;
    studio.api.features(id).then(
      (list) => {
        // The answer takes a while: by now it may not be wanted, or the shape another one.
        if (!featureBox.querySelector('input')!.checked || studio.shape?.id !== id) return;
        features = list;
        view.showFeatures(list, BALL);
        studio.say(text.nFeatures(list.length));
      },
      (e: Error) => studio.say(e.message, 'error'),
    );
  };
  const featureBox = check(text.features, false, setFeatures);
  studio.on('shape', () => {
    features = [];
    featureBox.querySelector('input')!.checked = false;
    featureList.hidden = true;
  });
  stage.clicked = (answer, x, y) => {
    let best: Feature | null = null;
    let least = 18;
    for (const f of features) {
      const p = view.camera.project(f.position);
      const d = Math.hypot(p.x - x, p.y - y);
      if (d < least) {
        least = d;
        best = f;
      }
    }
    if (best) {
      featureList.textContent = text.feature(
        best.vertex,
        short(best.sigma),
        short(best.strength),
        best.level,
      );
      featureList.hidden = false;
      return;
    }
    featureList.hidden = true;
    if (!answer.hit) return;
    const v = answer.hit.vertex;
    const value = values ? `, ${title} ${short(values[v]!)}${unit ? ` ${unit}` : ''}` : '';
    featureList.textContent = `${text.vertex(v)}${value}`;
    featureList.hidden = false;
  };

  // Camera.
  const cameraRow = h(
    'div',
    { class: 'row' },
    ...text.views.map(([name, label]) =>
      h(
        'button',
        {
          type: 'button',
          onclick: () => {
            view.camera.look(name);
            view.camera.frame();
            view.touch();
          },
        },
        label,
      ),
    ),
    iconButton('frame', text.frame, () => {
      view.camera.frame();
      view.touch();
    }),
  );
  const turning = segments(
    text.turning,
    [
      ['turntable', text.turntable],
      ['trackball', text.trackball],
    ],
    'turntable',
    (t) => {
      view.camera.trackball = t === 'trackball';
      turning.set(t);
      if (t === 'turntable') view.camera.level();
      view.touch();
    },
  );
  const upright = segments<'y' | 'z'>(
    text.upright,
    [
      ['y', text.upY],
      ['z', text.upZ],
    ],
    'y',
    (up) => {
      view.camera.up = up;
      upright.set(up);
      view.camera.start();
      view.touch();
    },
  );

  // Before and after.
  const divider = h('div', {
    class: 'divider',
    hidden: true,
    role: 'slider',
    tabIndex: 0,
    'aria-label': text.split,
    'aria-valuemin': '0',
    'aria-valuemax': '100',
  });
  const labels = [h('span', {}, text.beforeShort), h('span', {}, text.afterShort)];
  divider.append(...labels);
  const place = (at: number) => {
    view.split = Math.min(0.98, Math.max(0.02, at));
    divider.style.left = `${100 * view.split}%`;
    divider.setAttribute('aria-valuenow', String(Math.round(100 * view.split)));
    view.touch();
  };
  divider.addEventListener('pointerdown', (e) => divider.setPointerCapture(e.pointerId));
  divider.addEventListener('pointermove', (e) => {
    if (!divider.hasPointerCapture(e.pointerId)) return;
    const r = view.canvas.getBoundingClientRect();
    place((e.clientX - r.left) / r.width);
  });
  divider.addEventListener('keydown', (e) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1 }[e.key];
    if (step === undefined) return;
    e.preventDefault();
    e.stopPropagation();
    place((view.split ?? 0.5) + step);
  });
  const toggleSplit = () => {
    if (view.split === null) place(0.5);
    else view.split = null;
    divider.hidden = view.split === null;
    view.request();
    studio.emit('before');
  };

  // Numbers that are always in sight.
  const readouts = h('dl', { class: 'readouts', 'aria-live': 'off' });
  function read(): void {
    const shape = studio.shape;
    if (!shape) return;
    const { moved } = studio;
    const pair = (name: string, value: string) => h('div', {}, h('dt', {}, name), h('dd', {}, value));
    const percent = (x: number) => ` (${short((100 * x) / shape.diagonal, 2)} %)`;
    const items = [pair(text.vertices, count(shape.n_vertices))];
    items.push(pair(text.greatest, moved ? short(moved.greatest) + percent(moved.greatest) : '0'));
    items.push(pair(text.rms, moved ? short(moved.rms) : '0'));
    const volume = moved?.volume ?? (shape.volume === null ? null : [shape.volume, shape.volume]);
    if (volume) {
      const [a, b] = volume as [number, number];
      const change = a === 0 ? 0 : (100 * (b - a)) / Math.abs(a);
      const sign = change > 0.005 ? '+' : '';
      items.push(
        pair(
          text.volume,
          `${short(a, 4)} → ${short(b, 4)} (${sign}${Math.abs(change) < 0.005 ? '0' : short(change, 2)} %)`,
        ),
      );
    }
    readouts.replaceChildren(...items);
  }
  studio.on(['shape', 'moved'], read);

  const panel = h(
    'section',
    { class: 'look-panel', id: 'look', 'aria-label': text.look },
    h('header', {}, h('h2', {}, text.look)),
    styleButtons,
    h('label', { class: 'field' }, h('span', {}, text.colours), colourSelect),
    colourOptions,
    featureBox,
    featureList,
    cameraRow,
    h('details', {}, h('summary', {}, text.camera), h('div', { class: 'stack' }, turning, upright)),
  );
  return {
    panel,
    legend,
    readouts,
    divider,
    style: setStyle,
    cycleStyle: () => setStyle(styles[(styles.indexOf(view.style) + 1) % styles.length]!),
    toggleChange: () => void colour(coloured === 'change' ? 'none' : 'change'),
    toggleSplit,
  };
}
