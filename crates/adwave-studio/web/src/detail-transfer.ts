/** Matching detail: gains that give a layer the band sizes of another spot. */

import { brush } from './brush';
import { matchingGains } from './effects';
import type { Studio } from './studio';
import { text } from './text';

export class DetailTransfer {
  /** Root mean square of each band at the picked spot. */
  private pickedRms: number[] | null = null;

  constructor(private readonly studio: Studio) {}

  /** True if the detail of a spot is stored for the present bands. */
  get isPicked(): boolean {
    return this.pickedRms?.length === this.studio.nLevels;
  }

  /** Lets the next click choose the spot whose detail is stored. */
  startPick(): void {
    const { studio } = this;
    studio.requestVertex(text.pickDetailClick, (vertex) =>
      this.pickFrom(vertex, (brush.radius / 100) * studio.shape!.diagonal),
    );
  }

  /** Stores the size of each band around a vertex. */
  pickFrom(vertex: number, radius: number): void {
    void this.studio.engine.call('energy', { key: null, vertex, radius }).then(({ rms }) => {
      this.pickedRms = rms;
      this.studio.showMessage(text.detailPicked);
    });
  }

  /** Gains that give the surroundings of a vertex the stored band sizes; `null` if none are stored. */
  async gainsAt(vertex: number, radius: number): Promise<number[] | null> {
    const { pickedRms, studio } = this;
    if (!pickedRms || pickedRms.length !== studio.nLevels) return null;
    const { rms } = await studio.engine.call('energy', { key: null, vertex, radius });
    return matchingGains(pickedRms, rms);
  }
}
