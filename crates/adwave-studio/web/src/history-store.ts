/** Storage of the undo history over a reload of the page, for as long as the browser keeps the tab. */

import type { Edit, Layer, Region, Shape } from './protocol';
import { type Doc, type DocLayer, type DocLevels, fromEdit, type History, layersOf, toEdit } from './state';

/** Largest stored text; browsers give a page about five million characters. */
const MOST = 2_000_000;

interface Stored {
  name: string;
  nVertices: number;
  levels: DocLevels[];
  /** Regions of all documents, which share most of them. */
  regions: Region[];
  /** Past documents, the present one, and those that a redo leads to. */
  docs: { levels: number; edit: Edit; regions: (number | null)[]; fieldRegions: (number | null)[][] }[];
  present: number;
}

function storageKey(id: number): string {
  return `adwave-history-${id}`;
}

/** Stores the latest steps that fit. */
export function storeHistory(shape: Shape, history: History): void {
  const { past, future } = history.documents;
  for (let most = 200; most >= 1; most = Math.floor(most / 2)) {
    const before = past.slice(-most);
    const after = future.slice(-most).reverse();
    const stored = JSON.stringify(pack(shape, [...before, history.doc, ...after], before.length));
    if (stored.length > MOST) continue;
    try {
      sessionStorage.setItem(storageKey(shape.id), stored);
      return;
    } catch {
      // The storage is full: fewer steps may fit.
    }
  }
  sessionStorage.removeItem(storageKey(shape.id));
}

function pack(shape: Shape, docs: readonly Doc[], present: number): Stored {
  const regions: Region[] = [];
  const numbers = new Map<Region, number>();
  const levels: DocLevels[] = [];
  const packed = docs.map((doc) => {
    if (!levels.includes(doc.levels)) levels.push(doc.levels);
    const edit = toEdit(doc, 0);
    const number = ({ region }: Layer) => {
      if (!region) return null;
      if (!numbers.has(region)) numbers.set(region, regions.push(region) - 1);
      return numbers.get(region)!;
    };
    const bare = (list: readonly Layer[]) => list.map((l) => ({ ...l, region: null }));
    const fields = edit.fields ?? [];
    return {
      levels: levels.indexOf(doc.levels),
      edit: {
        ...edit,
        layers: bare(edit.layers),
        fields: fields.map((f) => ({ ...f, layers: bare(f.layers) })),
      },
      regions: edit.layers.map(number),
      fieldRegions: fields.map((f) => f.layers.map(number)),
    };
  });
  return { name: shape.name, nVertices: shape.n_vertices, levels, regions, docs: packed, present };
}

/**
 * Gives the document its stored past and future if the stored present is the same edit. Layers keep their identity from one
 * step to the next by their position, unless their number changes.
 */
export function restoreHistory(shape: Shape, history: History): boolean {
  const text = sessionStorage.getItem(storageKey(shape.id));
  sessionStorage.removeItem(storageKey(shape.id));
  if (!text) return false;
  try {
    const stored = JSON.parse(text) as Stored;
    const docs = unpack(stored, history.doc);
    const present = docs[stored.present];
    const same = (doc: Doc) => canonicalText(toEdit(doc, 0));
    if (stored.name !== shape.name || stored.nVertices !== shape.n_vertices || !present) return false;
    if (same(present) !== same(history.doc)) return false;
    history.restore(docs.slice(0, stored.present), docs.slice(stored.present + 1).reverse());
    return true;
  } catch {
    return false;
  }
}

function unpack(stored: Stored, current: Doc): Doc[] {
  const presentLevels = stored.docs[stored.present]!.levels;
  const levels = stored.levels.map((l, i) => (i === presentLevels ? current.levels : l));
  const docs: Doc[] = [];
  for (const { edit, levels: which, regions, fieldRegions } of stored.docs) {
    const whole = (layers: Layer[], ids: (number | null)[]) =>
      layers.map((l, i) => ({ ...l, region: ids[i] === null ? null : stored.regions[ids[i]!]! }));
    const layers = whole(edit.layers, regions);
    const fields = (edit.fields ?? []).map((f, i) => ({ ...f, layers: whole(f.layers, fieldRegions[i]!) }));
    const doc = fromEdit({ ...edit, layers, fields }, levels[which]!.sigmas.length, levels[which]!);
    const keyed = (own: readonly DocLayer[], as: readonly DocLayer[] | null) =>
      own.map((l, i) => ({ ...l, key: as?.[i]?.key ?? l.key }));
    docs.push({
      ...doc,
      layers: keyed(doc.layers, current.layers),
      fields: doc.fields.map((f) => ({ ...f, layers: keyed(f.layers, layersOf(current, f.field)) })),
    });
  }
  return docs;
}

/** JSON with the keys of objects in their order, and without those of `null`. */
function canonicalText(value: unknown): string {
  return JSON.stringify(value, (_, inner: unknown) => {
    if (!inner || typeof inner !== 'object' || Array.isArray(inner)) return inner;
    const entries = Object.entries(inner).filter(([, v]) => v !== null);
    return Object.fromEntries(entries.sort(([a], [b]) => (a < b ? -1 : 1)));
  });
}
