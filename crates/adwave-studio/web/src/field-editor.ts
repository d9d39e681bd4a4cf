/** The field that the equalizer edits instead of the positions: its bands, and its values after its layers. */

import { classesOf } from './colors';
import type { FieldAnswer } from './compute/messages';
import { formatCount } from './lengths';
import { allLayers, areNeutral, type Doc, isFieldOn, layersOf, soloLayers } from './state';
import type { Studio } from './studio';
import { text } from './text';

export class FieldEditor {
  /** Field whose bands the worker has; `null` while they are loaded, or if the positions are edited. */
  loaded: string | null = null;
  /** Values of the loaded field before and after its edit. */
  before: Float32Array | null = null;
  values: Float32Array | null = null;
  /** Change of the field by its edit; `null` if none is shown. */
  change: { greatest: number; rms: number } | null = null;
  private isComputing = false;
  private computeAgain = false;
  private waiters: (() => void)[] = [];
  /** Counter of loads; answers for an earlier one are ignored. */
  private turn = 0;
  private hasGaps = false;
  private problem: string | null = null;

  constructor(private readonly studio: Studio) {}

  /**
   * Loads the bands of a field for the present levels; returns false if they could not be loaded. A load that a later one
   * replaces leaves the answer to that one.
   */
  async load(name: string): Promise<boolean> {
    const { studio } = this;
    const turn = ++this.turn;
    const isOld = () => turn !== this.turn;
    this.forget();
    const { id } = studio.shape!;
    const asked = studio.wait(text.computingField(name), (signal) => studio.api.fieldBands(id, name, signal));
    const all = await asked.catch((error: Error) => {
      if (isOld()) return null;
      throw error;
    });
    if (isOld()) return true;
    if (!all) return false;
    this.before = all.slice(0, studio.shape!.n_vertices);
    this.hasGaps = this.before.some((x) => Number.isNaN(x));
    await studio.engine.call('field', { values: all }, [all.buffer]);
    if (isOld()) {
      if (studio.target === null) void studio.engine.call('field', { values: null });
      return true;
    }
    this.loaded = name;
    studio.emit('band');
    this.show();
    void this.refine().catch(() => {});
    const nMissing = this.before.reduce((n, x) => n + Number(Number.isNaN(x)), 0);
    // A degree is a count.
    const isCount = studio.shape!.graph && name === 'degree';
    if (classesOf(this.before) && !isCount) studio.showMessage(text.fieldOfClasses(name));
    else if (nMissing > 0) studio.showMessage(text.fieldWithGaps(name, formatCount(nMissing)));
    return true;
  }

  /** Drops the bands of the field. */
  drop(): void {
    const wasLoaded = this.loaded !== null;
    this.close();
    if (wasLoaded) void this.studio.engine.call('field', { values: null });
  }

  /** Ends the edit of a field with its shape. */
  close(): void {
    this.turn++;
    this.forget();
  }

  private forget(): void {
    this.loaded = null;
    this.before = null;
    this.values = null;
    this.change = null;
    this.studio.emit('fieldEdited');
  }

  /** Shows the field after the present layers; what changes meanwhile is taken together. */
  show(): void {
    if (this.loaded === null) return;
    if (this.isComputing) {
      this.computeAgain = true;
      return;
    }
    this.isComputing = true;
    void this.compute().finally(() => {
      this.isComputing = false;
      if (this.computeAgain) {
        this.computeAgain = false;
        this.show();
        return;
      }
      for (const done of this.waiters.splice(0)) done();
    });
  }

  /** Resolves when the values are those of the present document. */
  waitUntilShown(): Promise<void> {
    if (!this.isComputing) return Promise.resolve();
    return new Promise((done) => this.waiters.push(done));
  }

  private async compute(): Promise<void> {
    const { studio, turn } = this;
    const { doc, regions, solo } = studio;
    const list = isFieldOn(doc, studio.target ?? '') ? soloLayers(studio.layers, solo) : [];
    const { updates, ids } = regions.updatesFor(list.map((l) => l.region));
    const layers = list.map(({ key, on, opacity, gains }, i) => ({
      key,
      on,
      opacity,
      gains,
      region: ids[i]!,
    }));
    try {
      const keep = studio.keptKeys(doc);
      const answer = await studio.engine.call('fieldEdit', { layers, regions: updates, keep });
      if (turn !== this.turn) return;
      studio.masks.retainLayers(keep);
      if (answer.problem && answer.problem !== this.problem) studio.showMessage(answer.problem, 'error');
      this.problem = answer.problem;
      this.take(answer, doc);
    } catch (error) {
      regions.markUnknown(updates);
      if (turn === this.turn) studio.showMessage((error as Error).message, 'error');
    }
  }

  private take({ values, greatest, rms }: FieldAnswer, doc: Doc): void {
    this.values = values;
    if (!this.studio.solo) this.change = { greatest, rms };
    this.studio.shapeDisplay.markShown(doc);
    this.studio.emit('fieldEdited');
  }

  /**
   * Replaces the values by those of the server if its masks differ: around gaps it measures distances and percents along the
   * part of the surface where the field has values.
   */
  async refine(): Promise<void> {
    const { studio, loaded, turn } = this;
    const { doc, layers, saver, shape } = studio;
    if (loaded === null || !this.hasGaps || studio.solo || !shape) return;
    if (!layers.some((l) => l.region && !areNeutral([l]))) return;
    if (saver?.state !== 'saved' || saver.hasUnsavedStep) return;
    await this.waitUntilShown();
    const values = await studio.api.editedField(shape.id, loaded);
    if (turn !== this.turn || layersOf(doc, loaded) !== layersOf(studio.doc, loaded)) return;
    this.values = values;
    studio.emit('fieldEdited');
  }
}

/** Keys of all layers of a document. */
export function keysOf(doc: Doc): number[] {
  return allLayers(doc).map((l) => l.key);
}
