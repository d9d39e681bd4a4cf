/** Keyboard shortcuts. */

import { brush } from './brush';
import { dialog } from './dialog';
import { h } from './dom';
import type { Files } from './files';
import type { LookPanel } from './look-panel';
import { reshape } from './region-panel';
import type { Stage } from './stage';
import type { Studio } from './studio';
import { text } from './text';

export function showKeys(isGrid: boolean): void {
  const list = isGrid ? text.gridKeyList : text.keyList;
  dialog(
    text.keys,
    h(
      'dl',
      { class: 'keys' },
      ...list.flatMap(([keys, what]) => [
        h('dt', {}, ...keys.split(' ').map((k) => h('kbd', {}, k))),
        h('dd', {}, what),
      ]),
    ),
    h('h3', {}, text.about),
    h('p', {}, text.license),
    h('p', {}, h('a', { href: 'third-party-notices.txt', target: '_blank', rel: 'noopener' }, text.notices)),
  );
}

function focusSliders(): void {
  document.querySelector<HTMLInputElement>('.band input.gain:not(:disabled)')?.focus();
}

export function listenToKeys(studio: Studio, stage: Stage, look: LookPanel, files: Files): void {
  const { view } = studio;
  const views = { '1': ['front', 'back'], '3': ['right', 'left'], '7': ['top', 'bottom'] } as const;

  window.addEventListener('keydown', (e) => {
    const target = e.target instanceof HTMLElement ? e.target : document.body;
    const typing =
      target.matches('textarea, select, [contenteditable]') ||
      (target instanceof HTMLInputElement && target.type !== 'range' && target.type !== 'checkbox');
    const command = e.ctrlKey || e.metaKey;
    const key = e.key.length === 1 ? e.key.toLowerCase() : e.key;
    if (command && !e.altKey) {
      if (key === 'z' && !typing) e.shiftKey ? studio.redo() : studio.undo();
      else if (key === 'y' && !typing) studio.redo();
      else if (key === 's') void files.save();
      else if (key === 'o') files.choose();
      else return;
      e.preventDefault();
      return;
    }
    if (typing || e.altKey || document.querySelector('dialog[open]')) return;
    if (studio.isGrid) {
      if (key === '?') showKeys(true);
      else if (key === '\\') studio.setBefore(true);
      else if (key === 's') studio.gridView.toggleWipe();
      else if (key === 'f') studio.gridView.fitAll();
      else if (key === ',' || key === '.') studio.gridView.frames.step(key === '.' ? 1 : -1);
      else if (key === 'e') focusSliders();
      else return;
      e.preventDefault();
      return;
    }
    const number = (e.code.match(/^(?:Digit|Numpad)([137])$/) ?? [])[1] as keyof typeof views | undefined;
    if (number) {
      view.camera.look(views[number][e.shiftKey ? 1 : 0]);
      view.markMoving();
    } else if (e.key === '?') showKeys(false);
    else if (e.key === '\\') studio.setBefore(true);
    else if (key === 'b') studio.setTool(studio.isBrushOn ? 'look' : 'brush');
    else if (key === 'p' && !studio.shape?.graph) studio.setTool(studio.isGrabOn ? 'look' : 'grab');
    else if (key === 'n') {
      brush.mode = brush.mode === 'add' ? 'subtract' : 'add';
      studio.emit('tool');
    } else if (key === 'j') {
      brush.mode = brush.mode === 'smooth' ? 'add' : 'smooth';
      studio.emit('tool');
    } else if (key === 'g') reshape(studio, e.shiftKey ? 'shrink' : 'grow');
    else if (key === 'u') reshape(studio, 'blur');
    else if (key === 'Enter' && studio.lineDrawing) studio.lineDrawing.end();
    else if (key === '[') stage.resizeBrush(1 / 1.15);
    else if (key === ']') stage.resizeBrush(1.15);
    else if (key === 's') look.toggleSplit();
    else if (key === 'm') look.cycleStyle();
    else if (key === 'c') look.toggleChange();
    else if (key === 'x') look.toggleClip();
    else if (key === 'f' || key === 'Home') {
      if (key === 'Home' && target instanceof HTMLInputElement) return;
      view.camera.frame();
      view.markMoving();
    } else if (key === 'l') studio.addLayer(text.layerName(studio.layers.length + 1), null);
    else if (key === 'e') focusSliders();
    else if (key === ',' || key === '.') {
      const { layers } = studio;
      const i = layers.indexOf(studio.layer) + (key === '.' ? 1 : -1);
      if (layers[i]) studio.select(layers[i].key);
    } else if (key === 'Escape') {
      if (stage.escape()) return;
      studio.setTool('look');
    } else if (target === view.canvas && e.key.startsWith('Arrow')) {
      const [dx, dy] = { ArrowLeft: [-24, 0], ArrowRight: [24, 0], ArrowUp: [0, -24], ArrowDown: [0, 24] }[
        e.key
      ] as [number, number];
      if (e.shiftKey) view.camera.pan(dx, dy);
      else view.camera.turn(dx, dy);
      view.markMoving();
    } else if (target === view.canvas && (key === '+' || key === '-' || key === '=')) {
      const r = view.canvas.getBoundingClientRect();
      view.camera.zoom(key === '-' ? 1.15 : 1 / 1.15, r.width / 2, r.height / 2);
      view.markMoving();
    } else return;
    e.preventDefault();
  });
  window.addEventListener('keyup', (e) => {
    if (e.key === '\\') studio.setBefore(false);
  });
  window.addEventListener('blur', () => studio.setBefore(false));
}
