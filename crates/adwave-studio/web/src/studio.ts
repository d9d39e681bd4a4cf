/** Shared state of the page: the shape, its document, the worker, the picture and the selection. */

import type { Api } from './api';
import { rangeOf } from './colors';
import type { WorkerEvent } from './compute/messages';
import { DetailTransfer } from './detail-transfer';
import { Display } from './display';
import { effectOf } from './effects';
import { Engine } from './engine';
import { Masks } from './masks';
import type { Region, Shape, ShapeList } from './protocol';
import { Regions } from './regions';
import type { Saver } from './saver';
import { Session } from './session';
import { type Doc, type DocLayer, History, NO_LEVELS, newLayer, withLayer } from './state';
import { text } from './text';
import { Timings } from './timings';
import type { ShownComparison } from './tools';
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
  | 'camera'
  | 'solo'
  | 'theme';

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
      levels: NO_LEVELS,
    },
    () => {},
  );
  saver: Saver | null = null;
  selected = 0;
  readonly loadedBands = new Set<number>();
  /** Displacement from the last computation; replaced by the server's double precision values. */
  displacement: { greatest: number; rms: number; volume: [number, number] | null } | null = null;
  spectrum: number[] = [];
  /** Compared method shown instead of the original. */
  comparison: ShownComparison | null = null;
  isBrushOn = false;
  /** True while the pointer pulls and pins. */
  isGrabOn = false;
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
  /** Camera, shading and colors; set by the panel of the view. */
  shownView: { get: () => ViewMemory; set: (view: ViewMemory) => void } | null = null;
  readonly timings = new Timings();
  readonly engine: Engine;
  readonly regions = new Regions();
  readonly detail = new DetailTransfer(this);
  readonly session = new Session(this);
  readonly display: Display;
  /** True if the mask of the selected layer is tinted; for layers of an effect, which show it, by its own switch. */
  tint = { region: true, effect: false };
  /** Last clicked vertex, the default center of a ball. */
  lastVertex: number | null = null;
  /** Line that is being drawn click by click. */
  lineDrawing: { end: () => void; cancel: () => void } | null = null;
  /** Receives the next clicked vertex instead of the default action. */
  onPickVertex: ((vertex: number) => void) | null = null;
  private readonly listeners = new Map<Topic, (() => void)[]>();
  private readonly masks: Masks;

  constructor(
    readonly api: Api,
    readonly view: View,
    worker: Worker,
    readonly showMessage: (sentence: string, kind?: 'info' | 'error', link?: MessageLink) => void,
  ) {
    this.on('selected', () => {
      if (!this.solo || this.solo.key === this.selected) return;
      this.solo = null;
      this.display.show(true);
      this.emit('solo');
    });
    this.engine = new Engine(worker, (event) => this.handleWorkerEvent(event));
    this.masks = new Masks(view.arrays);
    this.display = new Display(this, this.masks);
  }

  on(topics: Topic | Topic[], listener: () => void): void {
    for (const topic of [topics].flat()) {
      const list = this.listeners.get(topic) ?? [];
      list.push(listener);
      this.listeners.set(topic, list);
    }
  }

  emit(topic: Topic): void {
    for (const listener of this.listeners.get(topic) ?? []) listener();
  }

  get doc(): Doc {
    return this.history.doc;
  }

  get layer(): DocLayer {
    return this.doc.layers.find((l) => l.key === this.selected) ?? this.doc.layers[0]!;
  }

  get nLevels(): number {
    return this.shape?.levels.length ?? 0;
  }

  /** Resets the state that depends on the shape. */
  resetForShape(): void {
    this.masks.reset(this.shape!.n_vertices);
    this.regions.markUnknown();
    this.loadedBands.clear();
    this.displacement = null;
    this.comparison = null;
    this.solo = null;
    this.lastVertex = null;
    this.cloneSource = null;
    this.isPulling = false;
    this.cancelPick();
    this.emit('compared');
  }

  /** Replaces the document and clears the undo history. */
  resetDocument(doc: Doc): void {
    this.history = new History(doc, (committed) => this.handleDocumentChange(committed));
    this.selected = doc.layers[0]!.key;
    this.masks.assignSlots(doc.layers);
    this.updateTint();
    this.emit('doc');
    this.emit('selected');
  }

  private handleWorkerEvent(event: WorkerEvent): void {
    if (event.event === 'band') {
      this.view.arrays.setBand(event.level, event.scale, event.values);
      this.loadedBands.add(event.level);
      const now = performance.now();
      if (this.loadedBands.size === 1) this.timings.records.firstSlider = now;
      if (this.loadedBands.size === this.nLevels) this.timings.records.slidersLive = now;
      this.emit('band');
      return;
    }
    this.masks.updateMask(event.key, event.from, event.bytes);
  }

  /** Handles a change of the document: a step if `committed`, otherwise part of a gesture. */
  private handleDocumentChange(committed: boolean): void {
    if (!this.doc.layers.some((l) => l.key === this.selected)) {
      this.selected = this.doc.layers.at(-1)!.key;
      this.emit('selected');
    }
    this.masks.assignSlots(this.doc.layers);
    this.updateTint();
    this.display.show(committed);
    if (committed) this.saver?.saveStep(this.doc, this.display.waitUntilSettled());
    this.emit('doc');
  }

  get tintKind(): 'region' | 'effect' {
    return effectOf(this.layer) ? 'effect' : 'region';
  }

  updateTint(): void {
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
    this.view.request();
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
    if (!this.history[to]()) this.timings.cancelSliderTiming();
  }

  /** Lets the next click choose the spot from which the brush clones detail. */
  pickCloneSource(): void {
    this.showMessage(text.pickCloneClick);
    this.onPickVertex = (vertex) => {
      this.cloneSource = vertex;
      this.showMessage(text.cloneSourcePicked);
      this.emit('tool');
    };
  }

  /** Ends a pick or a line that waits for a click; returns false if there is none. */
  cancelPick(): boolean {
    const { lineDrawing } = this;
    const waited = lineDrawing !== null || this.onPickVertex !== null;
    this.onPickVertex = null;
    lineDrawing?.cancel();
    return waited;
  }

  /** Shows work that takes a while, with a button that cancels it. Returns `null` if it was cancelled. */
  async wait<T>(what: string, work: (signal: AbortSignal) => Promise<T>): Promise<T | null> {
    const abort = new AbortController();
    const number = ++this.lastWait;
    this.waiting.set(number, { what, cancel: () => abort.abort() });
    this.emit('waiting');
    const cancelled = new Promise<null>((done) => abort.signal.addEventListener('abort', () => done(null)));
    try {
      return await Promise.race([work(abort.signal), cancelled]);
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
    this.view.markMoving();
    this.display.show(true);
    this.emit('solo');
  }

  /** Changes a layer, as one step or as part of a gesture. */
  changeLayer(change: Partial<DocLayer>, step: boolean, key = this.selected): void {
    const doc = withLayer(this.doc, key, change);
    if (step) this.history.commit(doc);
    else this.history.preview(doc);
  }

  addLayer(name: string, region: Region | null, step = true, gains: number[] | null = null): number {
    this.cancelPick();
    const empty = newLayer(name, this.nLevels, region);
    const layer = gains ? { ...empty, gains } : empty;
    const doc = { ...this.doc, layers: [...this.doc.layers, layer] };
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

  setBrush(on: boolean): void {
    this.isBrushOn = on;
    if (on) this.isGrabOn = false;
    this.emit('tool');
  }

  setGrab(on: boolean): void {
    this.isGrabOn = on;
    if (on) this.isBrushOn = false;
    this.emit('tool');
  }

  showSpectrum(spectrum: number[]): void {
    this.spectrum = spectrum;
    this.emit('spectrum');
  }

  /** Range of a field from the 2nd to the 98th percentile. */
  async fieldRange(name: string): Promise<[number, number]> {
    const { values } = await this.api.field(this.shape!.id, name, 'region');
    return rangeOf(values, 'most', false);
  }
}
