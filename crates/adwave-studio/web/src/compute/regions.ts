/** Weights of the regions that the page computes itself. */

import { toModelUnits } from '../lengths';
import type { BrushStroke, Region } from '../protocol';
import type { SurfaceSearch } from './search';
import type { Surface } from './surface';

/** 6t⁵ − 15t⁴ + 10t³ of t clamped to [0, 1]. */
export function smoothstep(t: number): number {
  const s = t < 0 ? 0 : Math.min(t, 1);
  return s * s * s * (s * (6 * s - 15) + 10);
}

/** Weight at `distance` from a source: 0 at `radius`, rising to 1 at `radius − falloff`. */
export function weightAt(distance: number, radius: number, falloff: number): number {
  if (distance === 0) return 1;
  if (distance > radius) return 0;
  return falloff > 0 ? smoothstep((radius - distance) / falloff) : 1;
}

/** Data from which the weights of a region are computed. */
export interface RegionContext {
  n: number;
  diagonal: number;
  /** Positions in double precision, as in the file. */
  surface: Surface;
  search: SurfaceSearch;
  /** Normals of the welded points. */
  normals: Float64Array;
  /** True if distances equal those of the server: on meshes, but not on clouds, where the server has its own graph. */
  local: boolean;
  /** Fetches the mask of a region from the server. */
  ask: (region: Region) => Promise<Uint8Array>;
}

/** True if the page computes a region itself, bit-identical to the server. */
export function isLocal(region: Region, ground: RegionContext): boolean {
  const inner = (r: Region) => isLocal(r, ground);
  if (!ground.local) return false;
  if ('any' in region) return region.any.every(inner);
  if ('all' in region) return region.all.every(inner);
  if ('not' in region) return inner(region.not);
  if ('faded' in region) return inner(region.faded.region);
  if ('painted' in region)
    return region.painted.every((s) => ('add' in s ? inner(s.add) : 'subtract' in s && inner(s.subtract)));
  return 'vertices' in region || 'facing' in region || 'box' in region || 'half-space' in region;
}

/** Computes the mask of a region, 255 · w rounded; fetches it from the server if necessary. */
export async function computeMask(region: Region, ground: RegionContext): Promise<Uint8Array> {
  return isLocal(region, ground) ? toBytes(weights(region, ground)) : ground.ask(region);
}

/** Calls `see` with the nonzero weights of a sparse region; returns false if the region is not sparse. */
export function visitSparse(
  region: Region,
  ground: RegionContext,
  see: (v: number, w: number) => void,
  factor = 1,
): boolean {
  if ('faded' in region) return visitSparse(region.faded.region, ground, see, factor * region.faded.factor);
  if ('all' in region) {
    const [first, ...rest] = region.all;
    if (!first || !rest.every((r) => 'facing' in r)) return false;
    const toward = rest.map((r) => facingWeight(r.facing, ground));
    return visitSparse(first, ground, (v, w) => {
      let least = w;
      for (const weight of toward) least = Math.min(least, weight(v));
      if (least > 0) see(v, factor * least);
    });
  }
  if (!('vertices' in region)) return false;
  const { search } = ground;
  const radius = toModelUnits(region.vertices.radius, ground.diagonal);
  const falloff = Math.min(radius, toModelUnits(region.vertices.falloff ?? radius, ground.diagonal));
  search.run(
    region.vertices.indices.filter((v) => v < ground.n),
    radius,
  );
  for (let i = 0; i < search.nReached; i++) {
    const v = search.reached[i]!;
    const w = weightAt(search.distance(v), radius, falloff);
    if (w > 0) see(v, factor * w);
  }
  return true;
}

/** Computes the weights of a local region at every vertex, in [0, 1]. */
export function weights(region: Region, ground: RegionContext): Float64Array {
  if ('any' in region) return combine(region.any, ground, 0, Math.max);
  if ('all' in region) return combine(region.all, ground, 1, Math.min);
  if ('painted' in region) return paintedWeights(region.painted, ground);
  if ('not' in region) {
    const w = weights(region.not, ground);
    for (let v = 0; v < w.length; v++) w[v] = 1 - w[v]!;
    return w;
  }
  if ('faded' in region) {
    const w = weights(region.faded.region, ground);
    const f = region.faded.factor;
    for (let v = 0; v < w.length; v++) w[v]! *= f;
    return w;
  }
  const out = new Float64Array(ground.n);
  const sparse = visitSparse(region, ground, (v, w) => {
    out[v] = w;
  });
  if (sparse) return out;
  if ('facing' in region) {
    const weight = facingWeight(region.facing, ground);
    for (let v = 0; v < out.length; v++) out[v] = weight(v);
    return out;
  }
  if ('box' in region) return boxWeights(region.box, ground, out);
  if ('half-space' in region) return halfSpaceWeights(region['half-space'], ground, out);
  throw new Error(`The page cannot compute a region of kind ${Object.keys(region)[0]}.`);
}

/** Returns the rule that combines the previous value and the weight of a stroke, both in [0, 1]. */
function strokeRule(stroke: BrushStroke): (there: number, w: number) => number {
  return 'add' in stroke ? (there, w) => Math.max(there, w) : (there, w) => Math.min(there, 1 - w);
}

/** Applies strokes in order, starting from 0; each changes only the vertices that it reaches. */
function paintedWeights(strokes: readonly BrushStroke[], ground: RegionContext): Float64Array {
  const out = new Float64Array(ground.n);
  for (const stroke of strokes) {
    const join = strokeRule(stroke);
    visitStroke(stroke, ground, (v, w) => {
      out[v] = join(out[v]!, w);
    });
  }
  return out;
}

/** Calls `see` with the weight of the region of a stroke, at least where it is not 0. */
export function visitStroke(
  stroke: BrushStroke,
  ground: RegionContext,
  see: (v: number, w: number) => void,
): void {
  const region = 'add' in stroke ? stroke.add : 'subtract' in stroke ? stroke.subtract : null;
  if (!region) throw new Error('Softening strokes are computed by the server.');
  if (visitSparse(region, ground, see)) return;
  const w = weights(region, ground);
  for (let v = 0; v < w.length; v++) see(v, w[v]!);
}

function combine(
  regions: readonly Region[],
  ground: RegionContext,
  empty: number,
  pick: (a: number, b: number) => number,
): Float64Array {
  const out = new Float64Array(ground.n).fill(empty);
  for (const region of regions) {
    const w = weights(region, ground);
    for (let v = 0; v < w.length; v++) out[v] = pick(out[v]!, w[v]!);
  }
  return out;
}

/** S(n·d / (|d| falloff)) with the normal n at a vertex. */
export function facingWeight(
  facing: { direction: readonly number[]; falloff?: number },
  ground: RegionContext,
): (v: number) => number {
  const [a, b, c] = facing.direction as [number, number, number];
  const length = Math.sqrt(a * a + b * b + c * c);
  const [x, y, z] = [a / length, b / length, c / length];
  const falloff = facing.falloff ?? 0;
  const { normals } = ground;
  const { places } = ground.surface;
  return (v) => {
    const i = 3 * places[v]!;
    const cosine = x * normals[i]! + y * normals[i + 1]! + z * normals[i + 2]!;
    return falloff > 0 ? smoothstep(cosine / falloff) : cosine > 0 ? 1 : 0;
  };
}

function boxWeights(
  box: { min: number[]; max: number[]; falloff?: number | string },
  ground: RegionContext,
  out: Float64Array,
): Float64Array {
  const { places, points } = ground.surface;
  const falloff = toModelUnits(box.falloff ?? '5%', ground.diagonal);
  for (let v = 0; v < ground.n; v++) {
    let inside = Infinity;
    for (let c = 0; c < 3; c++) {
      const x = points[3 * places[v]! + c]!;
      inside = Math.min(inside, x - box.min[c]!, box.max[c]! - x);
    }
    out[v] = inside < 0 ? 0 : falloff > 0 ? smoothstep(inside / falloff) : 1;
  }
  return out;
}

function halfSpaceWeights(
  half: { point: number[]; normal: number[]; falloff?: number | string },
  ground: RegionContext,
  out: Float64Array,
): Float64Array {
  const { places, points } = ground.surface;
  const [a, b, c] = half.normal as [number, number, number];
  const length = Math.sqrt(a * a + b * b + c * c);
  const [x, y, z] = [a / length, b / length, c / length];
  const [px, py, pz] = half.point as [number, number, number];
  const falloff = toModelUnits(half.falloff ?? '5%', ground.diagonal);
  for (let v = 0; v < ground.n; v++) {
    const i = 3 * places[v]!;
    const d = x * (points[i]! - px) + y * (points[i + 1]! - py) + z * (points[i + 2]! - pz);
    out[v] = d < 0 ? 0 : falloff > 0 ? smoothstep(d / falloff) : 1;
  }
  return out;
}

/** Rounds 255 w. */
export function toByte(w: number): number {
  return Math.round(255 * w);
}

export function toBytes(w: Float64Array): Uint8Array {
  const bytes = new Uint8Array(w.length);
  for (let v = 0; v < w.length; v++) bytes[v] = toByte(w[v]!);
  return bytes;
}
