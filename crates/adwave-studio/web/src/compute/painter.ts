/** The masks of the layers, and the brush that changes them. */

import type { Region } from '../protocol';
import { Before } from './before';
import { packBefore, unpackBefore } from './delta';
import type { BrushShape, RegionNews } from './messages';
import { nearestVertex } from './pick';
import { facingWeight, type Ground, isLocal, maskOf, toByte, visitStroke, weightAt } from './regions';
import { SurfaceSearch } from './search';

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
  before: Before;
  brush: BrushShape;
  /** Which vertices it may touch, from 0 to 1. */
  toward: ((v: number) => number) | null;
  /** What a stroke that smooths leads to. */
  smoothed: Uint8Array | null;
}

/** Which region a stroke was painted on to make this one, and what leads back to it. */
interface Step {
  parent: number;
  /** Forgotten where there are too many: then the mask is computed anew. */
  undo: Uint8Array | null;
}

/** Bytes kept for undo, at the least and a stroke. */
const UNDO_LEAST = 256 << 10;
const UNDO_EACH = 8 << 10;

export class Painter {
  private readonly masks = new Map<number, LayerMask>();
  private readonly regions = new Map<number, Region>();
  private readonly steps = new Map<number, Step>();
  private undoBytes = 0;
  private stroke: Stroke | null = null;
  private beforeOnce: Before | null = null;
  private smoothed: { key: number; bytes: Uint8Array } | null = null;
  /** Distances from all stamps of the stroke, beside what else is measured meanwhile. */
  private searchOnce: SurfaceSearch | null = null;

  constructor(
    private readonly ground: Ground,
    /** Relative to the center of the page's shape. */
    private readonly positions: Float32Array,
    private readonly tell: Tell,
  ) {}

  /** Regions by number: whole, or as one stroke more than another has, whose strokes it shares. */
  learn(regions: readonly RegionNews[]): void {
    for (const [id, what] of regions) {
      if (!('extends' in what)) {
        this.regions.set(id, what);
        continue;
      }
      const parent = this.regions.get(what.extends);
      if (!parent || !('painted' in parent))
        throw new Error('A region was lost on its way. Load the page again.');
      this.regions.set(id, { painted: [...parent.painted, what.stroke] });
      const undo = this.steps.get(id)?.undo ?? null;
      this.steps.set(id, { parent: what.extends, undo });
    }
  }

  mask(key: number): Uint8Array | null {
    return this.masks.get(key)?.bytes ?? null;
  }

  /** Bytes that undo takes here, beside the strokes themselves. */
  get undoSize(): number {
    return this.undoBytes;
  }

  /** Forgets the masks of layers that are gone. */
  keepOnly(keys: ReadonlySet<number>): void {
    for (const key of this.masks.keys()) if (!keys.has(key)) this.masks.delete(key);
  }

  /** Makes the mask of a layer that of `region`: one stroke forth or back where that is known, else from scratch. */
  async show(key: number, region: number): Promise<void> {
    if (this.stroke?.key === key) return; // being painted: its end says what it is
    const mask = this.masks.get(key);
    if (mask?.region === region) return;
    if (mask && (this.redo(key, mask, region) || this.undo(key, mask, region))) return;
    const what = this.regions.get(region);
    if (!what) throw new Error('A region was lost on its way. Load the page again.');
    const bytes = await maskOf(what, this.ground);
    this.masks.set(key, { region, bytes });
    this.tell(key, 0, bytes.slice());
  }

  private redo(key: number, mask: LayerMask, region: number): boolean {
    const step = this.steps.get(region);
    const what = this.regions.get(region);
    if (step?.parent !== mask.region || !what || !('painted' in what)) return false;
    const stroke = what.painted.at(-1)!;
    if (!isLocal({ painted: [stroke] }, this.ground)) return false;
    const adds = 'add' in stroke;
    const { bytes } = mask;
    const range = new Range();
    visitStroke(stroke, this.ground, (v, w) => {
      const value = toByte(adds ? w : 1 - w);
      if (adds ? value <= bytes[v]! : value >= bytes[v]!) return;
      bytes[v] = value;
      range.add(v);
    });
    mask.region = region;
    range.tell(this.tell, key, bytes);
    return true;
  }

  private undo(key: number, mask: LayerMask, region: number): boolean {
    const step = this.steps.get(mask.region);
    if (step?.parent !== region || !step.undo) return false;
    const { entries } = this.ground.surface.members;
    const range = new Range();
    unpackBefore(step.undo, (rank, value) => {
      const v = entries[rank]!;
      mask.bytes[v] = value;
      range.add(v);
    });
    mask.region = region;
    range.tell(this.tell, key, mask.bytes);
    return true;
  }

  /** Before a stroke that smooths: what the mask is, blurred. */
  async prepareSmoothing(key: number, region: number, by: number): Promise<void> {
    const what = this.regions.get(region);
    if (what) this.smoothed = { key, bytes: await this.ground.ask({ blurred: { by, region: what } }) };
  }

  /** Stamps the brush at `vertices`, each once a stroke. How many were new. */
  stamp(key: number, vertices: readonly number[], brush: BrushShape): number {
    if (this.stroke?.key !== key) this.begin(key, brush);
    const stroke = this.stroke!;
    const { bytes } = this.masks.get(key)!;
    this.searchOnce ??= new SurfaceSearch(this.ground.surface);
    const search = this.searchOnce;
    const all = [...vertices];
    if (brush.mirror !== null) for (const v of vertices) all.push(this.mirrored(v, brush.mirror));
    const fresh = new Set(all.filter((v) => !stroke.stamped.has(v)));
    if (fresh.size === 0) return 0;
    const stamps = [...fresh];
    // What an earlier stamp is nearer to has its weight already.
    if (stroke.indices.length === 0) search.run(stamps, stroke.brush.radius);
    else search.add(stamps, stroke.brush.radius);
    for (const v of stamps) {
      stroke.stamped.add(v);
      stroke.indices.push(v);
    }
    const range = new Range();
    for (let i = 0; i < search.nReached; i++) {
      const v = search.reached[i]!;
      if (touch(stroke, bytes, v, search.distance(v))) range.add(v);
    }
    range.tell(this.tell, key, bytes);
    return fresh.size;
  }

  private begin(key: number, brush: BrushShape): void {
    if (this.stroke) this.cancel();
    if (!this.masks.has(key)) this.masks.set(key, { region: -1, bytes: new Uint8Array(this.ground.n) });
    this.beforeOnce ??= new Before(this.ground.n);
    this.beforeOnce.clear();
    this.stroke = {
      key,
      indices: [],
      stamped: new Set(),
      before: this.beforeOnce,
      brush,
      toward: brush.facing && this.ground.local ? facingWeight(brush.facing, this.ground) : null,
      smoothed: brush.mode === 'smooth' && this.smoothed?.key === key ? this.smoothed.bytes : null,
    };
  }

  private mirrored(v: number, at: number): number {
    const p = this.positions;
    return nearestVertex(p, 2 * at - p[3 * v]!, p[3 * v + 1]!, p[3 * v + 2]!);
  }

  /**
   * Ends the stroke: all stamps in one search, as the server replays it, since a straight line over two edges may begin
   * at another stamp. `child` names the region that the mask then has.
   */
  end(child: number): number[] {
    const { stroke, ground } = this;
    const { search } = ground;
    if (!stroke) return [];
    const mask = this.masks.get(stroke.key)!;
    const { bytes } = mask;
    stroke.before.restore(bytes);
    search.run(stroke.indices, stroke.brush.radius);
    for (let i = 0; i < search.nReached; i++) {
      const v = search.reached[i]!;
      touch(stroke, bytes, v, search.distance(v));
    }
    // Where only the server knows the outcome, it is asked for the mask as it will be.
    const known = ground.local && stroke.brush.mode !== 'smooth';
    if (mask.region >= 0 && known) this.remember(child, stroke, bytes);
    mask.region = known ? child : -1;
    const range = new Range();
    for (const v of stroke.before.touched) range.add(v);
    this.stroke = null;
    range.tell(this.tell, stroke.key, bytes);
    return stroke.indices;
  }

  /** What undoes the stroke; older ones are forgotten where all take too much. */
  private remember(child: number, stroke: Stroke, after: Uint8Array): void {
    const { members, places } = this.ground.surface;
    const ranks: number[] = [];
    for (const v of stroke.before.touched) {
      if (stroke.before.value(v, 0) === after[v]) continue;
      let rank = members.offsets[places[v]!]!;
      while (members.entries[rank] !== v) rank++;
      ranks.push(rank);
    }
    const sorted = Uint32Array.from(ranks).sort();
    const undo = packBefore(sorted, (i) => stroke.before.value(members.entries[sorted[i]!]!, 0));
    const parent = this.masks.get(stroke.key)!.region;
    this.steps.set(child, { parent, undo });
    this.undoBytes += undo.length;
    const most = Math.max(UNDO_LEAST, UNDO_EACH * this.steps.size);
    for (const step of this.steps.values()) {
      if (this.undoBytes <= most) break;
      this.undoBytes -= step.undo?.length ?? 0;
      step.undo = null;
    }
  }

  cancel(): void {
    const { stroke } = this;
    if (!stroke) return;
    this.stroke = null;
    const mask = this.masks.get(stroke.key)!;
    stroke.before.restore(mask.bytes);
    this.tell(stroke.key, 0, mask.bytes.slice());
  }
}

/** The vertices between the first and the last that changed. */
class Range {
  private first = Infinity;
  private last = -1;

  add(v: number): void {
    if (v < this.first) this.first = v;
    if (v > this.last) this.last = v;
  }

  tell(tell: Tell, key: number, bytes: Uint8Array): void {
    if (this.last >= this.first) tell(key, this.first, bytes.slice(this.first, this.last + 1));
  }
}

/** Changes the mask at one vertex; false where the stroke changes nothing there. */
function touch(stroke: Stroke, bytes: Uint8Array, v: number, distance: number): boolean {
  const { radius, falloff, strength, mode } = stroke.brush;
  let weight = weightAt(distance, radius, falloff);
  if (stroke.toward) weight = Math.min(weight, stroke.toward(v));
  const w = strength * weight;
  const now = bytes[v]!;
  let value: number;
  if (mode === 'smooth') {
    // A preview, until the server says it: from what was there toward what is blurred.
    const before = stroke.before.value(v, now);
    const there = stroke.smoothed?.[v] ?? before;
    value = Math.round(before + w * (there - before));
    if (Math.abs(value - before) <= Math.abs(now - before)) return false;
  } else {
    value = toByte(mode === 'subtract' ? 1 - w : w);
    if (mode === 'subtract' ? value >= now : value <= now) return false;
  }
  stroke.before.keep(v, now);
  bytes[v] = value;
  return true;
}
