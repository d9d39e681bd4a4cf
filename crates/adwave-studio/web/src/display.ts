/**
 * Updates the picture from the document: the shader sums bands while a large shape moves, then the worker computes
 * positions and normals.
 */

import type { EditAnswer, WorkerLayer } from './compute/messages';
import { globalGains } from './compute/positions';
import type { Masks } from './masks';
import { type Doc, needsServer, reshapedBy, sameReshape, soloLayers } from './state';
import type { Studio } from './studio';

/** Milliseconds of rest before positions and normals of large shapes are computed: after a step, after a movement. */
const REST = { step: 30, move: 120 };
/** Placeholder for the mask of a layer whose values the shader has. */
const NO_MASK = new Uint8Array(0);

export class Display {
  private settling = false;
  private settleAgain = false;
  private restTimer = 0;
  private waiters: (() => void)[] = [];
  private shownDoc: Doc | null = null;
  private pulling = false;
  private pullAgain = false;
  /** Time of the first motion of a handle that is not shown yet. */
  private pulledAt = 0;
  /** Vertices that the server knows as those that are drawn during motion. */
  private drawn: Uint32Array | null = null;
  /** Last problem that the worker reported about the region of a layer. */
  private problem: string | null = null;
  private withdrawProblem = () => {};

  constructor(
    private readonly studio: Studio,
    private readonly masks: Masks,
  ) {
    const { view, timings } = studio;
    view.onDrawn = (began) => timings.recordFrame(began, this.isCurrent, () => view.finish());
  }

  /**
   * Shows the present document: with the shader for large shapes, otherwise with the worker within a frame. A step is drawn
   * immediately; movements are drawn once per frame.
   */
  show(step: boolean): void {
    const { view } = this.studio;
    if (this.studio.isPulling) {
      this.pulledAt ||= performance.now();
      void this.pull();
      return;
    }
    if (view.arrays.large && this.showLive()) {
      if (step) view.draw();
      window.clearTimeout(this.restTimer);
      this.restTimer = window.setTimeout(() => this.settle(), step ? REST.step : REST.move);
    } else this.settle();
  }

  /** Bends the shape one step towards the present pose, or clones detail; what follows meanwhile is taken together. */
  private async pull(): Promise<void> {
    const { studio } = this;
    const { view, doc, timings } = studio;
    const by = reshapedBy(doc);
    if (!view.arrays.large || !by) {
      this.settle();
      return;
    }
    if (this.pulling) {
      this.pullAgain = true;
      return;
    }
    this.pulling = true;
    const { generation } = studio.session;
    const began = this.pulledAt;
    this.pulledAt = 0;
    try {
      const { drawn } = view.arrays;
      if (drawn && drawn !== this.drawn) {
        await studio.engine.call('drawn', { vertices: drawn.slice() });
        this.drawn = drawn;
      }
      const bent = await studio.engine.call('bend', { by, follow: 'step', drawn: drawn !== null });
      if (generation === studio.session.generation && studio.isPulling) {
        view.arrays.setPosed(by, bent);
        view.markMoving();
        const moved = view.arrays.pulledBy(bent);
        // The volume is known when the handle is released.
        if (moved) studio.displacement = { ...moved, volume: null };
        studio.emit('moved');
        let isShown = this.showLive(by);
        if (!isShown && view.showPulled(bent)) {
          this.shownDoc = doc;
          isShown = true;
        }
        if (isShown) {
          view.draw();
          if (began && timings.isEnabled) {
            view.finish();
            timings.records.pull.push(performance.now() - began);
          }
        } else this.settle();
      }
    } catch (error) {
      studio.showMessage((error as Error).message, 'error');
    } finally {
      this.pulling = false;
    }
    if (!this.pullAgain) return;
    this.pullAgain = false;
    if (studio.isPulling) void this.pull();
  }

  /** Shows the document by the shader; `by` are the clones and the pose that its arrays have. */
  private showLive(by = reshapedBy(this.studio.doc)): boolean {
    const { doc, nLevels, view } = this.studio;
    if (!sameReshape(view.arrays.by, by)) return false;
    const layers = soloLayers(doc.layers, this.positionSolo).filter((l) => l.on);
    const terms = layers.map((l) => ({
      opacity: l.opacity,
      gains: l.gains,
      mask: l.region ? NO_MASK : null,
    }));
    const masked = layers
      .filter((l) => l.region)
      .map((l) => ({ slot: this.masks.slot(l.key), slopes: l.gains.map((g) => l.opacity * (g - 1)) }));
    if (!layers.every((l) => !l.region || this.masks.has(l.key))) return false;
    const shown = view.setGains(globalGains(terms, nLevels), masked);
    if (shown) this.shownDoc = doc;
    return shown;
  }

  /** Shows the layer of a brush or a band that is soloed, of what is edited. */
  showTarget(step: boolean): void {
    if (this.studio.target === null) this.show(step);
    else this.studio.fieldEditor.show();
  }

  /** True if the picture shows the present document. */
  get isCurrent(): boolean {
    return this.shownDoc === this.studio.doc;
  }

  /** Notes that the picture shows a document whose positions did not change. */
  markShown(doc: Doc): void {
    if (doc === this.studio.doc) this.shownDoc = doc;
  }

  /** Computes positions and normals of the present document; a later request waits for the current one. */
  settle(): void {
    window.clearTimeout(this.restTimer);
    this.restTimer = 0;
    if (this.settling) {
      this.settleAgain = true;
      return;
    }
    if (!this.studio.shape) return;
    this.settling = true;
    void this.compute().finally(() => {
      this.settling = false;
      if (this.settleAgain) {
        this.settleAgain = false;
        this.settle();
        return;
      }
      if (this.restTimer) return;
      for (const done of this.waiters.splice(0)) done();
    });
  }

  /** Resolves when the picture shows the present document exactly. */
  waitUntilSettled(): Promise<void> {
    if (!this.settling && !this.restTimer) return Promise.resolve();
    return new Promise((done) => this.waiters.push(done));
  }

  private async compute(): Promise<void> {
    const { studio } = this;
    const { doc, saver, regions, view } = studio;
    const { generation } = studio.session;
    const isOld = () => generation !== studio.session.generation;
    const { updates, ids } = regions.updatesFor(doc.layers.map((l) => l.region));
    const solo = this.positionSolo;
    const layers: WorkerLayer[] = soloLayers(doc.layers, solo).map((l, i) => ({
      key: l.key,
      on: l.on,
      opacity: l.opacity,
      gains: l.gains,
      region: ids[i]!,
    }));
    const exact =
      !solo && needsServer(doc, studio.shape!) && saver?.state === 'saved' && !saver.hasUnsavedStep;
    try {
      const follow = studio.isPulling ? 'step' : 'rest';
      const began = this.pulledAt;
      this.pulledAt = 0;
      const by = reshapedBy(doc);
      const keep = studio.keptKeys(doc);
      const answer = await studio.engine.call('edit', {
        layers,
        regions: updates,
        keep,
        exact,
        by,
        follow,
      });
      if (isOld()) return;
      this.masks.retainLayers(keep);
      if (answer.places && answer.turns) {
        view.arrays.setPosed(by, { places: answer.places, turns: answer.turns });
      } else if (!by) view.arrays.setPosed(null, null);
      else if (view.arrays.by && !answer.problem) view.arrays.by = by;
      studio.timings.records.settle.push(answer.took);
      if (answer.problem !== this.problem) this.withdrawProblem();
      if (answer.problem && answer.problem !== this.problem)
        this.withdrawProblem = studio.showMessage(answer.problem, 'error');
      this.problem = answer.problem;
      if (doc === studio.doc || !view.arrays.large) {
        view.arrays.setEdited(answer.positions, answer.normals);
        this.shownDoc = doc;
      }
      if (began && studio.isPulling && studio.timings.isEnabled) {
        view.draw();
        view.finish();
        studio.timings.records.pull.push(performance.now() - began);
      }
      // A band that is shown alone does not change the figures of the edit.
      if (doc === studio.doc && !solo) this.updateDisplacement(answer);
    } catch (error) {
      // These regions are sent to the worker again next time.
      regions.markUnknown(updates);
      if (!isOld()) studio.showMessage((error as Error).message, 'error');
    }
  }

  /** The band that is shown alone, unless it is one of a field. */
  private get positionSolo() {
    return this.studio.target === null ? this.studio.solo : null;
  }

  private updateDisplacement({ greatest, rms, volume: after }: EditAnswer): void {
    const { studio } = this;
    const before = studio.turnedParts.volume;
    studio.view.camera.setReach(studio.doc.pose ? greatest : 0);
    studio.displacement = {
      greatest,
      rms,
      volume: before !== null && after !== null ? [before, after] : null,
    };
    studio.emit('moved');
  }
}
