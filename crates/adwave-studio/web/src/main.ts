/** Assembles the page. */

import type { Api } from './api';
import type { fetchShape as FetchShape, ShapeRequest } from './boot';
import { brushPanel } from './brush';
import { h, iconButton } from './dom';
import { equalizer } from './equalizer';
import { Files } from './files';
import { listenToKeys, showKeys } from './keys';
import { layersPanel } from './layers-panel';
import { lookPanel } from './look-panel';
import type { ShapeList } from './protocol';
import { Stage } from './stage';
import { type MessageLink, Studio } from './studio';
import { installTestHooks } from './test-hooks';
import { text } from './text';
import { comparisonPanel } from './tools';
import { type Theme, View } from './view';

interface StartOptions {
  api: Api;
  list: Promise<ShapeList>;
  early: Promise<ShapeRequest | null>;
  fetchShape: typeof FetchShape;
  started: number;
}

export function start({ api, list, early, fetchShape }: StartOptions): void {
  const app = document.getElementById('app')!;
  const toasts = h('div', { class: 'toasts', role: 'status', 'aria-live': 'polite' });
  let toastTimer = 0;
  const showMessage = (sentence: string, kind: 'info' | 'error' = 'info', link?: MessageLink) => {
    toasts.replaceChildren(
      h(
        'p',
        { class: kind, role: kind === 'error' ? 'alert' : undefined },
        link ? `${sentence} ` : sentence,
        link ? h('button', { type: 'button', class: 'link', onclick: link.onclick }, link.label) : null,
      ),
    );
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
  const studio = new Studio(api, view, worker, showMessage);
  const stage = new Stage(studio, canvas);
  const look = lookPanel(studio, stage);
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
  const saving = h('span', { class: 'saving', role: 'status', title: text.editSavedHint });
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
    h('button', { type: 'button', class: 'primary', onclick: () => files.openMenu() }, text.file),
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
    badge.hidden = !view.showsOriginal;
    badge.textContent = studio.comparison ? text.compareShort[studio.comparison.method] : text.beforeShort;
    before.setAttribute('aria-pressed', String(view.showsOriginal));
    split.setAttribute('aria-pressed', String(view.split !== null));
  });
  studio.on('shape', () => {
    document.title = `${studio.shape!.name} – ${text.title}`;
    if (studio.shape!.resumed && !announcedShapes.has(studio.shape!.id)) showMessage(text.resumed);
    announcedShapes.add(studio.shape!.id);
    if (studio.nLevels === 0 || studio.shape!.diagonal === 0) showMessage(text.tooSmall, 'error');
  });
  const announcedShapes = new Set<number>();

  studio.on('saving', () => {
    const { saver } = studio;
    if (!saver) return;
    const words = {
      saved: text.editSaved,
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
        h(
          'button',
          { type: 'button', onclick: () => studio.session.acceptConflictingEdit() },
          text.takeTheirs,
        ),
      );
    }
    if (saver.state === 'refused') showMessage(saver.problem, 'error');
  });
  window.addEventListener('pagehide', () => studio.saver?.flush());
  canvas.addEventListener('webglcontextlost', () => showMessage(text.lostPicture));
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
      await studio.display.waitUntilSettled();
    } catch (error) {
      loading.textContent = (error as Error).message;
      loading.classList.add('error');
      app.append(loading);
      throw error;
    }
  })();
  ready.catch(() => {});
  studio.on('shape', () => loading.remove());

  if (import.meta.env.MODE === 'e2e') installTestHooks(studio, ready);
}

/** Creates the button that switches between light and dark; the choice is remembered. */
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
