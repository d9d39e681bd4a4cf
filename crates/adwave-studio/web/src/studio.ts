/** What the parts of the page share: the shape, its document, the worker, the picture, and what is selected. */

import type { Api } from './api';
import { rangeOf } from './colors';
import type { News } from './compute/messages';
import { Detail } from './detail';
import { Display } from './display';
import { Engine } from './engine';
import { Masks } from './masks';
import type { Region, Shape, ShapeList } from './protocol';
import { Regions } from './regions';
import type { Saver } from './saver';
import { Session } from './session';
import { type Doc, type DocLayer, History, newLayer, withLayer } from './state';
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
  readonly session = new Session(this);
  readonly display: Display;
  /** Whether the mask of the selected layer is shown as a tint. */
  tint = true;
  /** The vertex that was clicked last, where a ball begins. */
  lastVertex: number | null = null;
  /** A line that is being drawn, click by click. */
  drawing: { end: () => void; cancel: () => void } | null = null;
  /** Takes the next vertex that is clicked in place of what a click does. */
  pickNext: ((vertex: number) => void) | null = null;
  private readonly listeners = new Map<Topic, (() => void)[]>();
  private readonly masks: Masks;

  constructor(
    readonly api: Api,
    readonly view: View,
    worker: Worker,
    readonly say: (sentence: string, kind?: 'info' | 'error') => void,
  ) {
    this.engine = new Engine(worker, (news) => this.hear(news));
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

  /** Another shape is there: nothing is known of it yet. */
  forgetShape(): void {
    this.masks.begin(this.shape!.n_vertices);
    this.regions.forget();
    this.arrived.clear();
    this.moved = null;
    this.compared = null;
    this.emit('compared');
  }

  /** A document from the server becomes the present one, without a past. */
  startFrom(doc: Doc): void {
    this.history = new History(doc, (committed) => this.changed(committed));
    this.selected = doc.layers[0]!.key;
    this.masks.take(doc.layers);
    this.updateTint();
    this.emit('doc');
    this.emit('selected');
  }

  private hear(news: News): void {
    if (news.news === 'band') {
      this.view.arrays.setBand(news.level, news.scale, news.values);
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
    this.display.show(committed);
    if (committed) this.saver?.changed(this.doc, this.display.settled());
    this.emit('doc');
  }

  updateTint(): void {
    const slot = this.masks.slot(this.selected);
    // Two shapes are compared in one color.
    this.view.setTint(this.tint && slot >= 0 && !this.compared ? slot : null);
  }

  select(key: number): void {
    this.selected = key;
    this.updateTint();
    this.emit('selected');
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

  /** The range of a field that 2 % at each end are left out of. */
  async fieldRange(name: string): Promise<[number, number]> {
    const { values } = await this.api.field(this.shape!.id, name, 'region');
    return rangeOf(values, 'most', false);
  }
}
