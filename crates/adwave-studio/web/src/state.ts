/**
 * The edit as an immutable document: each step creates a new one that shares unchanged parts. Undo is a list of documents.
 * Camera and view settings are not part of it.
 */

import type { Along, Border, Edit, Layer, Region, VolumeRule } from './protocol';

export interface DocLayer extends Layer {
  /** Identifies the layer on this page; not sent to the server. */
  readonly key: number;
}

export interface Doc {
  readonly layers: readonly DocLayer[];
  readonly along: Along | null;
  readonly border: Border | null;
  readonly volume: VolumeRule | null;
}

let lastKey = 0;

export function newKey(): number {
  return ++lastKey;
}

export function fromEdit(edit: Edit, nLevels: number): Doc {
  const layers = edit.layers.map((l) => ({ ...l, key: newKey(), gains: fitGains(l.gains, nLevels) }));
  if (layers.length === 0) layers.push(newLayer('', nLevels));
  return { layers, along: edit.along, border: edit.border, volume: edit.volume };
}

export function toEdit(doc: Doc, revision: number): Edit {
  return {
    revision,
    layers: doc.layers.map(({ name, on, opacity, gains, region }) => ({ name, on, opacity, gains, region })),
    along: doc.along,
    border: doc.border,
    volume: doc.volume,
  };
}

export function newLayer(name: string, nLevels: number, region: Region | null = null): DocLayer {
  return { key: newKey(), name, on: true, opacity: 1, gains: new Array<number>(nLevels).fill(1), region };
}

/** Returns exactly `n` gains, filled up with 1. */
export function fitGains(gains: readonly number[], n: number): number[] {
  return Array.from({ length: n }, (_, j) => gains[j] ?? 1);
}

export function withLayer(doc: Doc, key: number, change: Partial<DocLayer>): Doc {
  return { ...doc, layers: doc.layers.map((l) => (l.key === key ? { ...l, ...change, key } : l)) };
}

export function withGain(doc: Doc, key: number, level: number, gain: number): Doc {
  const layer = doc.layers.find((l) => l.key === key);
  if (!layer || layer.gains[level - 1] === gain) return doc;
  return withLayer(doc, key, { gains: layer.gains.with(level - 1, gain) });
}

/** True if the edit changes nothing. */
export function isNeutral(doc: Doc): boolean {
  return doc.layers.every((l) => !l.on || l.opacity === 0 || l.gains.every((g) => g === 1));
}

/** True if only the server can apply the constraints; the page then shows its positions. */
export function needsServer(doc: Doc, cloud: boolean): boolean {
  return (
    // By default a cloud moves along its normals.
    (doc.along === null ? cloud && !isNeutral(doc) : doc.along !== 'free') ||
    (doc.border !== null && doc.border !== 'natural') ||
    doc.volume === 'keep'
  );
}

export class History {
  doc: Doc;
  private past: Doc[] = [];
  private future: Doc[] = [];
  /** Document before the current gesture, which becomes one step. */
  private start: Doc | null = null;

  constructor(
    doc: Doc,
    private readonly changed: (committed: boolean) => void,
  ) {
    this.doc = doc;
  }

  get canUndo(): boolean {
    return this.past.length > 0 || this.start !== null;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  get nSteps(): number {
    return this.past.length;
  }

  /** Adds one step. */
  commit(doc: Doc): void {
    this.preview(doc);
    this.end();
  }

  /** Adds to the current gesture, which `end` turns into one step. */
  preview(doc: Doc): void {
    if (doc === this.doc) return;
    this.start ??= this.doc;
    this.doc = doc;
    this.changed(false);
  }

  end(): void {
    const start = this.start;
    this.start = null;
    if (!start || start === this.doc) return;
    if (sameEdit(start, this.doc)) return; // the gesture returned to its start: no step
    this.past.push(start);
    this.future = [];
    this.changed(true);
  }

  cancel(): void {
    if (!this.start) return;
    this.doc = this.start;
    this.start = null;
    this.changed(false);
  }

  undo(): boolean {
    this.end();
    const doc = this.past.pop();
    if (!doc) return false;
    this.future.push(this.doc);
    this.doc = doc;
    this.changed(true);
    return true;
  }

  redo(): boolean {
    const doc = this.future.pop();
    if (!doc) return false;
    this.past.push(this.doc);
    this.doc = doc;
    this.changed(true);
    return true;
  }
}

function sameEdit(a: Doc, b: Doc): boolean {
  return (
    a.along === b.along &&
    a.border === b.border &&
    a.volume === b.volume &&
    a.layers.length === b.layers.length &&
    a.layers.every((l, i) => {
      const m = b.layers[i]!;
      return (
        l.key === m.key &&
        l.name === m.name &&
        l.on === m.on &&
        l.opacity === m.opacity &&
        l.region === m.region &&
        l.gains.every((g, j) => g === m.gains[j])
      );
    })
  );
}
