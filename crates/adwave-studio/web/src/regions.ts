/** Regions by number: the worker is sent each once, and of a painted one that has a stroke more only the stroke. */

import type { RegionNews } from './compute/messages';
import type { Region } from './protocol';

export class Regions {
  private readonly ids = new WeakMap<Region, number>();
  /** Which region a stroke was painted on. */
  private readonly parents = new WeakMap<Region, Region>();
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

  /** `child` is `parent` with one stroke more. */
  follows(child: Region, parent: Region): void {
    this.parents.set(child, parent);
  }

  /** The numbers of some regions, and what the worker does not know of them yet. */
  newsOf(regions: readonly (Region | null)[]): { news: RegionNews[]; ids: (number | null)[] } {
    const news: RegionNews[] = [];
    const ids = regions.map((region) => {
      if (!region) return null;
      const id = this.id(region);
      if (!this.sent.has(id)) news.push([id, this.told(region)]);
      this.sent.add(id);
      return id;
    });
    return { news, ids };
  }

  private told(region: Region): RegionNews[1] {
    const parent = this.parents.get(region);
    if (!parent || !('painted' in parent) || !('painted' in region)) return region;
    const known = this.id(parent);
    return this.sent.has(known) ? { extends: known, stroke: region.painted.at(-1)! } : region;
  }

  /** The worker does not know these, or none at all. */
  forget(news?: readonly RegionNews[]): void {
    if (!news) this.sent = new Set();
    for (const [id] of news ?? []) this.sent.delete(id);
  }
}
