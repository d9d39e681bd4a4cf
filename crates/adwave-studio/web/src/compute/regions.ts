/** Weights of a region, as far as the page can compute them itself. */

import { lengthOf } from '../lengths';
import type { BrushStroke, Region } from '../protocol';
import type { SurfaceSearch } from './search';

/** 6t⁵ − 15t⁴ + 10t³ of t clamped to [0, 1]. */
export function smoothstep(t: number): number {
  const s = t < 0 ? 0 : Math.min(t, 1);
  return s * s * s * (s * (6 * s - 15) + 10);
}

/** The weight at `distance` from a place: 0 at `radius`, risen to 1 at `radius − falloff`. */
export function weightAt(distance: number, radius: number, falloff: number): number {
  if (distance === 0) return 1;
  if (distance > radius) return 0;
  return falloff > 0 ? smoothstep((radius - distance) / falloff) : 1;
}

/** What a region's weights are computed from. */
export interface Ground {
  n: number;
  /** Relative to `centre`. */
  positions: Float32Array;
  centre: readonly number[];
  diagonal: number;
  search: SurfaceSearch;
  /** Whether distances of the page are those of the server: on meshes they are, of clouds it has its own graph. */
  local: boolean;
  /** Asks the server for the weights of a region that is not known here. */
  ask: (region: Region) => Promise<Uint8Array>;
}

/** A region that is 0 but for a few vertices: calls `see` with the weight of each of those. False where it is not so. */
export function visitSparse(
  region: Region,
  ground: Ground,
  see: (v: number, w: number) => void,
  factor = 1,
): boolean {
  if ('faded' in region) return visitSparse(region.faded.region, ground, see, factor * region.faded.factor);
  const search = ground.search;
  if (!ground.local) return false;
  let sources: number[];
  let radius: number;
  let falloff: number;
  if ('vertices' in region) {
    sources = region.vertices.indices;
    radius = lengthOf(region.vertices.radius, ground.diagonal);
    falloff = Math.min(radius, lengthOf(region.vertices.falloff ?? radius, ground.diagonal));
  } else return false;
  search.run(
    sources.filter((v) => v < ground.n),
    radius,
  );
  for (let i = 0; i < search.nReached; i++) {
    const v = search.reached[i]!;
    const w = weightAt(search.distance(v), radius, falloff);
    if (w > 0) see(v, factor * w);
  }
  return true;
}

/** The weights of a region at every vertex, in [0, 1]. */
export async function weights(region: Region, ground: Ground): Promise<Float32Array> {
  if ('any' in region) return combine(region.any, ground, 0, (a, b) => Math.max(b, a));
  if ('all' in region) return combine(region.all, ground, 1, (a, b) => Math.min(b, a));
  if ('painted' in region) return painted(region.painted, ground);
  if ('not' in region) {
    const w = await weights(region.not, ground);
    for (let v = 0; v < w.length; v++) w[v] = 1 - w[v]!;
    return w;
  }
  if ('faded' in region) {
    const w = await weights(region.faded.region, ground);
    const f = region.faded.factor;
    for (let v = 0; v < w.length; v++) w[v]! *= f;
    return w;
  }
  const out = new Float32Array(ground.n);
  if (
    visitSparse(region, ground, (v, w) => {
      out[v] = w;
    })
  ) {
    return out;
  }
  if ('box' in region) return boxWeights(region.box, ground, out);
  if ('half-space' in region) return halfSpaceWeights(region['half-space'], ground, out);
  const bytes = await ground.ask(region);
  for (let v = 0; v < out.length; v++) out[v] = bytes[v]! / 255;
  return out;
}

/** Strokes one after the other, from 0 everywhere; each touches only the vertices that it reaches. */
async function painted(strokes: readonly BrushStroke[], ground: Ground): Promise<Float32Array> {
  const out = new Float32Array(ground.n);
  for (const stroke of strokes) {
    const adds = 'add' in stroke;
    const region = adds ? stroke.add : stroke.subtract;
    const change = (v: number, w: number) => {
      if (adds ? w > out[v]! : 1 - w < out[v]!) out[v] = adds ? w : 1 - w;
    };
    if (visitSparse(region, ground, change)) continue;
    const w = await weights(region, ground);
    for (let v = 0; v < w.length; v++) change(v, w[v]!);
  }
  return out;
}

async function combine(
  regions: readonly Region[],
  ground: Ground,
  empty: number,
  pick: (a: number, b: number) => number,
): Promise<Float32Array> {
  const out = new Float32Array(ground.n).fill(empty);
  for (const region of regions) {
    const w = await weights(region, ground);
    for (let v = 0; v < w.length; v++) out[v] = pick(out[v]!, w[v]!);
  }
  return out;
}

function boxWeights(
  box: { min: number[]; max: number[]; falloff?: number | string },
  ground: Ground,
  out: Float32Array,
): Float32Array {
  const { positions, centre } = ground;
  const falloff = lengthOf(box.falloff ?? '5%', ground.diagonal);
  for (let v = 0; v < ground.n; v++) {
    let inside = Infinity;
    for (let c = 0; c < 3; c++) {
      const x = positions[3 * v + c]! + centre[c]!;
      inside = Math.min(inside, x - box.min[c]!, box.max[c]! - x);
    }
    out[v] = inside < 0 ? 0 : falloff > 0 ? smoothstep(inside / falloff) : 1;
  }
  return out;
}

function halfSpaceWeights(
  half: { point: number[]; normal: number[]; falloff?: number | string },
  ground: Ground,
  out: Float32Array,
): Float32Array {
  const { positions, centre } = ground;
  const [a, b, c] = half.normal as [number, number, number];
  const length = Math.hypot(a, b, c) || 1;
  const [px, py, pz] = half.point as [number, number, number];
  const falloff = lengthOf(half.falloff ?? '5%', ground.diagonal);
  for (let v = 0; v < ground.n; v++) {
    const d =
      (a * (positions[3 * v]! + centre[0]! - px) +
        b * (positions[3 * v + 1]! + centre[1]! - py) +
        c * (positions[3 * v + 2]! + centre[2]! - pz)) /
      length;
    out[v] = d < 0 ? 0 : falloff > 0 ? smoothstep(d / falloff) : 1;
  }
  return out;
}

/** 255 w, rounded. */
export function toBytes(w: Float32Array): Uint8Array {
  const bytes = new Uint8Array(w.length);
  for (let v = 0; v < w.length; v++) bytes[v] = Math.round(255 * w[v]!);
  return bytes;
}
