/** From the document to the picture: a sum of bands by the shader while a large shape moves, then positions and normals by the worker. */

import type { EditAnswer, WorkerLayer } from './compute/messages';
import { globalGains } from './compute/positions';
import type { Masks } from './masks';
import { type Doc, needsServer } from './state';
import type { Studio } from './studio';

/** Milliseconds of rest after which positions and normals are computed exactly on shapes that are large: after a step, after a move. */
const REST = { step: 30, move: 120 };
/** That a layer has a mask, where the shader has its values. */
const NO_MASK = new Uint8Array(0);

export class Display {
  private settling = false;
  private settleAgain = false;
  private restTimer = 0;
  private waiters: (() => void)[] = [];
  private shown: Doc | null = null;
  /** What the worker said last of a layer whose place cannot be known. */
  private problem: string | null = null;

  constructor(
    private readonly studio: Studio,
    private readonly masks: Masks,
  ) {
    const { view, watch } = studio;
    view.drawn = (began) => watch.frameDrawn(began, this.shown === studio.doc, () => view.finish());
  }

  /**
   * Shows the present document: by the shader where the shape is large, else by the worker within a frame. A step is drawn at once;
   * what moves is drawn by the next frame, whatever number of moves there are until then.
   */
  show(step: boolean): void {
    const { view } = this.studio;
    if (view.arrays.large && this.showLive()) {
      if (step) view.draw();
      window.clearTimeout(this.restTimer);
      this.restTimer = window.setTimeout(() => this.settle(), step ? REST.step : REST.move);
    } else this.settle();
  }

  private showLive(): boolean {
    const { doc, nLevels, view } = this.studio;
    const layers = doc.layers.filter((l) => l.on);
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
    if (shown) this.shown = doc;
    return shown;
  }

  /** Exact positions and normals of the present document; while that is computed, the next one waits. */
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

  /** Resolves when what is drawn is the present document, exactly. */
  settled(): Promise<void> {
    if (!this.settling && !this.restTimer) return Promise.resolve();
    return new Promise((done) => this.waiters.push(done));
  }

  private async compute(): Promise<void> {
    const { studio } = this;
    const { doc, saver, regions, view } = studio;
    const { generation } = studio.session;
    const isOld = () => generation !== studio.session.generation;
    const { news, ids } = regions.newsOf(doc.layers.map((l) => l.region));
    const layers: WorkerLayer[] = doc.layers.map((l, i) => ({
      key: l.key,
      on: l.on,
      opacity: l.opacity,
      gains: l.gains,
      region: ids[i]!,
    }));
    const exact =
      needsServer(doc, studio.shape!.kind === 'cloud') && saver?.state === 'kept' && !saver.pending;
    try {
      const answer = await studio.engine.call('edit', { layers, regions: news, exact });
      if (isOld()) return;
      studio.watch.timings.settle.push(answer.took);
      if (answer.problem && answer.problem !== this.problem) studio.say(answer.problem, 'error');
      this.problem = answer.problem;
      if (doc === studio.doc || !view.arrays.large) {
        view.arrays.setEdited(answer.positions, answer.normals);
        this.shown = doc;
      }
      if (doc === studio.doc) this.tellMoved(answer);
    } catch (error) {
      // The next time the worker learns these regions again.
      regions.forget(news);
      if (!isOld()) studio.say((error as Error).message, 'error');
    }
  }

  private tellMoved({ greatest, rms, volume: after }: EditAnswer): void {
    const { studio } = this;
    const before = studio.shape!.volume;
    studio.moved = { greatest, rms, volume: before !== null && after !== null ? [before, after] : null };
    studio.emit('moved');
  }
}
