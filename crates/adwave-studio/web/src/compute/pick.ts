/** Picking: vertices in a thin cone around the ray, then the triangles around them. */

import { type ClipEquation, isClipped } from '../clip';
import type { Rows } from './adjacency';

export interface Ray {
  origin: readonly [number, number, number];
  /** Direction of length 1. */
  direction: readonly [number, number, number];
  /** Width of a pixel at distance 1, in model units. */
  pixel: number;
  /** Plane beyond which nothing is hit. */
  clip?: ClipEquation | null;
}

export interface Hit {
  vertex: number;
  point: [number, number, number];
  normal: [number, number, number];
  depth: number;
}

const MOST_CANDIDATES = 1 << 14;
const candidates = new Uint32Array(MOST_CANDIDATES);
const ROOM = 1.001;
/** Distance from the ray in pixels within which a point of a cloud is hit. */
const POINT_PIXELS = 6;

/** Number of consecutive vertices per enclosing ball. */
const RUN = 256;

/** Computes enclosing balls of runs of vertices, as center and radius (4 numbers per run). Neighbors in memory are mostly near. */
export type Balls = Float64Array;

export function enclosingBalls(p: Float32Array): Balls {
  const balls = new Float64Array(4 * Math.ceil(p.length / (3 * RUN)));
  for (let from = 0, b = 0; from < p.length; from += 3 * RUN, b += 4) {
    const to = Math.min(p.length, from + 3 * RUN);
    let squared = 0;
    for (let c = 0; c < 3; c++) {
      let low = Infinity;
      let high = -Infinity;
      for (let i = from + c; i < to; i += 3) {
        const x = p[i]!;
        if (x < low) low = x;
        if (x > high) high = x;
      }
      balls[b + c] = (low + high) / 2;
      squared += (high - low) ** 2;
    }
    balls[b + 3] = Math.sqrt(squared) / 2;
  }
  return balls;
}

export function pickMesh(
  positions: Float32Array,
  balls: Balls,
  triangles: Uint32Array,
  around: Rows,
  meanLength: number,
  ray: Ray,
): Hit | null {
  for (const reach of [1.5, 8]) {
    const found = inCone(positions, balls, ray, reach * meanLength, 2 * ray.pixel);
    let best: Hit | null = null;
    for (let i = 0; i < found; i++) {
      const v = candidates[i]!;
      for (let e = around.offsets[v]!; e < around.offsets[v + 1]!; e++) {
        best = nearer(best, positions, triangles, around.entries[e]!, ray);
      }
    }
    if (best) return best;
  }
  // Some triangles are much larger than the mean: test all, if that is cheap.
  if (triangles.length > 3 * 60_000) return null;
  let best: Hit | null = null;
  for (let t = 0; 3 * t < triangles.length; t++) best = nearer(best, positions, triangles, t, ray);
  return best;
}

export function pickCloud(positions: Float32Array, balls: Balls, meanLength: number, ray: Ray): Hit | null {
  const found = inCone(positions, balls, ray, 0.7 * meanLength, POINT_PIXELS * ray.pixel);
  const [ox, oy, oz] = ray.origin;
  const [dx, dy, dz] = ray.direction;
  let best = -1;
  let depth = Infinity;
  for (let i = 0; i < found; i++) {
    const v = candidates[i]!;
    const t =
      (positions[3 * v]! - ox) * dx + (positions[3 * v + 1]! - oy) * dy + (positions[3 * v + 2]! - oz) * dz;
    if (t < depth && !(ray.clip && isClipped(ray.clip, positions, 3 * v))) {
      depth = t;
      best = v;
    }
  }
  if (best < 0) return null;
  const point: [number, number, number] = [
    positions[3 * best]!,
    positions[3 * best + 1]!,
    positions[3 * best + 2]!,
  ];
  return { vertex: best, point, normal: [-dx, -dy, -dz], depth };
}

/** Collects the vertices nearer to the ray than `width + slope · depth` in `candidates`. */
function inCone(p: Float32Array, balls: Balls, ray: Ray, width: number, slope: number): number {
  const [ox, oy, oz] = ray.origin;
  const [dx, dy, dz] = ray.direction;
  let found = 0;
  for (let from = 0, b = 0; from < p.length; from += 3 * RUN, b += 4) {
    const mx = balls[b]! - ox;
    const my = balls[b + 1]! - oy;
    const mz = balls[b + 2]! - oz;
    const radius = balls[b + 3]!;
    const depth = mx * dx + my * dy + mz * dz;
    if (depth + radius <= 0) continue;
    // Width of the cone at the far side of the ball, with a margin for rounding.
    const widest = (width + slope * (depth + radius) + radius) * ROOM;
    if (mx * mx + my * my + mz * mz - depth * depth > widest * widest) continue;
    const to = Math.min(p.length, from + 3 * RUN);
    for (let i = from; i < to; i += 3) {
      const x = p[i]! - ox;
      const y = p[i + 1]! - oy;
      const z = p[i + 2]! - oz;
      const t = x * dx + y * dy + z * dz;
      const r = width + slope * t;
      if (t > 0 && x * x + y * y + z * z - t * t < r * r) {
        candidates[found++] = i / 3;
        if (found === MOST_CANDIDATES) return found;
      }
    }
  }
  return found;
}

/** Returns the nearer of `best` and the intersection with triangle `t` (Möller and Trumbore, both sides). */
function nearer(best: Hit | null, p: Float32Array, triangles: Uint32Array, t: number, ray: Ray): Hit | null {
  const a = 3 * triangles[3 * t]!;
  const b = 3 * triangles[3 * t + 1]!;
  const c = 3 * triangles[3 * t + 2]!;
  const [dx, dy, dz] = ray.direction;
  const ux = p[b]! - p[a]!;
  const uy = p[b + 1]! - p[a + 1]!;
  const uz = p[b + 2]! - p[a + 2]!;
  const vx = p[c]! - p[a]!;
  const vy = p[c + 1]! - p[a + 1]!;
  const vz = p[c + 2]! - p[a + 2]!;
  const qx = dy * vz - dz * vy;
  const qy = dz * vx - dx * vz;
  const qz = dx * vy - dy * vx;
  const det = ux * qx + uy * qy + uz * qz;
  if (det === 0) return best;
  const sx = ray.origin[0] - p[a]!;
  const sy = ray.origin[1] - p[a + 1]!;
  const sz = ray.origin[2] - p[a + 2]!;
  const u = (sx * qx + sy * qy + sz * qz) / det;
  if (u < 0 || u > 1) return best;
  const rx = sy * uz - sz * uy;
  const ry = sz * ux - sx * uz;
  const rz = sx * uy - sy * ux;
  const v = (dx * rx + dy * ry + dz * rz) / det;
  if (v < 0 || u + v > 1) return best;
  const depth = (vx * rx + vy * ry + vz * rz) / det;
  if (depth <= 0 || (best && depth >= best.depth)) return best;
  const point: [number, number, number] = [
    ray.origin[0] + depth * dx,
    ray.origin[1] + depth * dy,
    ray.origin[2] + depth * dz,
  ];
  if (ray.clip && isClipped(ray.clip, point)) return best;
  const nx = uy * vz - uz * vy;
  const ny = uz * vx - ux * vz;
  const nz = ux * vy - uy * vx;
  const length = Math.hypot(nx, ny, nz) || 1;
  const sign = nx * dx + ny * dy + nz * dz > 0 ? -1 / length : 1 / length;
  const w = 1 - u - v;
  const corner = w >= u && w >= v ? 0 : u >= v ? 1 : 2;
  return {
    vertex: triangles[3 * t + corner]!,
    point,
    normal: [nx * sign, ny * sign, nz * sign],
    depth,
  };
}

/** Nearest vertex of a point, by brute force. */
export function nearestVertex(p: Float32Array, x: number, y: number, z: number): number {
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < p.length; i += 3) {
    const a = p[i]! - x;
    const b = p[i + 1]! - y;
    const c = p[i + 2]! - z;
    const d = a * a + b * b + c * c;
    if (d < least) {
      least = d;
      best = i / 3;
    }
  }
  return best;
}
