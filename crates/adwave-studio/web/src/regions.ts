/** Numbering of regions: each is sent to the worker once, and an appended stroke is sent alone. */

import type { RegionUpdate } from './compute/messages';
import type { Region } from './protocol';

export class Regions {
  private readonly ids = new WeakMap<Region, number>();
  /** Region that the last stroke was appended to. */
  private readonly strokeParents = new WeakMap<Region, Region>();
  private n = 0;
  private sent = new Set<number>();

  id(region: Region): number {
    let id = this.ids.get(region);
    if (id === undefined) {
      id = ++this.n;
      this.ids.set(region, id);
    }
    return id;
  }

  /** Registers that `child` is `parent` with one stroke appended. */
  registerStroke(child: Region, parent: Region): void {
    this.strokeParents.set(child, parent);
  }

  /** Returns the numbers of regions, and the updates that the worker needs. */
  updatesFor(regions: readonly (Region | null)[]): { updates: RegionUpdate[]; ids: (number | null)[] } {
    const updates: RegionUpdate[] = [];
    const ids = regions.map((region) => {
      if (!region) return null;
      const id = this.id(region);
      if (!this.sent.has(id)) updates.push([id, this.encodeUpdate(region)]);
      this.sent.add(id);
      return id;
    });
    return { updates, ids };
  }

  private encodeUpdate(region: Region): RegionUpdate[1] {
    const parent = this.strokeParents.get(region);
    if (!parent || !('painted' in parent) || !('painted' in region)) return region;
    const known = this.id(parent);
    return this.sent.has(known) ? { extends: known, stroke: region.painted.at(-1)! } : region;
  }

  /** Marks updates as not received by the worker; all of them if none are given. */
  markUnknown(updates?: readonly RegionUpdate[]): void {
    if (!updates) this.sent = new Set();
    for (const [id] of updates ?? []) this.sent.delete(id);
  }
}
