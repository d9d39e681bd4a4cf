/** What the parts of the page share: the shape, its document, the worker, the picture, and what is selected. */

import type { Api } from './api';
import type { Early } from './boot';
import { rangeOf } from './colours';
import { coarseTriangles } from './compute/coarse';
import type { EditAnswer, News, WorkerLayer } from './compute/messages';
import { globalGains } from './compute/positions';
import { Engine } from './engine';
import { GREATEST_GAIN } from './gain';
import type { Level, Moved, Region, Shape, ShapeList } from './protocol';
import { keptAfterReload, Saver } from './saver';
import { type Doc, type DocLayer, fromEdit, History, isNeutral, newLayer, withLayer } from './state';
import { text } from './text';
import type { View } from './view';

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
  | 'theme';

/** Milliseconds of rest after which positions and normals are computed exactly on shapes that are large. */
const REST = 120;
/** Triangles of a large shape while it moves. */
const COARSE = 45_000;
/** Triangles of a shape that is first drawn with fewer. */
const COARSE_FIRST = 200_000;

export interface Timings {
  firstPixels: number;
  firstSlider: number;
  slidersLive: number;
  slider: number[];
  settle: number[];
  pick: number[];
  stamp: number[];
  /** A frame from its first call until it is finished. */
  frame: number[];
}

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
  brushOn = false;
  readonly timings: Timings = {
    firstPixels: 0,
    firstSlider: 0,
    slidersLive: 0,
    slider: [],
    settle: [],
    pick: [],
    stamp: [],
    frame: [],
  };
  readonly engine: Engine;
  /** Whether the mask of the selected layer is shown as a tint. */
  tint = true;
  private readonly listeners = new Map<Topic, (() => void)[]>();
  private readonly regionIds = new WeakMap<Region, number>();
  private nRegions = 0;
  private sentRegions = new Set<number>();
  private readonly masks = new Map<number, Uint8Array>();
  private slots: number[] = [];
  private settling = false;
  private settleAgain = false;
  private restTimer = 0;
  private generation = 0;
  private settledWaiters: (() => void)[] = [];
  private sliderMoved = 0;
  private shownDoc: Doc | null = null;
  private problem: string | null = null;

  constructor(
    readonly api: Api,
    readonly view: View,
    worker: Worker,
    readonly say: (sentence: string, kind?: 'info' | 'error') => void,
  ) {
    this.engine = new Engine(worker, (news) => this.hear(news));
    view.drawn = (began) => this.frameDrawn(began);
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
    if (this.view.heavy && shape.n_triangles > COARSE_FIRST) {
      // Fewer triangles are there sooner; all of them follow when the page is at rest.
      coarsen();
      this.view.touch();
    }
    this.view.draw();
    if (this.view.heavy && shape.n_triangles <= COARSE_FIRST)
      window.setTimeout(() => generation === this.generation && coarsen());
    if (!this.timings.firstPixels) {
      this.view.finish();
      this.timings.firstPixels = performance.now();
    }
    this.masks.clear();
    this.slots = [];
    this.sentRegions = new Set();
    this.arrived.clear();
    this.moved = null;
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
    if (!isNeutral(this.doc)) this.settle();
    void this.engine.call('warm', {});
  }

  /** A document from the server becomes the present one, without a past. */
  private begin(doc: Doc, revision: number): void {
    this.history = new History(doc, (committed) => this.changed(committed));
    this.selected = doc.layers[0]!.key;
    this.saver?.close();
    this.saver = new Saver(this.api, this.shape!.id, revision, (moved) => this.heardServer(moved));
    this.updateSlots();
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
    const levels = await this.api.levels(shape.id, what);
    await this.takeLevels(levels, await this.api.edit(shape.id));
    // Presets have as many gains as there are levels.
    const { presets } = await this.api.shape(shape.id);
    this.shape = { ...this.shape!, presets };
    this.emit('levels');
  }

  private async takeLevels(levels: Level[], edit: Parameters<typeof fromEdit>[0]): Promise<void> {
    const generation = ++this.generation;
    this.shape = { ...this.shape!, levels };
    this.arrived.clear();
    this.view.setLevels(levels.length);
    this.view.setUnedited();
    this.begin(fromEdit(edit, levels.length), edit.revision);
    this.emit('levels');
    await this.readBands(generation);
    if (generation === this.generation) this.settle();
  }

  async takeRecipe(recipe: string): Promise<void> {
    const { levels, edit } = await this.api.putRecipe(this.shape!.id, recipe);
    await this.takeLevels(levels, edit);
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
      if (this.arrived.size === 1) this.timings.firstSlider = now;
      if (this.arrived.size === this.nLevels) this.timings.slidersLive = now;
      this.emit('band');
      return;
    }
    let mask = this.masks.get(news.key);
    if (!mask) {
      mask = new Uint8Array(this.shape!.n_vertices);
      this.masks.set(news.key, mask);
    }
    mask.set(news.bytes, news.from);
    const slot = this.slots.indexOf(news.key);
    if (slot >= 0) this.view.setMask(slot, news.from, news.bytes);
  }

  /** The document changed: by a step, or (not `committed`) within a gesture. */
  private changed(committed: boolean): void {
    if (!this.doc.layers.some((l) => l.key === this.selected)) {
      this.selected = this.doc.layers.at(-1)!.key;
      this.emit('selected');
    }
    this.updateSlots();
    this.show(committed);
    if (committed) this.saver?.changed(this.doc);
    this.emit('doc');
  }

  /** Shows the present document: at once by the shader where the shape is large, else by the worker within a frame. */
  show(atOnce: boolean): void {
    if (this.view.large && this.showLive()) {
      window.clearTimeout(this.restTimer);
      this.restTimer = window.setTimeout(() => this.settle(), atOnce ? 30 : REST);
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
      .map((l) => ({ slot: this.slots.indexOf(l.key), slopes: l.gains.map((g) => l.opacity * (g - 1)) }));
    if (masked.some((m) => !this.masks.has(this.slots[m.slot]!))) return false;
    const shown = this.view.setGains(globalGains(terms, this.nLevels), masked);
    if (shown) this.shownDoc = this.doc;
    return shown;
  }

  /** Which layer's mask is in which slot of the shader. */
  private updateSlots(): void {
    const slots = this.doc.layers.filter((l) => l.region).map((l) => l.key);
    if (slots.length !== this.slots.length || slots.some((k, i) => k !== this.slots[i])) {
      const old = this.slots;
      this.slots = slots;
      for (const [slot, key] of slots.entries()) {
        const mask = this.masks.get(key);
        if (mask && old[slot] !== key) this.view.setMask(slot, 0, mask);
        else if (!mask && this.shape) this.view.setMask(slot, 0, new Uint8Array(this.shape.n_vertices));
      }
    }
    this.updateTint();
  }

  updateTint(): void {
    const slot = this.slots.indexOf(this.selected);
    this.view.setTint(this.tint && slot >= 0 ? slot : null);
  }

  select(key: number): void {
    this.selected = key;
    this.updateTint();
    this.emit('selected');
  }

  regionId(region: Region): number {
    let id = this.regionIds.get(region);
    if (id === undefined) {
      id = ++this.nRegions;
      this.regionIds.set(region, id);
    }
    return id;
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
    const regions: [number, Region][] = [];
    const layers: WorkerLayer[] = doc.layers.map((l) => {
      const region = l.region ? this.regionId(l.region) : null;
      if (region !== null && !this.sentRegions.has(region)) regions.push([region, l.region!]);
      return { key: l.key, on: l.on, opacity: l.opacity, gains: l.gains, region };
    });
    for (const [id] of regions) this.sentRegions.add(id);
    const exact = needsServer(doc) && this.saver?.state === 'kept' && !this.saver.pending;
    try {
      const answer = await this.engine.call('edit', { layers, regions, exact });
      if (generation !== this.generation) return;
      this.timings.settle.push(answer.took);
      if (answer.problem && answer.problem !== this.problem) this.say(answer.problem, 'error');
      this.problem = answer.problem;
      if (doc === this.doc || !this.view.large) {
        this.view.setEdited(answer.positions, answer.normals);
        this.shownDoc = doc;
      }
      if (doc === this.doc) this.heardWorker(answer);
    } catch (error) {
      // The next time the worker learns these regions again.
      for (const [id] of regions) this.sentRegions.delete(id);
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
      if (needsServer(this.doc)) this.settle();
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
    this.sliderTouched();
    if (!this.history.undo()) this.sliderMoved = 0;
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

  /** The worker gets the mask of a layer before it is painted on. */
  async showMask(layer: DocLayer): Promise<void> {
    if (!layer.region) return;
    await this.engine.call('mask', { key: layer.key, id: this.regionId(layer.region), region: layer.region });
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
  /** Takes the next vertex that is clicked in place of what a click does. */
  pickNext: ((vertex: number) => void) | null = null;
  private detail: number[] | null = null;

  /** Remembers how much detail of each width there is round a vertex. */
  takeDetail(vertex: number, radius: number): void {
    void this.engine.call('energy', { key: null, vertex, radius }).then(({ rms }) => {
      this.detail = rms;
      this.say(text.detailTaken);
    });
  }

  /** Gains that give the selected layer's place the detail that was taken elsewhere. */
  giveDetail(): void {
    const { detail, layer } = this;
    if (!detail || detail.length !== this.nLevels) {
      this.say(text.noDetail);
      return;
    }
    void this.engine.call('energy', { key: layer.key, vertex: null, radius: 0 }).then(({ rms }) => {
      const gains = detail.map((wanted, j) => {
        const there = rms[j]!;
        const gain = there > 0 ? wanted / there : 1;
        return Math.round(1000 * Math.min(GREATEST_GAIN, gain)) / 1000;
      });
      this.changeLayer({ gains }, true, layer.key);
    });
  }

  /** The range of a field that 2 % at each end are left out of. */
  async fieldRange(name: string): Promise<[number, number]> {
    const { values, info } = await this.api.field(this.shape!.id, name);
    return rangeOf(values, 'most', info.diverging);
  }

  /** A slider was moved now: the next frame says how long it took to be seen. */
  sliderTouched(): void {
    this.sliderMoved ||= performance.now();
  }

  /** Set by tests: each frame waits until it is finished and is timed. */
  measuring = false;

  private frameDrawn(began: number): void {
    if (!this.measuring) {
      this.sliderMoved = 0;
      return;
    }
    if (!this.sliderMoved || this.shownDoc !== this.doc) return;
    const since = this.sliderMoved;
    this.sliderMoved = 0;
    this.view.finish();
    this.timings.slider.push(performance.now() - since);
    this.timings.frame.push(performance.now() - began);
  }
}

const NO_MASK = new Uint8Array(0);

/** Rules that only the server applies: the page shows its positions once it has the edit. */
export function needsServer(doc: Doc): boolean {
  return (
    (doc.along !== null && doc.along !== 'free') ||
    (doc.border !== null && doc.border !== 'natural') ||
    doc.volume === 'keep'
  );
}
