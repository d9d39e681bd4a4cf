/** Matching detail: gains that give a layer the band sizes of another spot. */

import { GREATEST_GAIN } from './gain';
import type { Studio } from './studio';
import { text } from './text';

export class DetailTransfer {
  /** Root mean square of each band at the picked spot. */
  private pickedRms: number[] | null = null;

  constructor(private readonly studio: Studio) {}

  /** Stores the size of each band around a vertex. */
  pickFrom(vertex: number, radius: number): void {
    void this.studio.engine.call('energy', { key: null, vertex, radius }).then(({ rms }) => {
      this.pickedRms = rms;
      this.studio.showMessage(text.detailPicked);
    });
  }

  /** Sets the gains of the selected layer so that its region gets the stored band sizes. */
  applyToLayer(): void {
    const { pickedRms, studio } = this;
    const { layer } = studio;
    if (!pickedRms || pickedRms.length !== studio.nLevels) {
      studio.showMessage(text.noDetail);
      return;
    }
    void studio.engine.call('energy', { key: layer.key, vertex: null, radius: 0 }).then(({ rms }) => {
      const gains = pickedRms.map((wanted, j) => {
        const there = rms[j]!;
        const gain = there > 0 ? wanted / there : 1;
        return Math.round(1000 * Math.min(GREATEST_GAIN, gain)) / 1000;
      });
      studio.changeLayer({ gains }, true, layer.key);
    });
  }
}
