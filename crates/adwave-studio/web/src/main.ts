/** Assembles the page. */

import type { Api } from './api';
import type { fetchShape as FetchShape, ShapeRequest } from './boot';
import { brushPanel } from './brush';
import { h, iconButton } from './dom';
import { equalizer } from './equalizer';
import { Files } from './files';
import { Gizmo } from './gizmo';
import { gridPanel } from './grid/grid-panel';
import { listenToKeys, showKeys } from './keys';
import { layersPanel } from './layers-panel';
import { type LookPanel, lookPanel } from './look-panel';
import type { ShapeList } from './protocol';
import type { SaveState } from './saver';
import { scaleBar } from './scale-bar';
import { Stage } from './stage';
import { Studio } from './studio';
import { installTestHooks } from './test-hooks';
import { text } from './text';
import { toolbar } from './toolbar';
import { comparisonPanel } from './tools';
import { stillInward } from './turned-parts';
import { type Theme, View } from './view';

interface StartOptions {
  api: Api;
  list: Promise<ShapeList>;
  early: Promise<ShapeRequest | null>;
  fetchShape: typeof FetchShape;
  started: number;
}

/** Shortest time for which messages are shown, and for each of their characters, in milliseconds. */
const SHOWN = { info: 5_000, error: 12_000, perCharacter: 60 };

/**
 * Creates the area of short messages, the function that shows one, and one that ends it if the user has done something since.
 */
function messageArea(): { element: HTMLElement; showMessage: Studio['showMessage']; goOn: () => void } {
  const element = h('div', { class: 'toasts', role: 'status', 'aria-live': 'polite' });
  let timer = 0;
  let hasActed = false;
  for (const type of ['pointerdown', 'keydown', 'input', 'change', 'drop'])
    window.addEventListener(type, () => (hasActed = true), { capture: true });
  const clear = () => {
    window.clearTimeout(timer);
    element.replaceChildren();
  };
  const showMessage: Studio['showMessage'] = (sentence, kind = 'info', link) => {
    const message = h(
      'p',
      { class: kind, role: kind === 'error' ? 'alert' : undefined },
      link ? `${sentence} ` : sentence,
    );
    const withdraw = () => {
      if (message.isConnected) clear();
    };
    const follow = () => {
      withdraw();
      link?.onclick();
    };
    if (link) message.append(h('button', { type: 'button', class: 'link', onclick: follow }, link.label));
    clear();
    element.append(message);
    hasActed = false;
    // A request stays until it is met or withdrawn.
    if (kind !== 'request')
      timer = window.setTimeout(clear, Math.max(SHOWN[kind], SHOWN.perCharacter * sentence.length));
    return withdraw;
  };
  const goOn = () => {
    if (hasActed && !element.querySelector('.request')) clear();
  };
  return { element, showMessage, goOn };
}

/** Creates the bar at the top of the page, and the badge that names the shown original. */
function topBar(studio: Studio, files: Files, look: LookPanel, saving: HTMLElement) {
  const { view } = studio;
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
  const split = iconButton('split', text.split, () =>
    studio.isGrid ? studio.gridView.toggleWipe() : look.toggleSplit(),
  );
  const badge = h('span', { class: 'badge', hidden: true }, text.beforeShort);
  studio.on(['doc', 'shape', 'waiting'], () => {
    undo.disabled = !studio.history.canUndo || studio.waiting.size > 0;
    redo.disabled = !studio.history.canRedo || studio.waiting.size > 0;
  });
  studio.on(['before', 'compared', 'shape'], () => {
    badge.hidden = !view.showsOriginal;
    badge.textContent = studio.comparison ? text.compareShort[studio.comparison.method] : text.beforeShort;
    before.setAttribute('aria-pressed', String(view.showsOriginal));
    const at = studio.isGrid ? studio.gridView.wipe.at : view.split;
    split.setAttribute('aria-pressed', String(at !== null));
  });
  const tools = h(
    'button',
    { type: 'button', class: 'wide-only', onclick: () => files.openTools() },
    text.tools,
  );
  studio.on('shape', () => {
    // Of an image or a volume there is nothing to compare or to report yet.
    tools.hidden = studio.isGrid;
  });
  const bar = h(
    'header',
    { class: 'bar' },
    h('h1', {}, 'adwave'),
    files.tabs(),
    saving,
    h('span', { class: 'group' }, undo, redo),
    h('span', { class: 'group' }, before, split),
    h(
      'span',
      { class: 'group' },
      themeButton(studio),
      iconButton('help', text.help, () => showKeys(studio.isGrid)),
    ),
    tools,
    h('button', { type: 'button', class: 'primary', onclick: () => files.openMenu() }, text.file),
  );
  return { bar, badge };
}

/** Creates the save indicator and the banner about an unreachable server or a conflict. */
function saveStatus(studio: Studio, files: Files) {
  const saving = h('span', { class: 'saving', role: 'status', title: text.editSavedHint });
  const banner = h('div', { class: 'banner', hidden: true, role: 'alert' });
  const button = (label: string, onclick: () => void) => h('button', { type: 'button', onclick }, label);
  let withdraw = () => {};
  studio.on('saving', () => {
    const { saver } = studio;
    if (!saver) return;
    const { state } = saver;
    const labels: Partial<Record<SaveState, string>> = {
      saved: text.editSaved,
      sending: text.sending,
      offline: text.offline,
      ended: text.offline,
    };
    // Nothing was saved before the first step.
    const isUntouched = state === 'saved' && !studio.history.canUndo && !studio.shape?.resumed;
    saving.textContent = isUntouched ? '' : (labels[state] ?? '');
    saving.dataset['state'] = state;
    banner.hidden = !['offline', 'ended', 'conflict'].includes(state);
    if (state === 'offline' || state === 'ended') {
      const sentence = state === 'offline' ? text.offlineBanner : text.endedBanner;
      banner.replaceChildren(
        h('p', {}, sentence),
        button(text.editSave, () => files.saveEdit()),
      );
    }
    if (state === 'conflict') {
      const keepMine = () => {
        saver.resolve(true);
        studio.emit('saving');
      };
      banner.replaceChildren(
        h('p', {}, text.conflictBanner),
        button(text.keepMine, keepMine),
        button(text.takeTheirs, () => studio.session.acceptConflictingEdit()),
      );
    }
    withdraw();
    if (state === 'refused') withdraw = studio.showMessage(saver.problem, 'error');
  });
  return { saving, banner };
}

/** Creates the notice of work that the user waits for; it appears after a moment, so that short work does not flicker. */
function waitNotice(studio: Studio): HTMLElement {
  const notice = h('div', { class: 'waiting-notice', hidden: true, role: 'status' });
  let timer = 0;
  const show = () => {
    notice.hidden = studio.waiting.size === 0;
    notice.replaceChildren(
      ...[...studio.waiting.values()].map(({ what, cancel }) =>
        h(
          'p',
          {},
          h('i', { class: 'spinner', 'aria-hidden': 'true' }),
          h('span', {}, what),
          h('button', { type: 'button', onclick: cancel }, text.cancel),
        ),
      ),
    );
  };
  studio.on('waiting', () => {
    window.clearTimeout(timer);
    if (studio.waiting.size === 0 || !notice.hidden) show();
    else timer = window.setTimeout(show, 200);
  });
  return notice;
}

type Tab = keyof typeof text.tabs;

/**
 * Creates the tabs that choose a panel: beside the picture one of the layers, the brush and the view; on narrow screens below
 * it, with the bands as a fourth.
 */
function panelTabs(
  studio: Studio,
  app: HTMLElement,
): { side: HTMLElement; sheet: HTMLElement; choose: () => void } {
  const show = (tab: Tab) => {
    app.dataset['tab'] = tab;
    if (tab !== 'equalizer') app.dataset['side'] = tab;
    for (const b of buttons) {
      const chosen = b.dataset['group'] === 'side' ? app.dataset['side'] : app.dataset['tab'];
      const isChosen = b.dataset['tab'] === chosen;
      b.setAttribute('aria-selected', String(isChosen));
      b.tabIndex = isChosen ? 0 : -1;
    }
  };
  const buttons: HTMLButtonElement[] = [];
  const bar = (group: 'side' | 'sheet', tabs: Tab[]) => {
    const made = tabs.map((id) =>
      h(
        'button',
        {
          type: 'button',
          role: 'tab',
          'aria-controls': id,
          'data-tab': id,
          'data-group': group,
          onclick: () => show(id),
        },
        text.tabs[id],
      ),
    );
    buttons.push(...made);
    const onkeydown = (event: KeyboardEvent) => {
      const shown = made.filter((b) => !b.hidden);
      const at = shown.indexOf(event.target as HTMLButtonElement);
      const next = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: -1 }[event.key];
      if (next === undefined) return;
      event.preventDefault();
      event.stopPropagation();
      const button = shown.at(next % shown.length)!;
      button.click();
      button.focus();
    };
    const label = { 'aria-label': text.panels };
    const list = h('div', { role: 'tablist', ...label, onkeydown }, ...made);
    return h('nav', { class: `${group}-tabs`, ...label }, list);
  };
  const side = bar('side', ['layers', 'brush', 'look', 'grid']);
  const sheet = bar('sheet', ['equalizer', 'layers', 'brush', 'look', 'grid']);
  show('layers');
  show('equalizer');
  let brushWasOn = false;
  studio.on('tool', () => {
    const isOn = studio.isBrushOn || studio.isGrabOn;
    if (isOn && !brushWasOn) {
      // On a wide screen the settings of the brush come forward; a narrow one keeps its sheet.
      const tab = app.dataset['tab'] as Tab;
      show('brush');
      if (tab === 'equalizer') show('equalizer');
    }
    brushWasOn = isOn;
  });
  /** Shows the tabs of a shape, or those of an image or a volume, and one that is among them. */
  const choose = () => {
    for (const b of buttons) {
      const isOfGrid = b.dataset['tab'] === 'grid';
      b.hidden = b.dataset['tab'] !== 'equalizer' && isOfGrid !== studio.isGrid;
    }
    const shown = app.dataset['tab'] as Tab;
    const isFit = (app.dataset['side'] === 'grid') === studio.isGrid;
    if (!isFit) show(studio.isGrid ? 'grid' : 'layers');
    if (!isFit && shown === 'equalizer') show('equalizer');
  };
  return { side, sheet, choose };
}

/** Sets the title of the page and shows messages about a newly opened shape. */
function announceShapes(studio: Studio): void {
  const announced = new Set<number>();
  studio.on('shape', () => {
    const shape = studio.shape!;
    document.title = `${shape.name} – ${text.title}`;
    if (!localStorage.getItem('adwave-visited'))
      studio.showMessage(text.firstVisits[shape.kind] ?? text.firstVisit);
    localStorage.setItem('adwave-visited', 'yes');
    if (shape.resumed && !announced.has(shape.id))
      studio.showMessage(shape.grid ? text.gridResumed : text.resumed);
    const inward = stillInward(shape, studio.doc.turned);
    if (inward.length > 0) {
      const turn = () => studio.turnedParts.set(stillInward(shape, studio.doc.turned), true);
      const sentence = text.inward(inward.length, shape.components);
      studio.showMessage(sentence, 'info', { label: text.turn, onclick: turn });
    }
    announced.add(shape.id);
    if (studio.nLevels === 0 || shape.diagonal === 0) studio.showMessage(text.tooSmall, 'error');
  });
}

/** Opens the first shape; `loading` shows the progress and errors. */
async function openFirstShape(
  studio: Studio,
  { list, early }: StartOptions,
  app: HTMLElement,
  loading: HTMLElement,
): Promise<void> {
  try {
    studio.shapes = await list;
    studio.emit('shapes');
    const first = await early;
    if (!first) {
      loading.textContent = text.noShape;
      return;
    }
    const opened = studio.session.open(first);
    void first.positions.then((positions) => positions.length > 0 && loading.remove());
    await opened;
    await studio.display.waitUntilSettled();
  } catch (error) {
    loading.textContent = (error as Error).message;
    loading.classList.add('error');
    app.append(loading);
    throw error;
  }
}

export function start(options: StartOptions): void {
  const app = document.getElementById('app')!;
  const messages = messageArea();
  const canvas = h('canvas', { class: 'picture', tabIndex: 0, 'aria-label': text.stage });
  let view: View;
  try {
    view = new View(canvas);
  } catch {
    app.replaceChildren(h('p', { class: 'fatal', role: 'alert' }, text.noWebgl));
    return;
  }
  const worker = new Worker(new URL('./compute/compute.worker.ts', import.meta.url), { type: 'module' });
  const studio = new Studio(options.api, view, worker, messages.showMessage);
  studio.on(['doc', 'selected', 'tool', 'target', 'shape', 'levels'], messages.goOn);
  const stage = studio.forShapes(() => new Stage(studio, canvas));
  const look = studio.forShapes(() => lookPanel(studio, stage));
  const files = new Files(studio, options.fetchShape);
  const { saving, banner } = saveStatus(studio, files);
  const { bar, badge } = topBar(studio, files, look, saving);
  const loading = h('p', { class: 'loading' }, text.loading);
  const scale = scaleBar(view);
  studio.on('shape', () => {
    scale.hidden = studio.shape?.graph?.placed === true;
  });
  const ofShapes = studio.forShapes(() => [
    h(
      'div',
      { class: 'of-shapes' },
      canvas,
      new Gizmo(studio, stage).element,
      look.divider,
      look.readouts,
      look.card,
      look.legend,
      look.frames,
      toolbar(studio),
      scale,
      comparisonPanel(studio),
      studio.beside.labels(),
    ),
    h('div', { class: 'of-shapes' }, layersPanel(studio), brushPanel(studio), look.panel),
  ]);
  const { gridView } = studio;
  const ofGrids = [gridView.element, h('div', { class: 'of-shapes' }, gridPanel(studio, gridView))];
  const scene = h(
    'main',
    { class: 'stage' },
    ofShapes[0],
    ofGrids[0],
    badge,
    banner,
    waitNotice(studio),
    loading,
    messages.element,
  );
  const tabs = panelTabs(studio, app);
  app.replaceChildren(
    bar,
    scene,
    equalizer(studio),
    h('aside', { class: 'side', 'aria-label': text.panels }, tabs.side, ofShapes[1], ofGrids[1]),
    tabs.sheet,
  );
  const fit = () => {
    view.resize(scene.clientWidth, scene.clientHeight);
    divide();
  };
  const divide = () => {
    scene.classList.toggle('beside', view.halves === 'beside');
    scene.classList.toggle('below', view.halves === 'below');
  };
  studio.on('beside', divide);
  const showDomain = () => {
    app.dataset['domain'] = studio.isGrid ? 'grid' : 'shape';
    for (const part of ofShapes) part.hidden = studio.isGrid;
    for (const part of ofGrids) part.hidden = !studio.isGrid;
    tabs.choose();
  };
  studio.showDomain = showDomain;
  showDomain();
  new ResizeObserver(fit).observe(scene);
  fit();
  listenToKeys(studio, stage, look, files);
  files.acceptDrops(app);
  announceShapes(studio);
  window.addEventListener('pagehide', () => {
    // A gesture that is not over becomes a step.
    studio.history.end();
    studio.saver?.flush();
    studio.session.storeHistory();
  });
  canvas.addEventListener('webglcontextlost', () => {
    stage.interrupt();
    const withdraw = studio.showMessage(text.lostPicture);
    const restore = () => {
      withdraw();
      view.request();
    };
    canvas.addEventListener('webglcontextrestored', restore, { once: true });
  });

  const ready = openFirstShape(studio, options, app, loading);
  ready.catch(() => {});
  studio.on('shape', () => loading.remove());
  if (import.meta.env.MODE === 'e2e') installTestHooks(studio, ready);
}

/** Creates the button that switches between light and dark; the choice is remembered. */
function themeButton(studio: Studio): HTMLButtonElement {
  const dark = matchMedia('(prefers-color-scheme: dark)');
  let chosen = localStorage.getItem('adwave-theme') as Theme | null;
  const apply = () => {
    const theme: Theme = chosen ?? (dark.matches ? 'dark' : 'light');
    document.documentElement.dataset['theme'] = theme;
    studio.view.setTheme(theme);
    studio.emit('theme');
  };
  dark.addEventListener('change', apply);
  apply();
  studio.toggleTheme = () => {
    chosen = document.documentElement.dataset['theme'] === 'dark' ? 'light' : 'dark';
    localStorage.setItem('adwave-theme', chosen);
    apply();
  };
  return iconButton('theme', text.theme, studio.toggleTheme, { class: 'icon wide-only' });
}
