/** Storage of the undo history over a reload of the page, for as long as the browser keeps the tab. */

import type { Edit, Region, Shape } from './protocol';
import { type Doc, type DocLevels, fromEdit, type History, toEdit } from './state';

/** Largest stored text; browsers give a page about five million characters. */
const MOST = 2_000_000;

interface Stored {
  name: string;
  nVertices: number;
  levels: DocLevels[];
  /** Regions of all documents, which share most of them. */
  regions: Region[];
  /** Past documents, the present one, and those that a redo leads to. */
  docs: { levels: number; edit: Edit; regions: (number | null)[] }[];
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
    const ids = edit.layers.map(({ region }) => {
      if (!region) return null;
      if (!numbers.has(region)) numbers.set(region, regions.push(region) - 1);
      return numbers.get(region)!;
    });
    const layers = edit.layers.map((l) => ({ ...l, region: null }));
    return { levels: levels.indexOf(doc.levels), edit: { ...edit, layers }, regions: ids };
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
  for (const { edit, levels: which, regions } of stored.docs) {
    const layers = edit.layers.map((l, i) => ({
      ...l,
      region: regions[i] === null ? null : stored.regions[regions[i]!]!,
    }));
    const doc = fromEdit({ ...edit, layers }, levels[which]!.sigmas.length, levels[which]!);
    docs.push({ ...doc, layers: doc.layers.map((l, i) => ({ ...l, key: current.layers[i]?.key ?? l.key })) });
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
