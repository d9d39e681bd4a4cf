/** What the parts of the page share: the shape, its document, the worker, the picture, and what is selected. */

import type { Api } from './api';
import type { Early } from './boot';
import { rangeOf } from './colours';
import { coarseTriangles } from './compute/coarse';
import type { EditAnswer, News, WorkerLayer } from './compute/messages';
import { globalGains } from './compute/positions';
import { Detail } from './detail';
import { Engine } from './engine';
import { Masks } from './masks';
import type { Edit, Level, Moved, Region, Shape, ShapeList } from './protocol';
import { Regions } from './regions';
import { keptAfterReload, Saver } from './saver';
import { type Doc, type DocLayer, fromEdit, History, isNeutral, newLayer, withLayer } from './state';
import { text } from './text';
import type { Compared } from './tools';
import type { View } from './view';
import { Watch } from './watch';

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
  | 'theme';

/** Milliseconds of rest after which positions and normals are computed exactly on shapes that are large. */
const REST = 120;
/** Triangles of a large shape while it moves. */
const COARSE = 45_000;
/** Triangles of a shape that is first drawn with fewer. */
const COARSE_FIRST = 200_000;

export class Studio {
  shape: Shape | null = null;
  shapes: ShapeList = { version: '', shapes: [] };
  history = new History({ layers: [newLayer('', 0)], along: null, border: null, volume: null }, () => {});
  saver: Saver | null = null;
  selected = 0;
  readonly arrived = new Set<number>();
  /** What the last computation said, until the server says it in double precision. */
  moved: { greatest: number; rms: number; volume: [number, number] | null } | null = null;
  spectrum: number[] = [];
  /** What stands in place of the shape as it was opened. */
  compared: Compared | null = null;
  brushOn = false;
  readonly watch = new Watch();
  readonly engine: Engine;
  readonly regions = new Regions();
  readonly detail = new Detail(this);
  /** Whether the mask of the selected layer is shown as a tint. */
  tint = true;
  private readonly listeners = new Map<Topic, (() => void)[]>();
  private readonly masks: Masks;
  private settling = false;
  private settleAgain = false;
  private restTimer = 0;
  private generation = 0;
  private settledWaiters: (() => void)[] = [];
  private shownDoc: Doc | null = null;
  private problem: string | null = null;

  constructor(
    readonly api: Api,
    readonly view: View,
    worker: Worker,
    readonly say: (sentence: string, kind?: 'info' | 'error') => void,
  ) {
    this.engine = new Engine(worker, (news) => this.hear(news));
    this.masks = new Masks(view);
    view.drawn = (began) => this.watch.frameDrawn(began, this.shownDoc === this.doc, () => view.finish());
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

  /** Opens a shape of the server: its picture first, then its bands, coarse to fine. */
  async open(early: Early): Promise<void> {
    const generation = ++this.generation;
    this.saver?.close();
    const [shape, positions, triangles] = await Promise.all([early.shape, early.positions, early.triangles]);
    if (generation !== this.generation) return;
    if (positions.length === 0) throw new Error(text.noPositions(shape.name));
    this.shape = shape;
    sessionStorage.setItem('adwave-shape', String(shape.id));
    const cloud = triangles.length === 0;
    this.view.setShape(positions, triangles, cloud, shape.mean_length || shape.diagonal / 100);
    const coarsen = () => this.view.setCoarse(coarseTriangles(positions, triangles, COARSE));
    const few = this.view.heavy && shape.n_triangles > COARSE_FIRST;
    if (few) {
      // Fewer triangles are there sooner; all of them follow when the page is at rest.
      coarsen();
      this.view.touch();
    }
    this.view.draw();
    if (!this.watch.timings.firstPixels) {
      this.view.finish();
      this.watch.timings.firstPixels = performance.now();
    }
    this.masks.begin(shape.n_vertices);
    this.regions.forget();
    this.arrived.clear();
    this.moved = null;
    this.compared = null;
    this.emit('compared');
    this.view.setLevels(shape.levels.length);
    const normals = this.engine.call('shape', {
      url: `${this.api.root}api/shapes/${shape.id}/`,
      token: this.api.token,
      n: shape.n_vertices,
      centre: shape.centre,
      diagonal: shape.diagonal,
      meanLength: shape.mean_length || shape.diagonal / 100,
      cloud,
      positions,
      triangles,
    });
    const bands = this.readBands(generation);
    const edit = await keptAfterReload(this.api, shape.id);
    if (generation !== this.generation) return;
    this.begin(fromEdit(edit, shape.levels.length), edit.revision);
    this.emit('shape');
    this.emit('levels');
    void normals.then(({ normals }) => {
      if (generation === this.generation) this.view.setNormals(normals);
    });
    await bands;
    if (generation !== this.generation) return;
    // Until then the worker sums what a slider moves.
    if (this.view.heavy && !few) coarsen();
    if (!isNeutral(this.doc)) this.settle();
    void this.engine.call('warm', {});
  }

  /** A document from the server becomes the present one, without a past. */
  private begin(doc: Doc, revision: number): void {
    this.history = new History(doc, (committed) => this.changed(committed));
    this.selected = doc.layers[0]!.key;
    this.saver?.leave();
    this.saver = new Saver(this.api, this.shape!.id, revision, (moved) => this.heardServer(moved));
    this.masks.take(doc.layers);
    this.updateTint();
    this.emit('doc');
    this.emit('selected');
    this.emit('saving');
  }

  private async readBands(generation: number): Promise<void> {
    const shared = crossOriginIsolated && typeof SharedArrayBuffer !== 'undefined';
    try {
      await this.engine.call('bands', { nLevels: this.shape!.levels.length, shared });
    } catch (error) {
      if (generation === this.generation) this.say((error as Error).message, 'error');
    }
  }

  /** Other levels: bands are fetched anew, and gains of another number of levels are dropped by the server. */
  async setLevels(what: unknown): Promise<void> {
    const shape = this.shape;
    if (!shape) return;
    await this.saver?.whileReplaced(async () => {
      const levels = await this.api.levels(shape.id, what);
      this.startLevels(levels, await this.api.edit(shape.id));
    });
    await this.readLevels();
    // Presets have as many gains as there are levels.
    const { presets } = await this.api.shape(shape.id);
    this.shape = { ...this.shape!, presets };
    this.emit('levels');
  }

  private startLevels(levels: Level[], edit: Edit): void {
    this.generation++;
    this.shape = { ...this.shape!, levels };
    this.arrived.clear();
    this.view.setLevels(levels.length);
    this.view.setUnedited();
    this.begin(fromEdit(edit, levels.length), edit.revision);
    this.emit('levels');
  }

  private async readLevels(): Promise<void> {
    const { generation } = this;
    await this.readBands(generation);
    if (generation === this.generation) this.settle();
  }

  async takeRecipe(recipe: string): Promise<void> {
    await this.saver?.whileReplaced(async () => {
      const { levels, edit } = await this.api.putRecipe(this.shape!.id, recipe);
      this.startLevels(levels, edit);
    });
    await this.readLevels();
  }

  /** An edit from a file, as one step. */
  takeEdit(edit: Edit): void {
    const fits = Array.isArray(edit.layers) && edit.layers.every((l) => l.gains.length === this.nLevels);
    if (!fits) throw new Error(text.badEdit(this.nLevels));
    this.history.commit(fromEdit(edit, this.nLevels));
  }

  /** After a conflict: what another page made of the edit. */
  takeTheirs(): void {
    const edit = this.saver?.theirs;
    if (!edit) return;
    this.saver!.resolve(false);
    this.begin(fromEdit(edit, this.nLevels), edit.revision);
    this.settle();
  }

  private hear(news: News): void {
    if (news.news === 'band') {
      this.view.setBand(news.level, news.scale, news.values);
      this.arrived.add(news.level);
      const now = performance.now();
      if (this.arrived.size === 1) this.watch.timings.firstSlider = now;
      if (this.arrived.size === this.nLevels) this.watch.timings.slidersLive = now;
      this.emit('band');
      return;
    }
    this.masks.hear(news.key, news.from, news.bytes);
  }

  /** The document changed: by a step, or (not `committed`) within a gesture. */
  private changed(committed: boolean): void {
    if (!this.doc.layers.some((l) => l.key === this.selected)) {
      this.selected = this.doc.layers.at(-1)!.key;
      this.emit('selected');
    }
    this.masks.take(this.doc.layers);
    this.updateTint();
    this.show(committed);
    if (committed) this.saver?.changed(this.doc, this.settled());
    this.emit('doc');
  }

  /**
   * Shows the present document: by the shader where the shape is large, else by the worker within a frame. A step is drawn at once;
   * what moves is drawn by the next frame, whatever number of moves there are until then.
   */
  show(step: boolean): void {
    if (this.view.large && this.showLive()) {
      if (step) this.view.draw();
      window.clearTimeout(this.restTimer);
      this.restTimer = window.setTimeout(() => this.settle(), step ? 30 : REST);
    } else this.settle();
  }

  private showLive(): boolean {
    const layers = this.doc.layers.filter((l) => l.on);
    const terms = layers.map((l) => ({
      opacity: l.opacity,
      gains: l.gains,
      mask: l.region ? NO_MASK : null,
    }));
    const masked = layers
      .filter((l) => l.region)
      .map((l) => ({ slot: this.masks.slot(l.key), slopes: l.gains.map((g) => l.opacity * (g - 1)) }));
    if (!layers.every((l) => !l.region || this.masks.has(l.key))) return false;
    const shown = this.view.setGains(globalGains(terms, this.nLevels), masked);
    if (shown) this.shownDoc = this.doc;
    return shown;
  }

  updateTint(): void {
    const slot = this.masks.slot(this.selected);
    // Two shapes are compared in one colour.
    this.view.setTint(this.tint && slot >= 0 && !this.compared ? slot : null);
  }

  select(key: number): void {
    this.selected = key;
    this.updateTint();
    this.emit('selected');
  }

  /** Exact positions and normals of the present document; while that is computed, the next one waits. */
  settle(): void {
    window.clearTimeout(this.restTimer);
    this.restTimer = 0;
    if (this.settling) {
      this.settleAgain = true;
      return;
    }
    if (!this.shape) return;
    this.settling = true;
    void this.compute().finally(() => {
      this.settling = false;
      if (this.settleAgain) {
        this.settleAgain = false;
        this.settle();
        return;
      }
      if (this.restTimer) return;
      for (const done of this.settledWaiters.splice(0)) done();
    });
  }

  private async compute(): Promise<void> {
    const { doc, generation } = this;
    const { news, ids } = this.regions.newsOf(doc.layers.map((l) => l.region));
    const layers: WorkerLayer[] = doc.layers.map((l, i) => ({
      key: l.key,
      on: l.on,
      opacity: l.opacity,
      gains: l.gains,
      region: ids[i]!,
    }));
    const exact =
      needsServer(doc, this.shape!.kind === 'cloud') && this.saver?.state === 'kept' && !this.saver.pending;
    try {
      const answer = await this.engine.call('edit', { layers, regions: news, exact });
      if (generation !== this.generation) return;
      this.watch.timings.settle.push(answer.took);
      if (answer.problem && answer.problem !== this.problem) this.say(answer.problem, 'error');
      this.problem = answer.problem;
      if (doc === this.doc || !this.view.large) {
        this.view.setEdited(answer.positions, answer.normals);
        this.shownDoc = doc;
      }
      if (doc === this.doc) this.heardWorker(answer);
    } catch (error) {
      // The next time the worker learns these regions again.
      this.regions.forget(news);
      if (generation === this.generation) this.say((error as Error).message, 'error');
    }
  }

  /** Resolves when what is drawn is the present document, exactly. */
  settled(): Promise<void> {
    if (!this.settling && !this.restTimer) return Promise.resolve();
    return new Promise((done) => this.settledWaiters.push(done));
  }

  private heardWorker(answer: EditAnswer): void {
    const before = this.shape!.volume;
    const volume: [number, number] | null =
      before !== null && answer.volume !== null ? [before, answer.volume] : null;
    this.moved = { greatest: answer.greatest, rms: answer.rms, volume };
    this.emit('moved');
  }

  private heardServer(moved: Moved | null): void {
    if (moved) {
      this.moved = moved;
      this.emit('moved');
      if (needsServer(this.doc, this.shape!.kind === 'cloud')) this.settle();
    }
    this.emit('saving');
  }

  setBefore(on: boolean): void {
    if (this.view.before === on) return;
    this.view.before = on;
    this.view.request();
    this.emit('before');
  }

  undo(): void {
    this.watch.sliderTouched();
    if (!this.history.undo()) this.watch.sliderLeft();
  }

  redo(): void {
    this.history.redo();
  }

  /** Changes the selected layer, as one step or part of a gesture. */
  changeLayer(change: Partial<DocLayer>, step: boolean, key = this.selected): void {
    const doc = withLayer(this.doc, key, change);
    if (step) this.history.commit(doc);
    else this.history.preview(doc);
  }

  addLayer(name: string, region: Region | null, step = true): number {
    const layer = newLayer(name, this.nLevels, region);
    const doc = { ...this.doc, layers: [...this.doc.layers, layer] };
    this.selected = layer.key;
    if (step) this.history.commit(doc);
    else this.history.preview(doc);
    this.select(layer.key);
    return layer.key;
  }

  /** The worker gets the mask of a layer before it is painted on, and blurs it for a stroke that smooths by a length. */
  async showMask(layer: DocLayer, smoothing: number | null): Promise<void> {
    if (!layer.region) return;
    const { news, ids } = this.regions.newsOf([layer.region]);
    try {
      await this.engine.call('mask', { key: layer.key, id: ids[0]!, regions: news, smoothing });
    } catch (error) {
      this.regions.forget(news);
      throw error;
    }
  }

  setBrush(on: boolean): void {
    this.brushOn = on;
    this.emit('tool');
  }

  showSpectrum(spectrum: number[]): void {
    this.spectrum = spectrum;
    this.emit('spectrum');
  }

  /** The vertex that was clicked last, where a ball begins. */
  lastVertex: number | null = null;
  /** A line that is being drawn, click by click. */
  drawing: { end: () => void; cancel: () => void } | null = null;
  /** Takes the next vertex that is clicked in place of what a click does. */
  pickNext: ((vertex: number) => void) | null = null;

  /** The range of a field that 2 % at each end are left out of. */
  async fieldRange(name: string): Promise<[number, number]> {
    const { values } = await this.api.field(this.shape!.id, name, 'region');
    return rangeOf(values, 'most', false);
  }
}

const NO_MASK = new Uint8Array(0);

/** Rules that only the server applies: the page shows its positions once it has the edit. */
export function needsServer(doc: Doc, cloud: boolean): boolean {
  return (
    // A cloud moves along its normals where nothing else is said.
    (doc.along === null ? cloud && !isNeutral(doc) : doc.along !== 'free') ||
    (doc.border !== null && doc.border !== 'natural') ||
    doc.volume === 'keep'
  );
}
