/** Masks of the layers, and the brush that changes them. */

import type { Region } from '../protocol';
import { MaskBackup } from './mask-backup';
import type { BrushShape, RegionUpdate } from './messages';
import { nearestVertex } from './pick';
import {
  computeMask,
  facingWeight,
  isLocal,
  type RegionContext,
  toByte,
  visitStroke,
  weightAt,
} from './regions';
import { SurfaceSearch } from './search';
import { packBefore, unpackBefore } from './undo-packing';

/** Reports values of a mask from vertex `from` on to the page. */
type ReportMask = (key: number, from: number, bytes: Uint8Array) => void;

interface LayerMask {
  region: number;
  bytes: Uint8Array;
}

interface Stroke {
  key: number;
  indices: number[];
  stamped: Set<number>;
  before: MaskBackup;
  brush: BrushShape;
  /** Weight by which a vertex may be changed, in [0, 1]. */
  toward: ((v: number) => number) | null;
  /** Blurred mask that a softening stroke leads to. */
  smoothed: Uint8Array | null;
}

/** Region that the last stroke was appended to, and the data that undoes the stroke. */
interface Step {
  parent: number;
  /** Packed undo data; `null` if it was discarded and the mask must be recomputed. */
  undo: Uint8Array | null;
}

/** Budget for undo data in bytes: in total and per stroke. */
const UNDO_LEAST = 256 << 10;
const UNDO_EACH = 8 << 10;

export class Painter {
  private readonly masks = new Map<number, LayerMask>();
  private readonly regions = new Map<number, Region>();
  private readonly steps = new Map<number, Step>();
  private undoBytes = 0;
  private stroke: Stroke | null = null;
  private beforeOnce: MaskBackup | null = null;
  private smoothedMask: { key: number; bytes: Uint8Array } | null = null;
  /** Distances from all stamps of the current stroke, independent of other searches. */
  private searchOnce: SurfaceSearch | null = null;

  constructor(
    private readonly ground: RegionContext,
    /** Positions relative to the center of the shape. */
    private readonly positions: Float32Array,
    private readonly reportMask: ReportMask,
  ) {}

  /** Regions by number; appended strokes share the strokes of their parent. */
  updateRegions(regions: readonly RegionUpdate[]): void {
    for (const [id, what] of regions) {
      if (!('extends' in what)) {
        this.regions.set(id, what);
        continue;
      }
      const parent = this.regions.get(what.extends);
      if (!parent || !('painted' in parent))
        throw new Error('A region is missing in the worker. Reload the page.');
      this.regions.set(id, { painted: [...parent.painted, what.stroke] });
      const undo = this.steps.get(id)?.undo ?? null;
      this.steps.set(id, { parent: what.extends, undo });
    }
  }

  mask(key: number): Uint8Array | null {
    return this.masks.get(key)?.bytes ?? null;
  }

  /** Size of the undo data in bytes, without the strokes. */
  get undoSize(): number {
    return this.undoBytes;
  }

  /** Discards the masks of deleted layers, except that of a stroke, which may still end or be given up. */
  retainLayers(keys: ReadonlySet<number>): void {
    for (const key of this.masks.keys())
      if (!keys.has(key) && key !== this.stroke?.key) this.masks.delete(key);
  }

  /** Updates the mask of a layer to `region`: by one stroke forward or back if possible, otherwise from scratch. */
  async show(key: number, region: number): Promise<void> {
    if (this.stroke?.key === key) return; // updated at the end of the stroke
    const mask = this.masks.get(key);
    if (mask?.region === region) return;
    if (mask && (this.redo(key, mask, region) || this.undo(key, mask, region))) return;
    const what = this.regions.get(region);
    if (!what) throw new Error('A region is missing in the worker. Reload the page.');
    const bytes = await computeMask(what, this.ground);
    this.masks.set(key, { region, bytes });
    this.reportMask(key, 0, bytes.slice());
  }

  private redo(key: number, mask: LayerMask, region: number): boolean {
    const step = this.steps.get(region);
    const what = this.regions.get(region);
    if (step?.parent !== mask.region || !what || !('painted' in what)) return false;
    const stroke = what.painted.at(-1)!;
    if (!isLocal({ painted: [stroke] }, this.ground)) return false;
    const adds = 'add' in stroke;
    const { bytes } = mask;
    const range = new ChangedRange();
    visitStroke(stroke, this.ground, (v, w) => {
      const value = toByte(adds ? w : 1 - w);
      if (adds ? value <= bytes[v]! : value >= bytes[v]!) return;
      bytes[v] = value;
      range.add(v);
    });
    mask.region = region;
    range.report(this.reportMask, key, bytes);
    return true;
  }

  private undo(key: number, mask: LayerMask, region: number): boolean {
    const step = this.steps.get(mask.region);
    if (step?.parent !== region || !step.undo) return false;
    const { entries } = this.ground.surface.members;
    const range = new ChangedRange();
    unpackBefore(step.undo, (rank, value) => {
      const v = entries[rank]!;
      mask.bytes[v] = value;
      range.add(v);
    });
    mask.region = region;
    range.report(this.reportMask, key, mask.bytes);
    return true;
  }

  /** Computes the blurred mask for a softening stroke. */
  async prepareSmoothing(key: number, region: number, by: number): Promise<void> {
    const what = this.regions.get(region);
    if (what) this.smoothedMask = { key, bytes: await this.ground.ask({ blurred: { by, region: what } }) };
  }

  /** Stamps the brush at `vertices`, each once per stroke; returns the number of new ones. */
  stamp(key: number, vertices: readonly number[], brush: BrushShape): number {
    if (this.stroke?.key !== key) this.beginStroke(key, brush);
    const stroke = this.stroke!;
    const { bytes } = this.masks.get(key)!;
    this.searchOnce ??= new SurfaceSearch(this.ground.surface);
    const search = this.searchOnce;
    const all = [...vertices];
    if (brush.mirror !== null) for (const v of vertices) all.push(this.mirroredVertex(v, brush.mirror));
    const fresh = new Set(all.filter((v) => !stroke.stamped.has(v)));
    if (fresh.size === 0) return 0;
    const stamps = [...fresh];
    // Vertices nearer to an earlier stamp have their weight already.
    if (stroke.indices.length === 0) search.run(stamps, stroke.brush.radius);
    else search.add(stamps, stroke.brush.radius);
    for (const v of stamps) {
      stroke.stamped.add(v);
      stroke.indices.push(v);
    }
    const range = new ChangedRange();
    for (let i = 0; i < search.nReached; i++) {
      const v = search.reached[i]!;
      if (paintVertex(stroke, bytes, v, search.distance(v))) range.add(v);
    }
    range.report(this.reportMask, key, bytes);
    return fresh.size;
  }

  private beginStroke(key: number, brush: BrushShape): void {
    if (this.stroke) this.cancel();
    if (!this.masks.has(key)) this.masks.set(key, { region: -1, bytes: new Uint8Array(this.ground.n) });
    this.beforeOnce ??= new MaskBackup(this.ground.n);
    this.beforeOnce.clear();
    this.stroke = {
      key,
      indices: [],
      stamped: new Set(),
      before: this.beforeOnce,
      brush,
      toward: brush.facing && this.ground.local ? facingWeight(brush.facing, this.ground) : null,
      smoothed: brush.mode === 'smooth' && this.smoothedMask?.key === key ? this.smoothedMask.bytes : null,
    };
  }

  private mirroredVertex(v: number, at: number): number {
    const p = this.positions;
    return nearestVertex(p, 2 * at - p[3 * v]!, p[3 * v + 1]!, p[3 * v + 2]!);
  }

  /**
   * Ends the stroke. All stamps are searched at once, as the server replays them, because where two stamps
   * are equally near, the front may come from either. `child` is the number of the resulting region.
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
      paintVertex(stroke, bytes, v, search.distance(v));
    }
    // If only the server can compute the result, the mask is fetched later.
    const known = ground.local && stroke.brush.mode !== 'smooth';
    if (mask.region >= 0 && known) this.storeUndo(child, stroke, bytes);
    mask.region = known ? child : -1;
    const range = new ChangedRange();
    for (const v of stroke.before.changedVertices) range.add(v);
    this.stroke = null;
    range.report(this.reportMask, stroke.key, bytes);
    return stroke.indices;
  }

  /** Stores the undo data of a stroke; discards the oldest data beyond the budget. */
  private storeUndo(child: number, stroke: Stroke, after: Uint8Array): void {
    const { members, places } = this.ground.surface;
    const ranks: number[] = [];
    for (const v of stroke.before.changedVertices) {
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
    this.reportMask(stroke.key, 0, mask.bytes.slice());
  }
}

/** Range from the first to the last changed vertex. */
class ChangedRange {
  private first = Infinity;
  private last = -1;

  add(v: number): void {
    if (v < this.first) this.first = v;
    if (v > this.last) this.last = v;
  }

  report(tell: ReportMask, key: number, bytes: Uint8Array): void {
    if (this.last >= this.first) tell(key, this.first, bytes.slice(this.first, this.last + 1));
  }
}

/** Applies the stroke at one vertex; returns false if nothing changes. */
function paintVertex(stroke: Stroke, bytes: Uint8Array, v: number, distance: number): boolean {
  const { radius, falloff, strength, mode } = stroke.brush;
  let weight = weightAt(distance, radius, falloff);
  if (stroke.toward) weight = Math.min(weight, stroke.toward(v));
  const w = strength * weight;
  const now = bytes[v]!;
  let value: number;
  if (mode === 'smooth') {
    // Preview until the server computes the mask: from the previous value toward the blurred one.
    const before = stroke.before.value(v, now);
    const there = stroke.smoothed?.[v] ?? before;
    value = Math.round(before + w * (there - before));
    if (Math.abs(value - before) <= Math.abs(now - before)) return false;
  } else {
    value = toByte(mode === 'subtract' ? 1 - w : w);
    if (mode === 'subtract' ? value >= now : value <= now) return false;
  }
  stroke.before.saveValue(v, now);
  bytes[v] = value;
  return true;
}
