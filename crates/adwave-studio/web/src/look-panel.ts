/** View panel: style, colors, features, camera, and the wipe between before and after. */

import { type Clip, parseClip } from './clip';
import { coloring } from './coloring';
import { check, h, iconButton, segments, slider } from './dom';
import { facesControls, turnPartButton } from './faces-panel';
import { formatCount, formatNumber } from './lengths';
import type { Feature, Shape } from './protocol';
import type { Stage } from './stage';
import type { Studio } from './studio';
import { text } from './text';
import { stillInward } from './turned-parts';
import type { Style } from './view';
import { recallView, type ViewMemory } from './view-memory';

/** Radius of the ball of a feature, in σ. */
const BALL = 0.7;
/** Number of features that are shown at first. */
const FEW_FEATURES = 200;

export interface LookPanel {
  panel: HTMLElement;
  legend: HTMLElement;
  frames: HTMLElement;
  /** Facts about a clicked place. */
  card: HTMLElement;
  readouts: HTMLElement;
  divider: HTMLElement;
  style(next: Style): void;
  cycleStyle(): void;
  toggleClip(): void;
  toggleChange(): void;
  toggleSplit(): void;
}

/** Creates the choice of shading. */
function styleControl(studio: Studio) {
  const { view } = studio;
  const points = slider(
    text.pointSize,
    { min: 25, max: 400, step: 25, value: 100 },
    (v) => `${v} %`,
    (v) => {
      view.pointScale = v / 100;
      view.markMoving();
    },
  );
  const isGraph = () => Boolean(studio.shape?.graph);
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
  studio.on('shape', () => {
    const cloud = studio.shape!.n_triangles === 0;
    points.hidden = !cloud;
    // A graph has nodes of one color, and its edges are always shown; a cloud has none.
    styleButtons.hidden = isGraph();
    styleButtons.querySelector<HTMLElement>('button:last-child')!.hidden = cloud;
    setStyle(cloud && view.style === 'edges' ? 'shaded' : view.style);
  });

  const cycle = () => {
    if (isGraph()) return;
    const offered = styles.filter((s) => s !== 'edges' || studio.shape?.n_triangles !== 0);
    setStyle(offered[(offered.indexOf(view.style) + 1) % offered.length]!);
  };
  return { controls: [styleButtons, facesControls(studio), points], setStyle, cycle };
}

/** Creates the switch for features, and the card over the picture about a clicked feature or vertex. */
function featureControls(
  studio: Studio,
  stage: Stage,
  valueAt: (v: number) => string,
): { controls: HTMLElement[]; card: HTMLElement } {
  const { view } = studio;
  /** All features of the shape, and those that are shown. */
  let found: Feature[] = [];
  let features: Feature[] = [];
  /** Place of the last click, from which the next one is measured. */
  let lastPlace: number[] | null = null;
  const facts = h('output', {});
  const action = h('div', {});
  const card = h(
    'div',
    { class: 'card', hidden: true },
    h('div', {}, facts, action),
    iconButton('close', text.closeCard, () => closeCard()),
  );
  const closeCard = () => {
    card.hidden = true;
    view.showMark(null);
  };
  const showCard = (
    lines: readonly HTMLElement[],
    place: readonly number[] | null,
    button: HTMLElement | null = null,
  ) => {
    facts.replaceChildren(...lines);
    action.replaceChildren(...(button ? [button] : []));
    card.hidden = false;
    view.showMark(place);
  };
  // What it says about a place is no longer true.
  studio.on(['moved', 'fieldEdited'], closeCard);
  const setFeatures = (on: boolean) => {
    closeCard();
    if (!on) {
      found = [];
      features = [];
      threshold.hidden = true;
      view.showFeatures([], 1);
      view.request();
      return;
    }
    const { id } = studio.shape!;
    studio.api.features(id).then(
      (list) => {
        // The request takes a while; meanwhile features may have been turned off or another shape opened.
        if (!featureBox.querySelector('input')!.checked || studio.shape?.id !== id) return;
        found = list;
        // Many balls hide the shape.
        share = Math.max(1, Math.min(100, Math.round((100 * FEW_FEATURES) / Math.max(1, list.length))));
        showStrongest();
        threshold.set(share);
        threshold.hidden = list.length === 0;
        studio.showMessage(text.nFeatures(list.length));
      },
      (e: Error) => studio.showMessage(e.message, 'error'),
    );
  };
  const featureBox = check(text.features, false, setFeatures);
  /** Share of the features that are shown, the strongest first, in percent. */
  let share = 100;
  const showStrongest = () => {
    const strongest = [...found].sort((a, b) => b.strength - a.strength);
    features = strongest.slice(0, Math.ceil((share / 100) * strongest.length));
    view.showFeatures(features, BALL);
    view.request();
  };
  const threshold = slider(
    text.strongest,
    { min: 1, max: 100, step: 1, value: share },
    (v) => text.shownOf(Math.ceil((v / 100) * found.length), found.length),
    (v) => {
      share = v;
      showStrongest();
    },
  );
  threshold.hidden = true;
  studio.on('shape', () => {
    found = [];
    features = [];
    lastPlace = null;
    threshold.hidden = true;
    featureBox.querySelector('input')!.checked = false;
    featureBox.hidden = studio.shape!.graph?.placed === true;
    closeCard();
  });
  stage.onClick = (answer, x, y) => {
    let best: Feature | null = null;
    let least = 18;
    for (const f of features) {
      if (view.hides(f.position)) continue;
      const p = view.camera.project(f.position);
      const d = Math.hypot(p.x - x, p.y - y);
      if (d < least) {
        least = d;
        best = f;
      }
    }
    if (best) {
      const { vertex, sigma, strength, level } = best;
      showCard(
        [
          h('div', {}, text.feature(vertex, formatNumber(sigma), formatNumber(strength), level)),
          h(
            'button',
            {
              type: 'button',
              onclick: () =>
                studio.addLayer(text.layerName(studio.layers.length + 1), {
                  ball: { center: { vertex }, radius: sigma },
                }),
            },
            text.layerHere,
          ),
        ],
        null,
      );
      return;
    }
    if (!answer.hit) {
      closeCard();
      return;
    }
    const { vertex: v, point } = answer.hit;
    const { center } = studio.shape!;
    const place = point.map((x, c) => x + center[c]!);
    const distance = lastPlace && Math.hypot(...place.map((x, c) => x - lastPlace![c]!));
    lastPlace = place;
    const isPlaced = studio.shape!.graph?.placed === true;
    const lines = [
      `${text.vertex(v)}${valueAt(v)}`,
      isPlaced ? '' : text.place(place.map((x) => formatNumber(x, 4)).join(', ')),
      distance === null || isPlaced ? '' : text.distance(formatNumber(distance, 4)),
    ];
    const shown = lines.filter((line) => line !== '').map((line) => h('div', {}, line));
    showCard(shown, point, studio.shape!.n_triangles > 0 ? turnPartButton(studio, v) : null);
    if (studio.shape!.graph?.named) {
      studio.api.name(studio.shape!.id, v).then(
        (name) => shown[0]!.prepend(h('b', {}, name), ' · '),
        (e: Error) => studio.showMessage(e.message, 'error'),
      );
    }
  };
  return { controls: [featureBox, threshold], card };
}

/** Creates the buttons for standard views, and the settings of the camera. */
function cameraControls(studio: Studio): HTMLElement[] {
  const { view } = studio;
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
            view.markMoving();
          },
        },
        label,
      ),
    ),
    iconButton('frame', text.frame, () => {
      view.camera.frame();
      view.markMoving();
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
      view.markMoving();
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
      view.markMoving();
    },
  );
  const settings = h(
    'details',
    {},
    h('summary', {}, text.camera),
    h('div', { class: 'stack' }, turning, upright),
  );
  studio.on(['shape', 'camera'], () => {
    upright.set(view.camera.up);
    turning.set(view.camera.trackball ? 'trackball' : 'turntable');
    // A flat graph is seen from above alone.
    for (const button of [...cameraRow.children].slice(0, -1))
      (button as HTMLElement).hidden = view.camera.isFlat;
    settings.hidden = view.camera.isFlat;
  });
  return [cameraRow, settings];
}

/** Creates the settings of the plane that cuts the shape. */
function clipControls(studio: Studio) {
  const { view } = studio;
  /** The last plane, which comes back when it is turned on again. */
  let last: Clip = { axis: 0, at: 0.5, flipped: false };
  const set = (clip: Clip | null) => {
    if (clip) last = clip;
    view.setClip(clip);
    view.markMoving();
    show();
  };
  const axis = segments<'off' | 'x' | 'y' | 'z'>(
    text.clip,
    [
      ['off', text.clipOff],
      ['x', 'x'],
      ['y', 'y'],
      ['z', 'z'],
    ],
    'off',
    (which) => set(which === 'off' ? null : { ...last, axis: 'xyz'.indexOf(which) as Clip['axis'] }),
  );
  const at = slider(
    text.clipAt,
    { min: 0, max: 100, step: 0.5, value: 50 },
    (v) =>
      studio.shape
        ? formatNumber(view.clipPlace({ ...last, at: v / 100 }) + studio.shape.center[last.axis]!)
        : '',
    (v) => set({ ...last, at: v / 100 }),
  );
  const flip = check(text.clipFlip, false, (flipped) => set({ ...last, flipped }));
  const show = () => {
    const { clip } = view;
    axis.set(clip ? (['x', 'y', 'z'] as const)[clip.axis] : 'off');
    at.hidden = clip === null;
    flip.hidden = clip === null;
    at.set(100 * last.at);
    flip.querySelector('input')!.checked = last.flipped;
  };
  studio.on('shape', show);
  show();
  const row = h('div', { class: 'field' }, h('span', {}, text.clip), axis);
  return { controls: [row, at, flip], set, toggle: () => set(view.clip ? null : last) };
}

/** Creates the divider of the wipe between before and after. */
function wipe(studio: Studio): { divider: HTMLElement; toggleSplit: () => void } {
  const { view } = studio;
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
    divider.style.left = `${100 * view.split * (view.halves === 'beside' ? 0.5 : 1)}%`;
    divider.setAttribute('aria-valuenow', String(Math.round(100 * view.split)));
    view.markMoving();
  };
  divider.addEventListener('pointerdown', (e) => divider.setPointerCapture(e.pointerId));
  divider.addEventListener('pointermove', (e) => {
    if (!divider.hasPointerCapture(e.pointerId)) return;
    const r = view.canvas.getBoundingClientRect();
    place((e.clientX - r.left) / (r.width * (view.halves === 'beside' ? 0.5 : 1)));
  });
  divider.addEventListener('keydown', (e) => {
    const step = { ArrowLeft: -0.02, ArrowRight: 0.02, PageDown: -0.1, PageUp: 0.1 }[e.key];
    if (step === undefined) return;
    e.preventDefault();
    e.stopPropagation();
    place((view.split ?? 0.5) + step);
  });
  const replace = () => {
    if (view.split !== null) place(view.split);
  };
  studio.on('beside', replace);
  window.addEventListener('resize', replace);
  studio.on('compared', () => {
    const { comparison } = studio;
    labels[0]!.textContent = comparison ? text.compareShort[comparison.method] : text.beforeShort;
    labels[1]!.textContent = comparison ? text.thisEdit : text.afterShort;
    studio.updateTint();
    if (comparison && view.split === null) toggleSplit();
  });
  const toggleSplit = () => {
    if (view.split === null) place(0.5);
    else view.split = null;
    divider.hidden = view.split === null;
    view.request();
    studio.emit('before');
  };
  return { divider, toggleSplit };
}

/** Creates the readouts that are always visible. */
function createReadouts(studio: Studio): HTMLElement {
  const readouts = h('dl', { class: 'readouts', 'aria-live': 'off' });
  function read(): void {
    const shape = studio.shape;
    if (!shape) return;
    const { displacement: moved } = studio;
    const pair = (name: string, value: string) => h('div', {}, h('dt', {}, name), h('dd', {}, value));
    const percent = (x: number) => ` (${formatNumber((100 * x) / shape.diagonal, 2)} %)`;
    const { graph } = shape;
    const counted = graph ? text.nodes : shape.kind === 'cloud' ? text.points : text.vertices;
    const items = [pair(counted, formatCount(shape.n_vertices))];
    if (graph) items.push(pair(text.graphEdges, formatCount(graph.n_edges)));
    if (studio.target !== null) {
      const { change } = studio.fieldEditor;
      items.push(pair(text.fieldGreatest, change ? formatNumber(change.greatest) : '–'));
      items.push(pair(text.fieldRms, change ? formatNumber(change.rms) : '–'));
      readouts.replaceChildren(...items);
      return;
    }
    if (graph?.placed) {
      readouts.replaceChildren(...items);
      return;
    }
    items.push(pair(text.greatest, moved ? formatNumber(moved.greatest) + percent(moved.greatest) : '0'));
    items.push(pair(text.rms, moved ? formatNumber(moved.rms) : '0'));
    const { volume: before } = studio.turnedParts;
    const volume = moved ? moved.volume : before === null ? null : [before, before];
    if (volume) {
      const [a, b] = volume as [number, number];
      const change = a === 0 ? 0 : (100 * (b - a)) / Math.abs(a);
      const sign = change > 0.005 ? '+' : '';
      items.push(
        pair(
          stillInward(shape, studio.doc.turned).length > 0 ? text.volumeInward : text.volume,
          `${formatNumber(a, 4)} → ${formatNumber(b, 4)} (${sign}${Math.abs(change) < 0.005 ? '0' : formatNumber(change, 2)} %)`,
        ),
      );
    }
    readouts.replaceChildren(...items);
  }
  studio.on(['shape', 'moved', 'target', 'fieldEdited', 'turned'], read);
  return readouts;
}

/** Fields of scanners by which a cloud without colors is colored at first. */
const OF_SCANNERS = ['classification', 'intensity', 'reflectance', 'scalar_Intensity'];

/** Field that is edited when a graph is opened for the first time; `null` for the positions of another shape. */
function editedFirst(shape: Shape | null): string | null {
  if (shape?.kind !== 'graph') return null;
  return shape.fields.find((f) => f.editable)?.name ?? null;
}

/** Entry of the list of colors for a shape that is opened for the first time: the file's own, if it has any. */
export function ownColors(shape: Shape | null): string | null {
  if (!shape) return null;
  if (shape.kind === 'graph') return `field-${editedFirst(shape)}`;
  const rgb = shape.fields.find((f) => f.rgb);
  const names = rgb ? [rgb.name] : shape.kind === 'cloud' ? OF_SCANNERS : [];
  const own = names.find((name) => shape.fields.some((f) => f.name === name));
  return own === undefined ? null : `field-${own}`;
}

export function lookPanel(studio: Studio, stage: Stage): LookPanel {
  const style = styleControl(studio);
  const colors = coloring(studio);
  const features = featureControls(studio, stage, colors.valueAt);
  const clip = clipControls(studio);
  let recalled: string | null = null;
  let recalledTarget: string | null = null;
  const showLook = (memory: ViewMemory | null) => {
    if (memory && memory.style in text.styles) style.setStyle(memory.style as Style);
    clip.set(parseClip(memory?.clip));
    recalled = memory?.colors ?? ownColors(studio.shape);
    recalledTarget = memory ? (memory.target ?? null) : editedFirst(studio.shape);
  };
  studio.shownView = {
    get: () => {
      const { camera, style } = studio.view;
      return {
        camera: camera.state,
        style,
        colors: colors.shown,
        target: studio.target,
        clip: studio.view.clip,
      };
    },
    set: (memory) => {
      studio.view.camera.restore(memory.camera);
      studio.view.markMoving();
      showLook(memory);
      recallColors();
      studio.emit('camera');
    },
  };
  studio.on('shape', () => showLook(recallView(studio.shape!)));
  const recallColors = () => {
    if (recalled === null) return;
    // Displacements, sizes of bands and what is computed from the edited shape need all bands.
    const isEdited = studio.shape?.fields.find((f) => recalled === `field-${f.name}`)?.edited ?? true;
    if ((isEdited || recalledTarget !== null) && studio.loadedBands.size < studio.nLevels) return;
    colors.show(recalled);
    recalled = null;
    if (recalledTarget !== null) studio.showTarget(recalledTarget);
    recalledTarget = null;
  };
  studio.on(['levels', 'band'], recallColors);
  studio.showColors = (name) => colors.show(name);
  studio.showField = (name) => colors.show(`field-${name}`);
  const { divider, toggleSplit } = wipe(studio);
  const panel = h(
    'section',
    { class: 'look-panel', id: 'look', role: 'tabpanel', 'aria-label': text.look },
    h('header', {}, h('h2', {}, text.look)),
    ...style.controls,
    ...colors.controls,
    ...features.controls,
    ...clip.controls,
    ...cameraControls(studio),
  );
  return {
    panel,
    legend: colors.legend,
    frames: colors.frames,
    card: features.card,
    readouts: createReadouts(studio),
    divider,
    style: style.setStyle,
    cycleStyle: style.cycle,
    toggleClip: clip.toggle,
    toggleChange: colors.toggleChange,
    toggleSplit,
  };
}
