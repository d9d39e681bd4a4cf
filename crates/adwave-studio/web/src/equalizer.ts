/** Equalizer: one vertical native slider per band with its width, gain, solo and mute. */

import { h, segments } from './dom';
import { GREATEST_TYPED, gainOf, gainText, positionOf, SLIDER_MAX } from './gain';
import { gainSummary } from './gain-summary';
import { unitOf } from './grid/grid-panel';
import { formatNumber } from './lengths';
import { openLevels } from './levels-dialog';
import type { Level } from './protocol';
import { type Doc, fitGains } from './state';
import type { Studio } from './studio';
import { text } from './text';

/** Largest number of bands with their buttons side by side. */
const MOST_WIDE = 16;
/** Pixels between two widths side by side. */
const LABEL_GAP = 4;

interface BandColumn {
  root: HTMLElement;
  input: HTMLInputElement;
  number: HTMLInputElement;
  meter: HTMLElement;
  sigma: HTMLElement;
  solo: HTMLButtonElement;
  mute: HTMLButtonElement;
}

/** Sets the gain of a band in the selected layer, as one step or as part of a gesture. */
function setGain(studio: Studio, level: number, gain: number, step: boolean): void {
  studio.timings.startSliderTiming();
  // The colors of a field move once they are computed.
  if (studio.target === null) studio.markMoving();
  const doc = studio.withGain(level, gain);
  if (step) {
    studio.history.preview(doc);
    studio.history.end();
  } else studio.history.preview(doc);
}

/** Mutes a band: gain 0, and its gain before when it is heard again. Solo is part of the view. */
class Mute {
  private readonly gainsBefore = new Map<string, number>();

  constructor(private readonly studio: Studio) {}

  toggle(level: number): void {
    const { studio, gainsBefore } = this;
    const { gains, key } = studio.layer;
    const name = `${key}.${level}`;
    const gain = gains[level - 1]!;
    if (gain !== 0) gainsBefore.set(name, gain);
    const next = gain === 0 ? gainsBefore.get(name) || 1 : 0;
    studio.changeLayer({ gains: gains.with(level - 1, next) }, true);
  }
}

/** Creates the controls of one band; `refresh` shows the gains again after invalid input. */
function bandColumn(studio: Studio, mute: Mute, { level, sigma }: Level, refresh: () => void): BandColumn {
  const size = formatNumber(sigma);
  const name = text.band(level, size);
  const input = h('input', {
    type: 'range',
    class: 'gain',
    min: '0',
    max: String(SLIDER_MAX),
    step: '1',
    'aria-label': name,
    'aria-orientation': 'vertical',
    'aria-keyshortcuts': 's m',
    title: text.sliderHint,
    disabled: true,
    oninput: () => setGain(studio, level, gainOf(input.valueAsNumber), false),
    onchange: () => studio.history.end(),
    // A drag that ends where it began changes nothing, and the browser tells no change.
    onpointerup: () => studio.history.end(),
    ondblclick: () => setGain(studio, level, 1, true),
    // On a focused slider these letters are its buttons, which are no tab stops.
    onkeydown: (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const key = event.key.toLowerCase();
      if (key === 's') studio.setSolo(level);
      else if (key === 'm') mute.toggle(level);
      else return;
      event.preventDefault();
      event.stopPropagation();
    },
  });
  const number = h('input', {
    class: 'number',
    type: 'text',
    inputMode: 'decimal',
    'aria-label': text.gainOf(name),
    disabled: true,
    onchange: () => {
      const gain = Number(number.value.replace(',', '.'));
      if (number.value.trim() !== '' && gain >= 0 && gain <= GREATEST_TYPED)
        setGain(studio, level, gain, true);
      else studio.showMessage(text.badGain(GREATEST_TYPED), 'error');
      refresh();
      // The gain that holds is shown although the field has the focus.
      number.value = gainText(studio.layer.gains[level - 1] ?? 1);
    },
  });
  const meter = h('i', { class: 'meter' });
  const soloButton = h(
    'button',
    {
      type: 'button',
      'aria-label': text.solo(name),
      title: text.solo(name),
      'aria-pressed': 'false',
      tabIndex: -1,
      onclick: () => studio.setSolo(level),
    },
    'S',
  );
  const muteButton = h(
    'button',
    {
      type: 'button',
      'aria-label': text.mute(name),
      title: text.mute(name),
      'aria-pressed': 'false',
      tabIndex: -1,
      onclick: () => mute.toggle(level),
    },
    'M',
  );
  const sigmaLabel = h('span', { class: 'sigma', title: text.sigma(size) }, size);
  const root = h(
    'div',
    { class: 'band', 'data-level': String(level) },
    number,
    h('div', { class: 'track' }, h('div', { class: 'rail' }, meter, h('i', { class: 'fill' })), input),
    h('div', { class: 'sm' }, soloButton, muteButton),
    sigmaLabel,
  );
  return { root, input, number, meter, sigma: sigmaLabel, solo: soloButton, mute: muteButton };
}

/** Lets the pointer draw a gain curve over the bands while `isDrawing` is true. */
function enableCurveDrawing(
  studio: Studio,
  bands: HTMLElement,
  columns: () => readonly BandColumn[],
  isDrawing: () => boolean,
): void {
  // Drawing a curve: every column under the pointer takes the height of the pointer.
  let last: { level: number; position: number } | null = null;
  const drawAt = (event: PointerEvent) => {
    const hit = columns().findIndex((c) => {
      const r = c.root.getBoundingClientRect();
      return event.clientX >= r.left && event.clientX < r.right;
    });
    if (hit < 0 || !studio.isBandReady(hit + 1)) return;
    const track = columns()[hit]!.input.getBoundingClientRect();
    const position = Math.round(
      SLIDER_MAX * Math.min(1, Math.max(0, (track.bottom - 8 - event.clientY) / (track.height - 16))),
    );
    // Positions near the middle snap to gain 1.
    const at = Math.abs(position - 100) < 4 ? 100 : position;
    const from = last ?? { level: hit + 1, position: at };
    let doc: Doc | undefined;
    const n = Math.abs(hit + 1 - from.level);
    for (let k = 0; k <= n; k++) {
      const level = from.level + (n ? k * Math.sign(hit + 1 - from.level) : 0);
      const p = n ? from.position + ((at - from.position) * k) / n : at;
      if (studio.isBandReady(level)) doc = studio.withGain(level, gainOf(Math.round(p)), doc);
    }
    last = { level: hit + 1, position: at };
    if (!doc) return;
    studio.timings.startSliderTiming();
    if (studio.target === null) studio.markMoving();
    studio.history.preview(doc);
  };
  bands.addEventListener('pointerdown', (event) => {
    if (!isDrawing() || (event.target as Element).closest('button, .number')) return;
    event.preventDefault();
    bands.setPointerCapture(event.pointerId);
    last = null;
    drawAt(event);
  });
  bands.addEventListener('pointermove', (event) => {
    if (bands.hasPointerCapture(event.pointerId)) drawAt(event);
  });
  for (const end of ['pointerup', 'pointercancel'] as const) {
    bands.addEventListener(end, (event) => {
      if (!bands.hasPointerCapture(event.pointerId)) return;
      bands.releasePointerCapture(event.pointerId);
      studio.history.end();
    });
  }
}

/** Shows |W_j| under the cursor as bars, relative to the largest. */
function showSpectrum(columns: readonly BandColumn[], spectrum: readonly number[]): void {
  const most = Math.max(...spectrum, 0);
  for (const [j, c] of columns.entries()) {
    const x = spectrum[j] ?? 0;
    c.meter.style.height = most > 0 ? `${(100 * x) / most}%` : '0';
    c.root.title = x > 0 ? text.detailHere(formatNumber(x)) : '';
  }
}

/** Shows the gains of a layer in the columns, and the band that is shown alone. */
function showGains(columns: readonly BandColumn[], gains: readonly number[], solo: number | null): void {
  for (const [j, c] of columns.entries()) {
    const gain = gains[j] ?? 1;
    const position = String(positionOf(gain));
    if (c.input.value !== position && gainOf(c.input.valueAsNumber) !== gain) c.input.value = position;
    c.input.setAttribute('aria-valuetext', text.times(gainText(gain)));
    c.root.style.setProperty('--at', String(Number(position) / SLIDER_MAX));
    if (document.activeElement !== c.number) c.number.value = gainText(gain);
    c.root.classList.toggle('changed', gain !== 1);
    c.root.classList.toggle('unheard', solo !== null && solo !== j + 1);
    c.mute.setAttribute('aria-pressed', String(gain === 0));
    c.solo.setAttribute('aria-pressed', String(solo === j + 1));
  }
}

/** Creates the choice between the positions and the field that colors the shape. */
function targetChoice(studio: Studio): HTMLElement {
  const choice = segments<'positions' | 'field'>(
    text.target,
    [
      ['positions', text.positions],
      ['field', text.fieldTarget],
    ],
    'positions',
    (which) => {
      if (which === 'positions') void studio.setTarget(null);
      else if (studio.shownField !== null) void studio.setTarget(studio.shownField);
      else studio.showFirstField();
    },
  );
  choice.classList.add('target');
  const positions = choice.querySelector<HTMLButtonElement>('button:first-child')!;
  const field = choice.querySelector<HTMLButtonElement>('button:last-child')!;
  const show = () => {
    const { target, shownField, shape } = studio;
    choice.hidden = !shape?.fields.some((f) => f.editable);
    // A graph without positions has fields alone.
    positions.hidden = shape?.graph?.placed === true;
    choice.set(target === null ? 'positions' : 'field');
    field.textContent = target ?? shownField ?? text.fieldTarget;
    field.title = text.fieldTargetHint;
  };
  studio.on(['shape', 'levels', 'fields', 'target'], show);
  show();
  return choice;
}

export function equalizer(studio: Studio): HTMLElement {
  let columns: BandColumn[] = [];
  let drawing = false;
  const mute = new Mute(studio);
  const bands = h('div', { class: 'bands', role: 'group', 'aria-label': text.equalizer });
  const presets = h('select', { 'aria-label': text.presets });
  const drawButton = h(
    'button',
    { type: 'button', 'aria-pressed': 'false', title: text.drawHint },
    text.draw,
  );
  const whose = h('span', { class: 'whose' });
  const axis = h('span', {}, text.axis);
  studio.on('shape', () => {
    const grid = studio.shape?.grid;
    const isPlaced = studio.shape?.graph?.placed;
    axis.textContent = grid ? text.gridAxis(unitOf(grid)) : isPlaced ? text.graphAxis : text.axis;
  });
  drawButton.addEventListener('click', () => {
    drawing = !drawing;
    drawButton.setAttribute('aria-pressed', String(drawing));
    bands.classList.toggle('drawing', drawing);
  });
  presets.addEventListener('change', () => {
    const preset = studio.shape?.presets[Number(presets.value)];
    showPreset();
    if (!preset) return;
    studio.changeLayer({ gains: fitGains(preset.gains, studio.nLevels), preset: preset.name }, true);
    const notes = studio.isGrid ? text.gridPresetNotes : text.presetNotes;
    const note = notes[preset.name];
    if (note) studio.showMessage(note);
  });

  /** Shows the preset of the selected layer, and how many bands have changed since. */
  function showPreset(): void {
    presets.value = '';
    const named = gainSummary(studio.layer, studio.shape?.presets ?? [], 'presets');
    presets.options[0]!.textContent = named || text.presets;
    presets.classList.toggle('named', named !== '');
  }

  function rebuild(): void {
    const levels = studio.shape?.levels ?? [];
    columns = levels.map((l) => bandColumn(studio, mute, l, refresh));
    bands.replaceChildren(...columns.map((c) => c.root));
    bands.classList.toggle('many', columns.length > MOST_WIDE);
    bands.style.setProperty('--columns', String(columns.length));
    spaceLabels();
    presets.replaceChildren(
      h('option', { value: '' }, text.presets),
      ...(studio.shape?.presets ?? []).map((p, i) =>
        h('option', { value: String(i) }, text.presetNames[p.name] ?? p.name),
      ),
    );
    enable();
    refresh();
  }

  /** Shows every second or third width if all would overlap, the others when their band is pointed at. */
  function spaceLabels(): void {
    const room = columns[0]?.root.offsetWidth;
    if (!room) return;
    const step = Math.ceil((Math.max(...columns.map((c) => c.sigma.offsetWidth)) + LABEL_GAP) / room);
    for (const [j, c] of columns.entries())
      c.root.classList.toggle('unlabeled', (columns.length - 1 - j) % step !== 0);
  }

  function enable(): void {
    for (const [j, c] of columns.entries()) {
      const there = studio.isBandReady(j + 1);
      c.input.disabled = !there;
      c.number.disabled = !there;
      c.root.classList.toggle('waiting', !there);
    }
  }

  function refresh(): void {
    if (presets.options.length > 0) showPreset();
    const { solo } = studio;
    showGains(columns, studio.layer.gains, solo?.key === studio.selected ? solo.level : null);
    const { layer, layers } = studio;
    const index = layers.findIndex((l) => l.key === layer.key);
    whose.textContent = layers.length > 1 ? layer.name || text.layerName(index + 1) : '';
  }

  enableCurveDrawing(
    studio,
    bands,
    () => columns,
    () => drawing,
  );
  new ResizeObserver(spaceLabels).observe(bands);
  studio.on('levels', rebuild);
  studio.on('band', enable);
  studio.on(['doc', 'selected', 'solo', 'target'], refresh);
  studio.on('spectrum', () => showSpectrum(columns, studio.spectrum));

  return h(
    'section',
    { class: 'equalizer', id: 'equalizer', 'aria-label': text.equalizer },
    h(
      'header',
      {},
      h('h2', {}, text.equalizer),
      targetChoice(studio),
      whose,
      h('span', { class: 'space' }),
      drawButton,
      presets,
      h(
        'button',
        {
          type: 'button',
          onclick: () => studio.changeLayer({ gains: fitGains([], studio.nLevels), preset: undefined }, true),
        },
        text.reset,
      ),
      h('button', { type: 'button', onclick: () => openLevels(studio) }, text.levels),
    ),
    h(
      'div',
      { class: 'desk' },
      h(
        'div',
        { class: 'scale', 'aria-hidden': 'true' },
        ...['4', '2', '1', '½', '0'].map((t) => h('span', {}, t)),
      ),
      bands,
    ),
    h(
      'footer',
      {},
      h('span', {}, text.fine),
      h('span', { class: 'axis' }, axis, h('span', { class: 'meter-legend' }, text.meters)),
      h('span', {}, text.coarse),
    ),
  );
}
