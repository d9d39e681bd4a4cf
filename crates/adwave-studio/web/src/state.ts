/**
 * The edit as an immutable document: each step creates a new one that shares unchanged parts. Undo is a list of documents.
 * Camera and view settings are not part of it.
 */

import type {
  Along,
  Border,
  DetailClone,
  Edit,
  FieldEdit,
  Layer,
  LevelsChoice,
  Pose,
  Region,
  ReshapedBy,
  VolumeRule,
} from './protocol';

export interface DocLayer extends Layer {
  /** Identifies the layer on this page; not sent to the server. */
  readonly key: number;
}

/** Levels that the gains of a document belong to: the choice that leads to them, and their widths σ. */
export interface DocLevels {
  readonly choice: LevelsChoice;
  readonly sigmas: readonly number[];
}

/** Layers of a field. */
export interface DocField {
  readonly field: string;
  readonly layers: readonly DocLayer[];
  /** False if the edit of the field has no effect. */
  readonly on?: boolean;
}

export interface Doc {
  readonly layers: readonly DocLayer[];
  readonly along: Along | null;
  readonly border: Border | null;
  readonly volume: VolumeRule | null;
  readonly clones: readonly DetailClone[];
  readonly pose: Pose | null;
  /** First vertices of the parts whose faces are turned over, ascending. */
  readonly turned: readonly number[];
  /** Edits of fields; a field without an edit is not listed. */
  readonly fields: readonly DocField[];
  readonly levels: DocLevels;
}

/** Levels of a document without a shape. */
export const NO_LEVELS: DocLevels = { choice: {}, sigmas: [] };
export const NO_CLONES: readonly DetailClone[] = [];
export const NO_TURNED: readonly number[] = [];
export const NO_FIELDS: readonly DocField[] = [];

let lastKey = 0;

export function newKey(): number {
  return ++lastKey;
}

export function fromEdit(edit: Edit, nLevels: number, levels: DocLevels = NO_LEVELS): Doc {
  const layers = keyedLayers(edit.layers, nLevels);
  const { along, border, volume, clones, pose } = edit;
  const fields = (edit.fields ?? []).map((edit) => ({
    ...edit,
    layers: keyedLayers(edit.layers, nLevels),
  }));
  return {
    layers,
    along,
    border,
    volume,
    clones: clones ?? NO_CLONES,
    pose: pose ?? null,
    turned: edit.turned?.length ? edit.turned : NO_TURNED,
    fields: fields.length > 0 ? fields : NO_FIELDS,
    levels,
  };
}

/** Layers of an edit as those of a document, at least one. */
function keyedLayers(layers: readonly Layer[], nLevels: number): DocLayer[] {
  if (layers.length === 0) return [newLayer('', nLevels)];
  return layers.map((l) => ({ ...l, key: newKey(), gains: fitGains(l.gains, nLevels) }));
}

export function toEdit(doc: Doc, revision: number): Edit {
  return {
    revision,
    layers: doc.layers.map(toLayer),
    along: doc.along,
    border: doc.border,
    volume: doc.volume,
    clones: doc.clones,
    pose: doc.pose,
    turned: doc.turned,
    fields: doc.fields.map((edit): FieldEdit => ({ ...edit, layers: edit.layers.map(toLayer) })),
  };
}

function toLayer({ key: _, ...layer }: DocLayer): Layer {
  return layer;
}

/** Layers of the positions (`null`) or of a field; `null` if the field has no edit. */
export function layersOf(doc: Doc, target: string | null): readonly DocLayer[] | null {
  if (target === null) return doc.layers;
  return doc.fields.find(({ field }) => field === target)?.layers ?? null;
}

/** The document with other layers of the positions (`null`) or of a field. */
export function withLayersOf(doc: Doc, target: string | null, layers: readonly DocLayer[]): Doc {
  if (target === null) return { ...doc, layers };
  const known = doc.fields.some(({ field }) => field === target);
  const fields = known
    ? doc.fields.map((f) => (f.field === target ? { ...f, layers } : f))
    : [...doc.fields, { field: target, layers }];
  return { ...doc, fields };
}

/** All layers of a document, those of fields too. */
export function allLayers(doc: Doc): DocLayer[] {
  return [...doc.layers, ...doc.fields.flatMap(({ layers }) => layers)];
}

/** The edit in which two documents differ: of the positions (`null`) or of a field; `undefined` if both or none. */
export function changedTarget(a: Doc, b: Doc): string | null | undefined {
  const fields = new Set([...a.fields, ...b.fields].map(({ field }) => field));
  const changed = [...fields].filter(
    (f) => layersOf(a, f) !== layersOf(b, f) || isFieldOn(a, f) !== isFieldOn(b, f),
  );
  if (samePositions(a, b)) return changed.length === 1 ? changed[0] : undefined;
  return changed.length === 0 ? null : undefined;
}

/** True if two documents lead to the same positions because nothing of them was touched. */
export function samePositions(a: Doc, b: Doc): boolean {
  return (
    a.layers === b.layers &&
    a.along === b.along &&
    a.border === b.border &&
    a.volume === b.volume &&
    a.clones === b.clones &&
    a.pose === b.pose &&
    a.turned === b.turned &&
    a.levels === b.levels
  );
}

export function newLayer(name: string, nLevels: number, region: Region | null = null): DocLayer {
  return { key: newKey(), name, on: true, opacity: 1, gains: new Array<number>(nLevels).fill(1), region };
}

/** Returns exactly `n` gains, filled up with 1. */
export function fitGains(gains: readonly number[], n: number): number[] {
  return Array.from({ length: n }, (_, j) => gains[j] ?? 1);
}

/**
 * Gains for levels of other widths σ, increasing: the mean of the old gains over the octaves that a new band covers. Detail
 * coarser than all old bands keeps the gain 1. The server maps the stored edit in the same way.
 */
export function mapGains(
  gains: readonly number[],
  before: readonly number[],
  after: readonly number[],
): number[] {
  const finest = Math.min(...before, ...after) / 2;
  // The range of widths of each band, in octaves.
  const ranges = (widths: readonly number[]) => {
    const ends = widths.map((w) => Math.log2(w / finest));
    return ends.map((end, j) => [j ? ends[j - 1]! : 0, end] as const);
  };
  const old = ranges(before);
  return ranges(after).map(([start, end]) => {
    const covered = old
      .map(([low, high], j) => ({ share: Math.min(end, high) - Math.max(start, low), gain: gains[j] ?? 1 }))
      .concat({ share: end - Math.max(start, old.at(-1)?.[1] ?? 0), gain: 1 })
      .filter(({ share }) => share > 1e-6);
    const first = covered[0]?.gain ?? 1;
    if (covered.every(({ gain }) => gain === first)) return first;
    const total = covered.reduce((sum, { share }) => sum + share, 0);
    return covered.reduce((sum, { share, gain }) => sum + share * gain, 0) / total;
  });
}

/** The document with the gains of other levels. */
export function withLevels(doc: Doc, levels: DocLevels): Doc {
  const map = (gains: readonly number[]) => mapGains(gains, doc.levels.sigmas, levels.sigmas);
  const mapAll = (layers: readonly DocLayer[]) => layers.map((l) => ({ ...l, gains: map(l.gains) }));
  const fields = doc.fields.map((edit) => ({ ...edit, layers: mapAll(edit.layers) }));
  return { ...doc, levels, layers: mapAll(doc.layers), fields: fields.length > 0 ? fields : NO_FIELDS };
}

/** The layers with only one band of one of them, for listening to it; the document keeps its gains. */
export function soloLayers(
  layers: readonly DocLayer[],
  solo: { key: number; level: number } | null,
): readonly DocLayer[] {
  if (!solo) return layers;
  return layers.map((l) =>
    l.key === solo.key ? { ...l, gains: l.gains.map((g, j) => (j === solo.level - 1 ? g || 1 : 0)) } : l,
  );
}

/** The document with a change of one layer, of the positions or of a field. */
export function withLayer(doc: Doc, key: number, change: Partial<DocLayer>): Doc {
  const changed = (layers: readonly DocLayer[]) =>
    layers.map((l) => (l.key === key ? { ...l, ...change, key } : l));
  const owner = doc.fields.find(({ layers }) => layers.some((l) => l.key === key));
  if (owner) return withLayersOf(doc, owner.field, changed(owner.layers));
  return { ...doc, layers: changed(doc.layers) };
}

export function withGain(doc: Doc, key: number, level: number, gain: number): Doc {
  const layer = allLayers(doc).find((l) => l.key === key);
  if (!layer || layer.gains[level - 1] === gain) return doc;
  return withLayer(doc, key, { gains: layer.gains.with(level - 1, gain) });
}

/** True if the edit changes nothing. */
export function isNeutral(doc: Doc): boolean {
  return reshapedBy(doc) === null && doc.turned.length === 0 && hasNeutralLayers(doc);
}

/** The document without an edit of positions, for a graph that has none. */
export function withoutPositions(doc: Doc): Doc {
  const { layers, clones, pose, turned } = doc;
  if (areNeutral(layers) && clones.length === 0 && pose === null && turned.length === 0) return doc;
  const neutral = layers.map((layer) => ({ ...layer, gains: layer.gains.map(() => 1) }));
  return { ...doc, layers: neutral, clones: clones.length > 0 ? [] : clones, pose: null, turned: NO_TURNED };
}

/** Clones and handles of the edit; `null` if there are none. */
export function reshapedBy(doc: Pick<Doc, 'clones' | 'pose'>): ReshapedBy | null {
  const clones = activeClones(doc.clones);
  const pose = doc.pose && activePose(doc.pose);
  const bending = pose && pose.handle.length > 0 ? pose : null;
  return bending || clones.length > 0 ? { clones, pose: bending } : null;
}

/** A function of an immutable value that gives the same object for the same value. */
function remembered<T extends object, R>(compute: (value: T) => R): (value: T) => R {
  const known = new WeakMap<T, R>();
  return (value) => {
    if (!known.has(value)) known.set(value, compute(value));
    return known.get(value)!;
  };
}

/** Clones that are on, without their names. */
const activeClones = remembered((clones: readonly DetailClone[]): readonly DetailClone[] =>
  clones.filter(isOn).map(({ name: _, on: __, ...clone }) => clone),
);

/** The pose of the handles and pins that are on, without names. */
const activePose = remembered(({ pinned, ...pose }: Pose): Pose => {
  const handle = pose.handle.filter(isOn).map(({ name: _, on: __, ...one }) => one);
  return { ...pose, fixed: pinned === false ? null : (pose.fixed ?? null), handle };
});

/** True for what has an effect. */
export function isOn({ on }: { on?: boolean }): boolean {
  return on !== false;
}

export function sameReshape(a: ReshapedBy | null, b: ReshapedBy | null): boolean {
  return a === b || (a !== null && b !== null && a.clones === b.clones && a.pose === b.pose);
}

function hasNeutralLayers(doc: Doc): boolean {
  return areNeutral(doc.layers);
}

/** True if layers change nothing. */
export function areNeutral(layers: readonly DocLayer[]): boolean {
  return layers.every((l) => !l.on || l.opacity === 0 || l.gains.every((g) => g === 1));
}

/**
 * True if only the server can apply the constraints; the page then shows its positions. By default a cloud moves along its
 * normals, and so do the parts of a surface that have a border.
 */
export function needsServer(doc: Doc, { kind, closed }: { kind: string; closed: boolean }): boolean {
  if (hasNeutralLayers(doc)) return false;
  const cloud = kind === 'cloud';
  const along = doc.along ?? (cloud ? 'normal' : 'free');
  const border = doc.border ?? 'natural';
  const treatsBorder =
    !cloud && !closed && (border === 'keep' || (border === 'natural' && doc.along === null));
  return along !== 'free' || treatsBorder || doc.volume === 'keep';
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
    /** Takes from a document what the shape cannot have. */
    private readonly permitted: (doc: Doc) => Doc = (doc) => doc,
  ) {
    this.doc = doc;
  }

  get canUndo(): boolean {
    return this.past.length > 0 || this.start !== null;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** Document that `undo` or `redo` would lead to. */
  peek(which: 'undo' | 'redo'): Doc | null {
    if (which === 'redo') return this.future.at(-1) ?? null;
    return this.start ?? this.past.at(-1) ?? null;
  }

  /** All documents: past ones, the present one, and those that `redo` leads to, in their order. */
  get documents(): { past: readonly Doc[]; future: readonly Doc[] } {
    return { past: this.past, future: this.future };
  }

  /** Continues the history of an earlier visit. */
  restore(past: readonly Doc[], future: readonly Doc[]): void {
    this.past = [...past];
    this.future = [...future];
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
  preview(wanted: Doc): void {
    const doc = wanted === this.doc ? wanted : this.permitted(wanted);
    if (doc === this.doc) return;
    this.start ??= this.doc;
    this.doc = doc;
    this.changed(false);
  }

  end(): void {
    const start = this.start;
    this.start = null;
    if (!start || start === this.doc) return;
    if (sameEdit(start, this.doc)) {
      // The gesture returned to its start: no step.
      this.doc = start;
      this.changed(false);
      return;
    }
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
    a.clones === b.clones &&
    a.pose === b.pose &&
    a.turned.length === b.turned.length &&
    a.turned.every((vertex, i) => vertex === b.turned[i]) &&
    a.levels === b.levels &&
    sameLayers(a.layers, b.layers) &&
    sameFields(a, b)
  );
}

/** True if the fields have equal edits; one that changes nothing is as good as none. */
function sameFields(a: Doc, b: Doc): boolean {
  return [...a.fields, ...b.fields].every(({ field }) => {
    const [p, q] = [layersOf(a, field) ?? [], layersOf(b, field) ?? []];
    const isSameEye = isFieldOn(a, field) === isFieldOn(b, field);
    return (sameLayers(p, q) && isSameEye) || (isBlank(p) && isBlank(q));
  });
}

/** True if the edit of a field has an effect, or there is none. */
export function isFieldOn(doc: Doc, field: string): boolean {
  return isOn(doc.fields.find((f) => f.field === field) ?? {});
}

/** True for no layers, and for a single one as it is made for a new edit. */
function isBlank(layers: readonly DocLayer[]): boolean {
  return (
    layers.length === 0 ||
    (layers.length === 1 && !layers[0]!.name && !layers[0]!.region && areNeutral(layers))
  );
}

function sameLayers(a: readonly DocLayer[], b: readonly DocLayer[]): boolean {
  return (
    a.length === b.length &&
    a.every((l, i) => {
      const m = b[i]!;
      return (
        l.key === m.key &&
        l.name === m.name &&
        l.on === m.on &&
        l.opacity === m.opacity &&
        l.region === m.region &&
        l.preset === m.preset &&
        l.gains.every((g, j) => g === m.gains[j])
      );
    })
  );
}
