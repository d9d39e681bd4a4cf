/** The parts of the edit on top of the layers: clones, pins and handles, turned parts, and edits of fields. */

import { h, iconButton } from './dom';
import { gainSummary } from './gain-summary';
import { pinsOf, vertexOf } from './grab';
import { formatNumber } from './lengths';
import type { DetailClone, Pose, PoseHandle } from './protocol';
import { areNeutral, type Doc, isOn } from './state';
import type { Studio } from './studio';
import { text } from './text';
import { withTurned } from './turned-parts';

/** One row of the list. */
interface Item {
  /** Identifies the row among those of the list. */
  id: string;
  name: string;
  note: string;
  on: boolean;
  /** Marks the place of the item in the picture, or shows what it edits. */
  show: () => void;
  /** The document with or without the effect of the item; `null` if the item has no eye. */
  toggled: (() => Doc) | null;
  removed: () => Doc;
  /** The document with another name of the item; `null` if the item has no name of its own. */
  renamed: ((name: string) => Doc) | null;
  /** The document with the item further up or down; `null` where the order does not matter. */
  moved: ((by: -1 | 1) => Doc | null) | null;
}

/** Members that clones and handles share, which are entries of lists. */
function entry<T extends { name?: string; on?: boolean }>(
  list: readonly T[],
  k: number,
  withList: (list: T[]) => Doc,
): Pick<Item, 'on' | 'toggled' | 'removed' | 'renamed'> {
  const changed = (change: Partial<T>) =>
    withList(list.map((one, i) => (i === k ? { ...one, ...change } : one)));
  return {
    on: isOn(list[k]!),
    toggled: () => changed({ on: !isOn(list[k]!) } as Partial<T>),
    removed: () => withList(list.filter((_, i) => i !== k)),
    renamed: (name) => changed({ name } as Partial<T>),
  };
}

function cloneItems(studio: Studio): Item[] {
  const { doc } = studio;
  const withClones = (clones: DetailClone[]) => ({ ...studio.doc, clones });
  return doc.clones.map((clone, k) => ({
    id: `clone-${k}`,
    name: clone.name || text.cloneItem(k + 1),
    note: text.cloneNote(clone.source, clone.targets.length),
    show: () => markVertex(studio, clone.targets[0] ?? clone.source),
    ...entry(doc.clones, k, withClones),
    moved: (by) => {
      const to = k + by;
      if (to < 0 || to >= doc.clones.length) return null;
      const clones = [...doc.clones];
      [clones[k], clones[to]] = [clones[to]!, clones[k]!];
      return withClones(clones);
    },
  }));
}

function poseItems(studio: Studio): Item[] {
  const { pose } = studio.doc;
  if (!pose) return [];
  const withPose = (next: Pose) => {
    const isEmpty = next.handle.length === 0 && !next.fixed;
    return { ...studio.doc, pose: isEmpty ? null : next };
  };
  const handles = pose.handle.map((handle, k): Item => {
    const vertex = vertexOf(handle);
    return {
      id: `handle-${k}`,
      name: handle.name || text.handleItem(k + 1),
      note: text.handleNote(vertex, formatNumber(Math.hypot(...handle.by))),
      show: () => vertex !== null && markVertex(studio, vertex),
      ...entry(pose.handle, k, (handle: PoseHandle[]) => withPose({ ...pose, handle })),
      moved: null,
    };
  });
  if (!pose.fixed) return handles;
  const pins: Item = {
    id: 'pins',
    name: text.pinsItem,
    note: text.pinsNote(pinsOf(pose).length),
    on: pose.pinned !== false,
    show: () => studio.setTool('grab'),
    toggled: () => withPose({ ...pose, pinned: pose.pinned === false }),
    removed: () => withPose({ ...pose, fixed: null }),
    renamed: null,
    moved: null,
  };
  return [pins, ...handles];
}

function turnedItems(studio: Studio): Item[] {
  const { turned } = studio.doc;
  return turned.map((vertex) => ({
    id: `turned-${vertex}`,
    name: text.turnedItem,
    note: text.turnedNote(vertex),
    on: true,
    show: () => markVertex(studio, vertex),
    toggled: null,
    removed: () => ({ ...studio.doc, turned: withTurned(turned, [vertex], false) }),
    renamed: null,
    moved: null,
  }));
}

function fieldItems(studio: Studio): Item[] {
  const { fields } = studio.doc;
  const presets = studio.shape?.presets ?? [];
  const edited = fields.filter((f) => !areNeutral(f.layers) || !isOn(f));
  return edited.map((edit) => {
    const changes = edit.layers.map((layer) => gainSummary(layer, presets)).filter((part) => part !== '');
    return {
      id: `field-${edit.field}`,
      name: text.fieldItem(edit.field),
      note: changes.join('; '),
      on: isOn(edit),
      show: () => studio.showTarget(edit.field),
      toggled: () => ({
        ...studio.doc,
        fields: studio.doc.fields.map((f) => (f.field === edit.field ? { ...f, on: !isOn(f) } : f)),
      }),
      removed: () => ({ ...studio.doc, fields: studio.doc.fields.filter((f) => f.field !== edit.field) }),
      renamed: null,
      moved: null,
    };
  });
}

function markVertex(studio: Studio, vertex: number): void {
  studio.view.showMark(studio.view.arrays.place(vertex));
}

/** Creates a row; `rename` is called on a double click of its name. */
function row(studio: Studio, item: Item, rename: () => void): HTMLElement {
  const { name, on, moved } = item;
  const commit = (doc: Doc | null) => doc && studio.history.commit(doc);
  const eye = item.toggled;
  const choose = h(
    'button',
    {
      type: 'button',
      class: 'name',
      title: item.renamed ? text.renameHint : undefined,
      onclick: item.show,
      ondblclick: item.renamed ? rename : undefined,
    },
    h('span', {}, name),
    h('small', {}, item.note),
  );
  return h(
    'li',
    { class: on ? '' : 'off', 'data-item': item.id },
    eye
      ? iconButton(on ? 'eye' : 'off', on ? text.layerOff(name) : text.layerOn(name), () => commit(eye()), {
          'aria-pressed': String(on),
        })
      : h('span', { class: 'no-eye' }),
    choose,
    moved?.(-1) ? iconButton('up', text.moveUp(name), () => commit(moved(-1))) : null,
    moved?.(1) ? iconButton('down', text.moveDown(name), () => commit(moved(1))) : null,
    iconButton('bin', text.remove(name), () => commit(item.removed())),
  );
}

/** Replaces the name of an item by an input; `done` is called when it is left. */
function renameItem(studio: Studio, list: HTMLElement, item: Item, done: () => void): void {
  const input = h('input', { type: 'text', value: item.name, 'aria-label': text.itemRename(item.name) });
  list.querySelector(`[data-item="${CSS.escape(item.id)}"] .name`)?.replaceWith(input);
  input.select();
  let isCancelled = false;
  input.addEventListener('blur', () => {
    const name = input.value.trim();
    if (!isCancelled && name !== item.name) studio.history.commit(item.renamed!(name));
    done();
  });
  input.addEventListener('keydown', (event) => {
    isCancelled = event.key === 'Escape';
    if (event.key === 'Enter' || isCancelled) input.blur();
  });
}

/** Creates the list; it is hidden while the edit has layers alone. */
export function editList(studio: Studio): HTMLElement {
  const list = h('ul', { class: 'layers', 'aria-label': text.onTop });
  const element = h('div', { class: 'edit-list', hidden: true }, h('h3', {}, text.onTop), list);
  const rebuild = () => {
    const items = studio.shape && !studio.isGrid ? allItems(studio) : [];
    element.hidden = items.length === 0;
    list.replaceChildren(
      ...items.map((item) => row(studio, item, () => renameItem(studio, list, item, rebuild))),
    );
  };
  studio.on(['doc', 'shape', 'levels', 'target'], rebuild);
  return element;
}

function allItems(studio: Studio): Item[] {
  return [...cloneItems(studio), ...poseItems(studio), ...turnedItems(studio), ...fieldItems(studio)];
}
