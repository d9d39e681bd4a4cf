/** Shared state of the page: the shape, its document, the worker, the picture and the selection. */

import type { Api } from './api';
import { Beside } from './beside';
import { hasValues, rangeOf } from './colors';
import type { WorkerEvent } from './compute/messages';
import { DetailTransfer } from './detail-transfer';
import { Display } from './display';
import { effectOf } from './effects';
import { Engine } from './engine';
import { FieldEditor, keysOf } from './field-editor';
import { GridView } from './grid/grid-view';
import { formatCount } from './lengths';
import { Masks } from './masks';
import type { Region, Shape, ShapeList } from './protocol';
import { Regions } from './regions';
import type { Saver } from './saver';
import { Session } from './session';
import {
  allLayers,
  changedTarget,
  type Doc,
  type DocLayer,
  History,
  layersOf,
  NO_FIELDS,
  NO_LEVELS,
  NO_TURNED,
  newKey,
  newLayer,
  samePositions,
  withGain,
  withLayer,
  withLayersOf,
  withoutPositions,
} from './state';
import { text } from './text';
import { Timings } from './timings';
import type { ShownComparison } from './tools';
import { TurnedParts } from './turned-parts';
import type { View } from './view';
import type { ViewMemory } from './view-memory';

export type Topic =
  | 'shape'
  | 'shapes'
  | 'levels'
  | 'band'
  | 'doc'
  | 'selected'
  | 'moved'
  | 'saving'
  | 'spectrum'
  | 'tool'
  | 'before'
  | 'compared'
  | 'drawing'
  | 'waiting'
  | 'fields'
  | 'target'
  | 'fieldEdited'
  | 'tint'
  | 'beside'
  | 'camera'
  | 'solo'
  | 'turned'
  | 'theme';

export type PointerTool = 'look' | 'brush' | 'grab';

/** Shows the document: the picture of a shape, or the panes of an image or a volume. */
export interface Shown {
  /** Shows the present document, after a step or during a gesture. */
  show(step: boolean): void;
  /** Shows what is soloed or edited now. */
  showTarget(step: boolean): void;
  settle(): void;
  waitUntilSettled(): Promise<void>;
  readonly isCurrent: boolean;
}

/** A link at the end of a message. */
export interface MessageLink {
  label: string;
  onclick: () => void;
}

export class Studio {
  shape: Shape | null = null;
  shapes: ShapeList = { version: '', shapes: [] };
  history = new History(
    {
      layers: [newLayer('', 0)],
      along: null,
      border: null,
      volume: null,
      clones: [],
      pose: null,
      turned: NO_TURNED,
      fields: NO_FIELDS,
      levels: NO_LEVELS,
    },
    () => {},
  );
  saver: Saver | null = null;
  selected = 0;
  /** Field that the equalizer edits; `null` for the positions. Part of the view. */
  target: string | null = null;
  /** Field that colors the shape and can be edited. */
  shownField: string | null = null;
  /** Keys of the layers of fields that have no edit yet. */
  private readonly blankKeys = new Map<string, number>();
  /** Document that was handled last. */
  private lastDoc: Doc | null = null;
  readonly loadedBands = new Set<number>();
  /** False until the picture shows an edit that was restored, or whose bands were replaced. */
  isEditShown = true;
  /** Displacement from the last computation; replaced by the server's double precision values. */
  displacement: { greatest: number; rms: number; volume: [number, number] | null } | null = null;
  spectrum: number[] = [];
  /** Compared method shown instead of the original. */
  comparison: ShownComparison | null = null;
  /** Action of the pointer on the picture: to turn it and read out places, to paint, or to pull and pin. */
  tool: PointerTool = 'look';
  /** Vertex from which the brush clones detail. */
  cloneSource: number | null = null;
  /** True while a handle is pulled or detail is cloned. */
  isPulling = false;
  /** The only band of a layer that is shown; part of the view and not of the edit. */
  solo: { key: number; level: number } | null = null;
  /** Work that the user waits for, by number, in the order of its start. */
  readonly waiting = new Map<number, { what: string; cancel: () => void }>();
  private lastWait = 0;
  /** Colors the shape by a field of the server; set by the view. */
  showField: (name: string) => void = () => {};
  /** Chooses an entry of the list of colors; set by the view. */
  showColors: (name: string) => void = () => {};
  /** Shows the parts of the page for shapes, or those for images and volumes; set by the page. */
  showDomain: () => void = () => {};
  /** Changes between light and dark; set by the bar. */
  toggleTheme: () => void = () => {};
  /** Camera, shading and colors; set by the panel of the view. */
  shownView: { get: () => ViewMemory; set: (view: ViewMemory) => void } | null = null;
  readonly timings = new Timings();
  readonly engine: Engine;
  readonly regions = new Regions();
  readonly detail = new DetailTransfer(this);
  readonly session = new Session(this);
  readonly shapeDisplay: Display;
  /** Panes of images and volumes. */
  readonly gridView: GridView;
  readonly fieldEditor = new FieldEditor(this);
  readonly beside: Beside;
  readonly turnedParts = new TurnedParts(this);
  /** True if the mask of the selected layer is tinted; for layers of an effect, which show it, by its own switch. */
  tint = { region: true, effect: false };
  /** Last clicked vertex, the default center of a ball. */
  lastVertex: number | null = null;
  /** Line that is being drawn click by click. */
  lineDrawing: { end: () => void; cancel: () => void } | null = null;
  /** Receives the next clicked vertex instead of the default action. */
  private picked: ((vertex: number) => void) | null = null;
  private withdrawRequest = () => {};
  private readonly listeners = new Map<Topic, { listener: () => void; forShapes: boolean }[]>();
  private registersForShapes = false;
  readonly masks: Masks;

  constructor(
    readonly api: Api,
    readonly view: View,
    worker: Worker,
    /** Shows a message, and returns the function that takes it back. A request has no end of its own. */
    readonly showMessage: (
      sentence: string,
      kind?: 'info' | 'error' | 'request',
      link?: MessageLink,
    ) => () => void,
  ) {
    this.on('selected', () => {
      if (!this.solo || this.solo.key === this.selected) return;
      this.solo = null;
      this.display.showTarget(true);
      this.emit('solo');
    });
    this.engine = new Engine(worker, (event) => this.handleWorkerEvent(event));
    this.masks = new Masks(view.arrays);
    this.shapeDisplay = new Display(this, this.masks);
    this.gridView = new GridView(this);
    this.beside = new Beside(this);
  }

  on(topics: Topic | Topic[], listener: () => void): void {
    for (const topic of [topics].flat()) {
      const list = this.listeners.get(topic) ?? [];
      list.push({ listener, forShapes: this.registersForShapes });
      this.listeners.set(topic, list);
    }
  }

  /** Builds a part of the page for shapes: its listeners are not called while an image or a volume is open. */
  forShapes<T>(build: () => T): T {
    this.registersForShapes = true;
    try {
      return build();
    } finally {
      this.registersForShapes = false;
    }
  }

  emit(topic: Topic): void {
    for (const { listener, forShapes } of this.listeners.get(topic) ?? [])
      if (!forShapes || !this.isGrid) listener();
  }

  /** True while an image or a volume is open. */
  get isGrid(): boolean {
    return this.shape?.grid !== undefined;
  }

  get display(): Shown {
    return this.isGrid ? this.gridView : this.shapeDisplay;
  }

  /** Draws the picture of a shape with less detail for a moment, because it moves. */
  markMoving(): void {
    if (!this.isGrid) this.view.markMoving();
  }

  get isBrushOn(): boolean {
    return this.tool === 'brush';
  }

  get isGrabOn(): boolean {
    return this.tool === 'grab';
  }

  get doc(): Doc {
    return this.history.doc;
  }

  /** Layers of the positions or of the field that is edited, at least one. */
  get layers(): readonly DocLayer[] {
    return this.layersIn(this.doc);
  }

  private layersIn(doc: Doc): readonly DocLayer[] {
    const { target } = this;
    const layers = layersOf(doc, target);
    if (layers && layers.length > 0) return layers;
    const key = this.blankKeys.get(target ?? '') ?? newKey();
    this.blankKeys.set(target ?? '', key);
    return [{ ...newLayer('', this.nLevels), key }];
  }

  get layer(): DocLayer {
    return this.layers.find((l) => l.key === this.selected) ?? this.layers[0]!;
  }

  /** The layer of that key, of the positions or of any field. */
  findLayer(key: number): DocLayer | undefined {
    return this.layers.find((l) => l.key === key) ?? allLayers(this.doc).find((l) => l.key === key);
  }

  /** The document in which a field that is edited for the first time has its layer. */
  private get docWithTarget(): Doc {
    const { doc, target } = this;
    return layersOf(doc, target) ? doc : withLayersOf(doc, target, this.layers);
  }

  /** The document with other layers of what is edited. */
  withLayers(layers: readonly DocLayer[]): Doc {
    return withLayersOf(this.doc, this.target, layers);
  }

  /** A document with another gain of the selected layer; `doc` is the present one or one made from it. */
  withGain(level: number, gain: number, doc = this.doc): Doc {
    if (this.layer.gains[level - 1] === gain && doc === this.doc) return doc;
    const whole = doc === this.doc ? this.docWithTarget : doc;
    return withGain(whole, this.layer.key, level, gain);
  }

  /** Keys of the layers whose masks are kept. */
  keptKeys(doc: Doc): number[] {
    return [...keysOf(doc), ...this.layers.map((l) => l.key)];
  }

  /** True if the band of a level is loaded, of the positions or of the field that is edited. */
  isBandReady(level: number): boolean {
    if (this.target === null)
      return this.isEditShown && this.loadedBands.has(level) && !this.shape?.graph?.placed;
    return this.fieldEditor.loaded === this.target;
  }

  /** Edits a field, or the positions (`null`), from now on. */
  async setTarget(target: string | null): Promise<void> {
    if (target === this.target) return;
    this.cancelPick();
    this.target = target;
    this.solo = null;
    this.showSpectrum([]);
    this.selected = this.layers[0]!.key;
    this.masks.assignSlots(this.slottedLayers);
    this.updateTint();
    for (const topic of ['target', 'selected', 'band', 'solo'] as const) this.emit(topic);
    if (target === null) {
      this.fieldEditor.drop();
      // Bands that were soloed or masks that changed meanwhile.
      this.display.settle();
      return;
    }
    await this.loadTarget();
  }

  /** Loads the bands of the field that is edited; returns to the positions if there are none. */
  async loadTarget(): Promise<void> {
    const { target } = this;
    if (target === null) return;
    let isLoaded = false;
    try {
      isLoaded = await this.fieldEditor.load(target);
    } catch (error) {
      this.showMessage((error as Error).message, 'error');
    }
    if (!isLoaded && this.target === target && this.fieldEditor.loaded === null) await this.setTarget(null);
  }

  /** Layers whose masks the shader gets, those of what is edited first. */
  private get slottedLayers(): DocLayer[] {
    return this.target === null ? [...this.doc.layers] : [...this.layers, ...this.doc.layers];
  }

  get nLevels(): number {
    return this.shape?.levels.length ?? 0;
  }

  /** Resets the state that depends on the shape. */
  resetForShape(): void {
    this.masks.reset(this.isGrid ? 0 : this.shape!.n_vertices);
    this.regions.markUnknown();
    this.loadedBands.clear();
    this.displacement = null;
    this.comparison = null;
    this.solo = null;
    this.lastVertex = null;
    this.cloneSource = null;
    this.isPulling = false;
    this.target = null;
    this.shownField = null;
    this.blankKeys.clear();
    this.fieldEditor.close();
    this.cancelPick();
    this.emit('compared');
    this.emit('target');
  }

  /** Replaces the document and clears the undo history. */
  resetDocument(doc: Doc): void {
    this.history = new History(
      doc,
      (committed) => this.handleDocumentChange(committed),
      this.shape?.graph?.placed ? withoutPositions : undefined,
    );
    this.lastDoc = doc;
    this.selected = this.layers[0]!.key;
    this.masks.assignSlots(this.slottedLayers);
    this.updateTint();
    void this.showTurned();
    this.emit('doc');
    this.emit('selected');
  }

  private handleWorkerEvent(event: WorkerEvent): void {
    if (event.event === 'band') {
      this.view.arrays.setBand(event.level, event.scale, event.values);
      this.loadedBands.add(event.level);
      const now = performance.now();
      if (this.loadedBands.size === 1) this.timings.records.firstSlider = now;
      if (this.loadedBands.size === this.nLevels && this.isEditShown) this.timings.records.slidersLive = now;
      this.emit('band');
      return;
    }
    this.masks.updateMask(event.key, event.from, event.bytes);
  }

  /** Handles a change of the document: a step if `committed`, otherwise part of a gesture. */
  private handleDocumentChange(committed: boolean): void {
    const before = this.lastDoc;
    this.lastDoc = this.doc;
    if (!this.layers.some((l) => l.key === this.selected)) {
      this.selected = this.layers.at(-1)!.key;
      this.emit('selected');
    }
    this.masks.assignSlots(this.slottedLayers);
    this.updateTint();
    // An edit of a field leaves the positions as they are.
    if (this.target !== null) this.fieldEditor.show();
    if (this.target === null || !before || !samePositions(before, this.doc)) this.display.show(committed);
    void this.showTurned();
    if (committed) this.saver?.saveStep(this.doc, this.display.waitUntilSettled());
    this.emit('doc');
  }

  /** Shows the faces of the parts that the edit turns. */
  private async showTurned(): Promise<void> {
    try {
      await this.turnedParts.show();
    } catch (error) {
      this.showMessage((error as Error).message, 'error');
    }
  }

  get tintKind(): 'region' | 'effect' {
    return effectOf(this.layer) ? 'effect' : 'region';
  }

  updateTint(): void {
    if (this.isGrid) return;
    const slot = this.masks.slot(this.selected);
    // Comparisons are shown without tint.
    this.view.setTint(this.tint[this.tintKind] && slot >= 0 && !this.comparison ? slot : null);
  }

  select(key: number): void {
    // A pick belongs to the layer for which it was started.
    if (key !== this.selected) this.cancelPick();
    this.selected = key;
    this.updateTint();
    this.emit('selected');
  }

  setBefore(on: boolean): void {
    if (this.view.showsOriginal === on) return;
    this.view.showsOriginal = on;
    if (!this.isGrid) this.view.request();
    this.emit('before');
  }

  undo(): void {
    this.step('undo');
  }

  redo(): void {
    this.step('redo');
  }

  private step(to: 'undo' | 'redo'): void {
    if (this.waiting.size > 0) return;
    const next = this.history.peek(to);
    if (!next) return;
    this.cancelPick();
    if (next.levels !== this.doc.levels) {
      void this.session.stepOverLevels(to).catch((e: Error) => this.showMessage(e.message, 'error'));
      return;
    }
    this.timings.startSliderTiming();
    const changed = changedTarget(this.doc, next);
    if (!this.history[to]()) this.timings.cancelSliderTiming();
    // The step is shown where it acts.
    else if (changed !== undefined && changed !== this.target) this.showTarget(changed);
  }

  /** Edits the first field of the file. */
  showFirstField(): void {
    const field = this.shape?.fields.find((f) => f.editable);
    if (field) this.showTarget(field.name);
  }

  /** Edits a field and colors the shape by it, or edits the positions (`null`). */
  showTarget(target: string | null): void {
    if (target !== null && target !== this.shownField) {
      if (!this.shape?.fields.some((f) => f.name === target && f.editable)) return;
      this.showField(target);
    }
    void this.setTarget(target);
  }

  /** Lets the next click choose the spot from which the brush clones detail. */
  pickCloneSource(): void {
    this.requestVertex(text.pickCloneClick, (vertex) => {
      this.cloneSource = vertex;
      this.emit('tool');
      this.showMessage(text.cloneSourcePicked);
    });
  }

  get onPickVertex(): ((vertex: number) => void) | null {
    return this.picked;
  }

  set onPickVertex(next: ((vertex: number) => void) | null) {
    this.withdrawRequest();
    this.picked = next;
    this.view.canvas.classList.toggle('picking', next !== null);
  }

  /** Asks for a click on a vertex; the request stays until there is one, or the pick is cancelled. */
  requestVertex(sentence: string, next: (vertex: number) => void): void {
    this.onPickVertex = next;
    this.withdrawRequest = this.showMessage(sentence, 'request');
  }

  /** Ends a pick or a line that waits for a click; returns false if there is none. */
  cancelPick(): boolean {
    const { lineDrawing } = this;
    const waited = lineDrawing !== null || this.onPickVertex !== null;
    this.onPickVertex = null;
    lineDrawing?.cancel();
    return waited;
  }

  /**
   * Shows work that takes a while, with a button that cancels it; `tell` changes the sentence that is shown. Returns
   * `null` if it was cancelled.
   */
  async wait<T>(
    what: string,
    work: (signal: AbortSignal, tell: (what: string) => void) => Promise<T>,
  ): Promise<T | null> {
    const abort = new AbortController();
    const number = ++this.lastWait;
    this.waiting.set(number, { what, cancel: () => abort.abort() });
    this.emit('waiting');
    const tell = (what: string) => {
      const waiting = this.waiting.get(number);
      if (!waiting) return;
      waiting.what = what;
      this.emit('waiting');
    };
    const cancelled = new Promise<null>((done) => abort.signal.addEventListener('abort', () => done(null)));
    try {
      return await Promise.race([work(abort.signal, tell), cancelled]);
    } catch (error) {
      if (abort.signal.aborted) return null;
      throw error;
    } finally {
      this.waiting.delete(number);
      this.emit('waiting');
    }
  }

  /** Shows one band alone; all again if it is the one that is shown. */
  setSolo(level: number): void {
    const { solo, selected: key } = this;
    this.solo = solo?.key === key && solo.level === level ? null : { key, level };
    this.markMoving();
    this.display.showTarget(true);
    this.emit('solo');
  }

  /** Changes a layer, as one step or as part of a gesture. */
  changeLayer(change: Partial<DocLayer>, step: boolean, key = this.selected): void {
    const doc = withLayer(this.docWithTarget, key, change);
    if (step) this.history.commit(doc);
    else this.history.preview(doc);
  }

  addLayer(name: string, region: Region | null, step = true, gains: number[] | null = null): number {
    this.cancelPick();
    const empty = newLayer(name, this.nLevels, region);
    const layer = gains ? { ...empty, gains } : empty;
    const doc = this.withLayers([...this.layers, layer]);
    this.selected = layer.key;
    if (step) this.history.commit(doc);
    else this.history.preview(doc);
    this.select(layer.key);
    return layer.key;
  }

  /** Prepares the mask of a layer in the worker for painting; `smoothing` is the blur length of a softening stroke. */
  async showMask(layer: DocLayer, smoothing: number | null): Promise<void> {
    if (!layer.region) return;
    const { updates, ids } = this.regions.updatesFor([layer.region]);
    try {
      await this.engine.call('mask', { key: layer.key, id: ids[0]!, regions: updates, smoothing });
    } catch (error) {
      this.regions.markUnknown(updates);
      throw error;
    }
  }

  setTool(tool: PointerTool): void {
    this.tool = tool;
    this.emit('tool');
  }

  showSpectrum(spectrum: number[]): void {
    this.spectrum = spectrum;
    this.emit('spectrum');
  }

  /** Range of a field from the 2nd to the 98th percentile. */
  async fieldRange(name: string): Promise<[number, number]> {
    const { values } = await this.api.field(this.shape!.id, name, 'region');
    if (!hasValues(values)) throw new Error(text.emptyField(name));
    const nMissing = values.reduce((n, x) => n + Number(Number.isNaN(x)), 0);
    if (nMissing > 0) this.showMessage(text.outsideField(name, formatCount(nMissing)));
    return rangeOf(values, 'most', false);
  }
}
