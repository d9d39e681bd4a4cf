/** List of layers, and the settings of the selected one. */

import { check, h, iconButton, select, slider } from './dom';
import { editList } from './edit-list';
import { gainSummary } from './gain-summary';
import type { Along, Border, Region, VolumeRule } from './protocol';
import { describeRegion, regionChooser } from './region-panel';
import { type DocLayer, newKey } from './state';
import type { Studio } from './studio';
import { text } from './text';

function removeLayer(studio: Studio, key: number): void {
  if (studio.layers.length === 1) {
    studio.showMessage(text.lastLayer);
    return;
  }
  studio.history.commit(studio.withLayers(studio.layers.filter((l) => l.key !== key)));
}

function duplicateLayer(studio: Studio, layer: DocLayer): void {
  const i = studio.layers.findIndex((l) => l.key === layer.key);
  const copy = { ...layer, key: newKey(), name: text.copyName(layer.name || text.layerName(i + 1)) };
  studio.history.commit(studio.withLayers(studio.layers.toSpliced(i + 1, 0, copy)));
  studio.select(copy.key);
}

/** Describes where a layer acts, and its gains. */
function describeLayer(studio: Studio, layer: DocLayer): string {
  const gains = gainSummary(layer, studio.shape?.presets ?? []);
  // There is little room, and most layers act everywhere.
  const where = gains !== '' && layer.region === null ? '' : describeRegion(layer.region);
  return [where, gains].filter((part) => part !== '').join(' · ');
}

/** Creates the list item of a layer; `rename` is called with its displayed name on a double click. */
function layerItem(studio: Studio, layer: DocLayer, i: number, rename: (name: string) => void): HTMLElement {
  const name = layer.name || text.layerName(i + 1);
  const selected = layer.key === studio.layer.key;
  const choose = h(
    'button',
    {
      type: 'button',
      class: 'name',
      'aria-pressed': String(selected),
      title: text.renameHint,
      onclick: () => studio.select(layer.key),
      ondblclick: () => rename(name),
    },
    h('span', {}, name),
    h('small', {}, describeLayer(studio, layer)),
  );
  return h(
    'li',
    { class: selected ? 'selected' : '', 'data-key': String(layer.key) },
    iconButton(
      layer.on ? 'eye' : 'off',
      layer.on ? text.layerOff(name) : text.layerOn(name),
      () => studio.changeLayer({ on: !layer.on }, true, layer.key),
      { 'aria-pressed': String(layer.on) },
    ),
    choose,
    iconButton('copy', text.duplicate(name), () => duplicateLayer(studio, layer)),
    iconButton('bin', text.remove(name), () => removeLayer(studio, layer.key)),
  );
}

/** Replaces the name of a layer by an input; `done` is called when the input is left. */
function renameLayer(
  studio: Studio,
  list: HTMLElement,
  layer: DocLayer,
  name: string,
  done: () => void,
): void {
  const input = h('input', { type: 'text', value: name, 'aria-label': text.layerRename });
  const item = list.querySelector(`[data-key="${layer.key}"] .name`);
  item?.replaceWith(input);
  input.select();
  input.addEventListener('blur', () => {
    studio.changeLayer({ name: input.value.trim() }, true, layer.key);
    done();
  });
  input.addEventListener('keydown', (event) => {
    if (event.key === 'Enter') input.blur();
    if (event.key === 'Escape') {
      input.value = layer.name;
      input.blur();
    }
  });
}

/** Creates the settings of the selected layer; `show` updates them, `reset` forces new region controls. */
function layerSettings(studio: Studio) {
  const opacity = slider(
    text.opacity,
    { min: 0, max: 100, step: 1, value: 100 },
    (v) => `${v} %`,
    (v, done) => {
      studio.timings.startSliderTiming();
      studio.changeLayer({ opacity: v / 100 }, false);
      if (done) studio.history.end();
    },
  );
  const tint = check(text.tint, studio.tint.region, (on) => {
    studio.tint[studio.tintKind] = on;
    studio.updateTint();
    studio.emit('tint');
  });
  const tintBox = tint.querySelector('input')!;
  const where = h('div', { class: 'where' });
  let shown: Region | null | undefined;
  let shownKey = -1;
  const show = () => {
    const { layer } = studio;
    opacity.set(Math.round(100 * layer.opacity));
    tint.hidden = layer.region === null;
    tintBox.checked = studio.tint[studio.tintKind];
    if (shown === layer.region && shownKey === layer.key) return;
    shown = layer.region;
    shownKey = layer.key;
    where.replaceChildren(regionChooser(studio));
  };
  const reset = () => {
    shownKey = -1;
  };
  return { element: h('div', { class: 'detail' }, opacity, where, tint), show, reset };
}

/** Creates the constraints on new positions. */
function constraints(studio: Studio): HTMLElement {
  const element = h('details', { class: 'rules' });
  const show = () => {
    const { doc } = studio;
    const set = (change: object) => studio.history.commit({ ...studio.doc, ...change });
    element.replaceChildren(
      h('summary', {}, text.rules),
      select<Along>(text.along, text.alongChoices, doc.along ?? 'free', (along) =>
        set({ along: along === 'free' ? null : along }),
      ),
      select<Border>(text.border, text.borderChoices, doc.border ?? 'natural', (border) => set({ border })),
      // A rule that an edit has can be taken back on any shape.
      ...(studio.shape?.volume == null && (doc.volume ?? 'free') === 'free'
        ? []
        : [
            select<VolumeRule>(text.volumeRule, text.volumeChoices, doc.volume ?? 'free', (volume) =>
              set({ volume }),
            ),
          ]),
    );
  };
  studio.on('shape', show);
  let shown = '';
  studio.on('doc', () => {
    const now = `${studio.doc.along} ${studio.doc.border} ${studio.doc.volume}`;
    if (now !== shown) show();
    shown = now;
  });
  return element;
}

export function layersPanel(studio: Studio): HTMLElement {
  const list = h('ul', { class: 'layers', 'aria-label': text.layers });
  const settings = layerSettings(studio);
  const rebuild = () => {
    list.replaceChildren(
      ...studio.layers.map((layer, i) =>
        layerItem(studio, layer, i, (name) => renameLayer(studio, list, layer, name, rebuild)),
      ),
    );
    settings.show();
  };
  studio.on('drawing', () => {
    settings.reset();
    rebuild();
  });
  studio.on(['doc', 'selected', 'shape'], rebuild);
  const rules = constraints(studio);
  studio.on('target', () => {
    // Constraints hold for positions.
    rules.hidden = studio.target !== null || studio.shape?.graph?.placed === true;
    settings.reset();
    rebuild();
  });
  return h(
    'section',
    { class: 'layers-panel', id: 'layers', role: 'tabpanel', 'aria-label': text.layers },
    h(
      'header',
      {},
      h('h2', {}, text.layers),
      h('span', { class: 'space' }),
      iconButton('plus', text.addLayer, () => {
        studio.addLayer(text.layerName(studio.layers.length + 1), null);
      }),
    ),
    list,
    settings.element,
    rules,
    editList(studio),
  );
}
