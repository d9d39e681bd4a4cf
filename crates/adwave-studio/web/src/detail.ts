/** The detail of one place given to another: gains by which a layer has as much of each band. */

import { GREATEST_GAIN } from './gain';
import type { Studio } from './studio';
import { text } from './text';

export class Detail {
  /** Root mean square of each band where it was taken. */
  private taken: number[] | null = null;

  constructor(private readonly studio: Studio) {}

  /** Remembers how much detail of each width there is round a vertex. */
  take(vertex: number, radius: number): void {
    void this.studio.engine.call('energy', { key: null, vertex, radius }).then(({ rms }) => {
      this.taken = rms;
      this.studio.say(text.detailTaken);
    });
  }

  /** Gains that give the selected layer's place the detail that was taken elsewhere. */
  give(): void {
    const { taken, studio } = this;
    const { layer } = studio;
    if (!taken || taken.length !== studio.nLevels) {
      studio.say(text.noDetail);
      return;
    }
    void studio.engine.call('energy', { key: layer.key, vertex: null, radius: 0 }).then(({ rms }) => {
      const gains = taken.map((wanted, j) => {
        const there = rms[j]!;
        const gain = there > 0 ? wanted / there : 1;
        return Math.round(1000 * Math.min(GREATEST_GAIN, gain)) / 1000;
      });
      studio.changeLayer({ gains }, true, layer.key);
    });
  }
}
