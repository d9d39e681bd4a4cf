/** The masks of the layers, and the brush that changes them. */

import type { Region } from '../protocol';
import { applyDelta, type MaskDelta, packDelta } from './delta';
import type { BrushShape } from './messages';
import { nearestVertex } from './pick';
import { type Ground, toBytes, weightAt, weights } from './regions';

/** What is told to the page: `bytes` are the mask's values from vertex `from` on. */
type Tell = (key: number, from: number, bytes: Uint8Array) => void;

interface LayerMask {
  region: number;
  bytes: Uint8Array;
}

interface Stroke {
  key: number;
  indices: number[];
  stamped: Set<number>;
  /** Value before the stroke at each vertex that it touched. */
  before: Map<number, number>;
  brush: BrushShape;
}

export class Painter {
  private readonly masks = new Map<number, LayerMask>();
  private readonly regions = new Map<number, Region>();
  /** What leads from a region to the one that a stroke made of it. */
  private readonly steps = new Map<number, { parent: number; delta: MaskDelta }>();
  private stroke: Stroke | null = null;

  constructor(
    private readonly ground: Ground,
    private readonly tell: Tell,
  ) {}

  learn(regions: readonly [number, Region][]): void {
    for (const [id, region] of regions) this.regions.set(id, region);
  }

  mask(key: number): Uint8Array | null {
    return this.masks.get(key)?.bytes ?? null;
  }

  /** Forgets the masks of layers that are gone. */
  keepOnly(keys: ReadonlySet<number>): void {
    for (const key of this.masks.keys()) if (!keys.has(key)) this.masks.delete(key);
  }

  /** Makes the mask of a layer that of `region`: one stroke forth or back by what it changed, else from scratch. */
  async show(key: number, region: number): Promise<void> {
    if (this.stroke?.key === key) return; // being painted: its end says what it is
    const mask = this.masks.get(key);
    if (mask?.region === region) return;
    if (mask) {
      const forth = this.steps.get(region);
      const back = this.steps.get(mask.region);
      const delta = forth?.parent === mask.region ? forth.delta : back?.parent === region ? back.delta : null;
      if (delta) {
        mask.region = region;
        const range = applyDelta(mask.bytes, delta);
        if (range) this.tell(key, range[0], mask.bytes.slice(...range));
        return;
      }
    }
    const what = this.regions.get(region);
    if (!what) throw new Error('A region was lost on its way. Load the page again.');
    const bytes = toBytes(await weights(what, this.ground));
    this.masks.set(key, { region, bytes });
    this.tell(key, 0, bytes.slice());
  }

  /** Stamps the brush at `vertices`, each once a stroke. How many were new. */
  stamp(key: number, vertices: readonly number[], brush: BrushShape): number {
    const search = this.ground.search;
    if (this.stroke?.key !== key) {
      if (this.stroke) this.cancel();
      this.stroke = { key, indices: [], stamped: new Set(), before: new Map(), brush };
    }
    let mask = this.masks.get(key);
    if (!mask) {
      mask = { region: -1, bytes: new Uint8Array(this.ground.n) };
      this.masks.set(key, mask);
    }
    const stroke = this.stroke;
    const all = [...vertices];
    if (brush.mirror !== null) for (const v of vertices) all.push(this.mirrored(v, brush.mirror));
    let first = this.ground.n;
    let last = -1;
    let stamped = 0;
    for (const v of all) {
      if (stroke.stamped.has(v)) continue;
      stroke.stamped.add(v);
      stroke.indices.push(v);
      stamped++;
      search.run([v], brush.radius);
      for (let i = 0; i < search.nReached; i++) {
        const w = search.reached[i]!;
        if (!touch(stroke, mask.bytes, w, search.distance(w))) continue;
        if (w < first) first = w;
        if (w > last) last = w;
      }
    }
    if (last >= first) this.tell(key, first, mask.bytes.slice(first, last + 1));
    return stamped;
  }

  private mirrored(v: number, at: number): number {
    const p = this.ground.positions;
    return nearestVertex(p, 2 * at - p[3 * v]!, p[3 * v + 1]!, p[3 * v + 2]!);
  }

  /**
   * Ends the stroke: all stamps in one search, as the server replays it, since a straight line over two edges may begin
   * at another stamp. `child` names the region that the mask then has.
   */
  end(child: number): number[] {
    const stroke = this.stroke;
    const search = this.ground.search;
    if (!stroke) return [];
    const mask = this.masks.get(stroke.key)!;
    const { bytes } = mask;
    for (const [v, value] of stroke.before) bytes[v] = value;
    search.run(stroke.indices, stroke.brush.radius);
    for (let i = 0; i < search.nReached; i++) {
      const v = search.reached[i]!;
      touch(stroke, bytes, v, search.distance(v));
    }
    const touched = Uint32Array.from(stroke.before.keys());
    const delta = packDelta(touched, (v) => stroke.before.get(v)!, bytes);
    if (mask.region >= 0 && this.ground.local) this.steps.set(child, { parent: mask.region, delta });
    // Where only the server knows the distances, it is asked for the mask as it will be.
    mask.region = this.ground.local ? child : -1;
    let first = this.ground.n;
    let last = -1;
    for (const v of touched) {
      if (v < first) first = v;
      if (v > last) last = v;
    }
    this.stroke = null;
    if (last >= first) this.tell(stroke.key, first, bytes.slice(first, last + 1));
    return stroke.indices;
  }

  cancel(): void {
    const stroke = this.stroke;
    if (!stroke) return;
    this.stroke = null;
    const mask = this.masks.get(stroke.key)!;
    for (const [v, value] of stroke.before) mask.bytes[v] = value;
    this.tell(stroke.key, 0, mask.bytes.slice());
  }
}

/** Changes the mask at one vertex; false where the stroke changes nothing there. */
function touch(stroke: Stroke, bytes: Uint8Array, v: number, distance: number): boolean {
  const { radius, falloff, strength, subtract } = stroke.brush;
  const w = strength * weightAt(distance, radius, falloff);
  const value = Math.round(255 * (subtract ? 1 - w : w));
  const now = bytes[v]!;
  if (subtract ? value >= now : value <= now) return false;
  if (!stroke.before.has(v)) stroke.before.set(v, now);
  bytes[v] = value;
  return true;
}
