/** Puts the page together. */

import type { Api } from './api';
import type { Early, fetchShape as FetchShape } from './boot';
import { brushPanel } from './brush';
import { h, iconButton } from './dom';
import { equalizer } from './equalizer';
import { Files } from './files';
import { listenToKeys, showKeys } from './keys';
import { layersPanel } from './layers';
import { look as makeLook } from './look';
import type { ShapeList } from './protocol';
import { Stage } from './stage';
import { toEdit } from './state';
import { Studio } from './studio';
import { text } from './text';
import { comparisonPanel } from './tools';
import { type Theme, View } from './view';

/** What tests and the curious may ask for, as `window.studio`. */
export interface Window4Tests {
  /** Resolves when the shape is drawn and every slider is live. */
  ready: Promise<void>;
  /** The edit, as it would be sent. */
  state(): object;
  /** Milliseconds since the page was asked for, or of a kind of work each time it was done. */
  timings: object;
  /** Frames are finished and timed while this is true. */
  measure(on: boolean): void;
  /** Positions as drawn, after all computing has come to rest. */
  positions(): Promise<Float32Array>;
  /** Resolves when the server has every step. */
  kept(): Promise<void>;
  /** The mask of the last layer, as painted here, after all computing has come to rest. */
  mask(): Promise<Uint8Array>;
  /** Who draws. */
  renderer: string;
}

interface Start {
  api: Api;
  list: Promise<ShapeList>;
  early: Promise<Early | null>;
  fetchShape: typeof FetchShape;
  started: number;
}

export function start({ api, list, early, fetchShape }: Start): void {
  const app = document.getElementById('app')!;
  const toasts = h('div', { class: 'toasts', role: 'status', 'aria-live': 'polite' });
  let toastTimer = 0;
  const say = (sentence: string, kind: 'info' | 'error' = 'info') => {
    toasts.replaceChildren(h('p', { class: kind, role: kind === 'error' ? 'alert' : undefined }, sentence));
    window.clearTimeout(toastTimer);
    toastTimer = window.setTimeout(() => toasts.replaceChildren(), kind === 'error' ? 12_000 : 5_000);
  };

  const canvas = h('canvas', { class: 'picture', tabIndex: 0, 'aria-label': text.stage });
  let view: View;
  try {
    view = new View(canvas);
  } catch {
    app.replaceChildren(h('p', { class: 'fatal', role: 'alert' }, text.noWebgl));
    return;
  }
  const worker = new Worker(new URL('./compute/compute.worker.ts', import.meta.url), { type: 'module' });
  const studio = new Studio(api, view, worker, say);
  const stage = new Stage(studio, canvas);
  const look = makeLook(studio, stage);
  const files = new Files(studio, fetchShape);

  const undo = iconButton('undo', text.undo, () => studio.undo());
  const redo = iconButton('redo', text.redo, () => studio.redo());
  const before = iconButton('before', text.before, () => {});
  before.addEventListener('pointerdown', () => studio.setBefore(true));
  for (const end of ['pointerup', 'pointerleave', 'pointercancel'])
    before.addEventListener(end, () => studio.setBefore(false));
  before.addEventListener('keydown', (e) => {
    if (e.key === ' ' || e.key === 'Enter') studio.setBefore(true);
  });
  before.addEventListener('keyup', () => studio.setBefore(false));
  const split = iconButton('split', text.split, look.toggleSplit);
  const saving = h('span', { class: 'saving', role: 'status', title: text.keptHint });
  const banner = h('div', { class: 'banner', hidden: true, role: 'alert' });
  const badge = h('span', { class: 'badge', hidden: true }, text.beforeShort);

  const bar = h(
    'header',
    { class: 'bar' },
    h('strong', { class: 'brand' }, 'adwave'),
    files.tabs(),
    saving,
    h('span', { class: 'group' }, undo, redo),
    h('span', { class: 'group' }, before, split),
    h(
      'span',
      { class: 'group' },
      themeButton(view),
      iconButton('help', text.help, showKeys, { class: 'icon wide-only' }),
    ),
    h('button', { type: 'button', class: 'primary', onclick: () => files.menu() }, text.file),
  );
  const loading = h('p', { class: 'loading' }, text.loading);
  const scene = h(
    'main',
    { class: 'stage' },
    canvas,
    look.divider,
    look.readouts,
    look.legend,
    comparisonPanel(studio),
    badge,
    banner,
    loading,
    toasts,
  );
  const sections = [equalizer(studio), layersPanel(studio), brushPanel(studio), look.panel] as const;
  const tabButtons = (Object.keys(text.tabs) as (keyof typeof text.tabs)[]).map((id) =>
    h(
      'button',
      {
        type: 'button',
        'aria-pressed': String(id === 'equalizer'),
        'data-tab': id,
        onclick: () => {
          app.dataset['tab'] = id;
          for (const b of tabButtons) b.setAttribute('aria-pressed', String(b.dataset['tab'] === id));
        },
      },
      text.tabs[id],
    ),
  );
  app.dataset['tab'] = 'equalizer';
  app.replaceChildren(
    bar,
    scene,
    sections[0],
    h('aside', { class: 'side' }, ...sections.slice(1)),
    h('nav', { class: 'sheet-tabs', 'aria-label': text.title }, ...tabButtons),
  );

  const fit = () => view.resize(scene.clientWidth, scene.clientHeight);
  new ResizeObserver(fit).observe(scene);
  fit();
  listenToKeys(studio, stage, look, files);
  files.acceptDrops(app);

  studio.on(['doc', 'shape'], () => {
    undo.disabled = !studio.history.canUndo;
    redo.disabled = !studio.history.canRedo;
  });
  studio.on(['before', 'compared'], () => {
    badge.hidden = !view.before;
    badge.textContent = studio.compared ? text.compareShort[studio.compared.method] : text.beforeShort;
    before.setAttribute('aria-pressed', String(view.before));
    split.setAttribute('aria-pressed', String(view.split !== null));
  });
  studio.on('shape', () => {
    document.title = `${studio.shape!.name} – ${text.title}`;
    if (studio.shape!.resumed && !resumedSaid.has(studio.shape!.id)) say(text.resumed);
    resumedSaid.add(studio.shape!.id);
    if (studio.nLevels === 0 || studio.shape!.diagonal === 0) say(text.tooSmall, 'error');
  });
  const resumedSaid = new Set<number>();

  const keptWaiters: (() => void)[] = [];
  studio.on('saving', () => {
    const { saver } = studio;
    if (!saver) return;
    const words = {
      kept: text.kept,
      sending: text.sending,
      offline: text.offline,
      ended: text.offline,
      conflict: text.conflictBanner,
      refused: text.offline,
    };
    saving.textContent = saver.state === 'conflict' || saver.state === 'refused' ? '' : words[saver.state];
    saving.dataset['state'] = saver.state;
    banner.hidden = !['offline', 'ended', 'conflict'].includes(saver.state);
    const keepAsFile = h('button', { type: 'button', onclick: () => files.saveEdit() }, text.editSave);
    if (saver.state === 'offline') banner.replaceChildren(h('p', {}, text.offlineBanner), keepAsFile);
    if (saver.state === 'ended') banner.replaceChildren(h('p', {}, text.endedBanner), keepAsFile);
    if (saver.state === 'conflict') {
      banner.replaceChildren(
        h('p', {}, text.conflictBanner),
        h(
          'button',
          {
            type: 'button',
            onclick: () => {
              saver.resolve(true);
              studio.emit('saving');
            },
          },
          text.keepMine,
        ),
        h('button', { type: 'button', onclick: () => studio.session.takeTheirs() }, text.takeTheirs),
      );
    }
    if (saver.state === 'refused') say(saver.problem, 'error');
    if (saver.state === 'kept') for (const done of keptWaiters.splice(0)) done();
  });
  window.addEventListener('pagehide', () => studio.saver?.flush());
  canvas.addEventListener('webglcontextlost', () => say(text.lostPicture));
  canvas.addEventListener('webglcontextrestored', () => view.request());

  const ready = (async () => {
    try {
      studio.shapes = await list;
      studio.emit('shapes');
      const first = await early;
      if (!first) {
        loading.textContent = text.noShape;
        return;
      }
      const opened = studio.session.open(first);
      void first.positions.then(() => loading.remove());
      await opened;
      await studio.display.settled();
    } catch (error) {
      loading.textContent = (error as Error).message;
      loading.classList.add('error');
      app.append(loading);
      throw error;
    }
  })();
  ready.catch(() => {});
  studio.on('shape', () => loading.remove());

  const tests: Window4Tests = {
    ready,
    state: () => toEdit(studio.doc, 0),
    timings: studio.watch.timings,
    measure: (on) => {
      studio.watch.measuring = on;
    },
    positions: async () => {
      await studio.display.settled();
      return (await studio.engine.call('positions', {})).positions;
    },
    mask: async () => {
      await studio.display.settled();
      return (await studio.engine.call('maskBytes', { key: studio.doc.layers.at(-1)!.key })).bytes;
    },
    kept: () =>
      studio.saver && studio.saver.state === 'kept' && !studio.saver.pending
        ? Promise.resolve()
        : new Promise((done) => keptWaiters.push(done)),
    renderer: view.rendererName,
  };
  (window as unknown as { studio: Window4Tests }).studio = tests;
}

/** Light, dark, or as the system has it; the choice is remembered. */
function themeButton(view: View): HTMLButtonElement {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  let chosen = localStorage.getItem('adwave-theme') as Theme | null;
  const apply = () => {
    const theme: Theme = chosen ?? (dark.matches ? 'dark' : 'light');
    document.documentElement.dataset['theme'] = theme;
    view.setTheme(theme);
  };
  dark.addEventListener('change', apply);
  apply();
  return iconButton('theme', text.theme, () => {
    chosen = document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark';
    localStorage.setItem('adwave-theme', chosen);
    apply();
  });
}
