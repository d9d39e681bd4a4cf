/** Computes the contour at distance `level` of the last search, as segments over the triangles. */

import type { Rows } from './adjacency';
import type { Hit } from './pick';
import type { SurfaceSearch } from './search';

export function contour(
  search: SurfaceSearch,
  positions: Float32Array,
  triangles: Uint32Array,
  around: Rows,
  level: number,
): Float32Array {
  const out: number[] = [];
  const { offsets, entries } = around;
  // No edge from within this distance reaches the level.
  const within = level - 1.001 * search.longest;
  /** Adds the point on the edge from `a` to `b` where the distance is `level`. */
  const crossing = (a: number, b: number, da: number, db: number) => {
    const t = (level - da) / (db - da);
    for (let c = 0; c < 3; c++) out.push(positions[3 * a + c]! * (1 - t) + positions[3 * b + c]! * t);
  };
  for (let i = 0; i < search.nReached; i++) {
    const v = search.reached[i]!;
    const dv = search.distance(v);
    if (dv > level || dv < within) continue;
    for (let e = offsets[v]!; e < offsets[v + 1]!; e++) {
      const t = 3 * entries[e]!;
      // The corners after v, in the order of the triangle.
      const k = triangles[t] === v ? 0 : triangles[t + 1] === v ? 1 : 2;
      const p = triangles[t + ((k + 1) % 3)]!;
      const q = triangles[t + ((k + 2) % 3)]!;
      const dp = search.distance(p);
      const dq = search.distance(q);
      const pOut = dp > level;
      const qOut = dq > level;
      if (!pOut && !qOut) continue;
      if (dp === Infinity || dq === Infinity) continue;
      if (pOut && qOut) {
        crossing(v, p, dv, dp);
        crossing(v, q, dv, dq);
      } else if (pOut ? q > v : p > v) {
        // With two corners inside, the smaller one draws the segment.
        if (pOut) {
          crossing(v, p, dv, dp);
          crossing(q, p, dq, dp);
        } else {
          crossing(v, q, dv, dq);
          crossing(p, q, dp, dq);
        }
      }
    }
  }
  return Float32Array.from(out);
}

/** Circle in the tangent plane, for clouds and large brushes. */
export function flatRing({ point, normal }: Hit, radius: number): Float32Array {
  const [nx, ny, nz] = normal;
  const a = Math.abs(nx) < 0.8 ? [0, -nz, ny] : [nz, 0, -nx];
  const length = Math.hypot(...a);
  const u = a.map((x) => x / length) as [number, number, number];
  const v = [ny * u[2] - nz * u[1], nz * u[0] - nx * u[2], nx * u[1] - ny * u[0]];
  const n = 64;
  const out = new Float32Array(6 * n);
  for (let i = 0; i < n; i++) {
    for (const end of [0, 1]) {
      const t = (2 * Math.PI * (i + end)) / n;
      for (let c = 0; c < 3; c++) {
        out[6 * i + 3 * end + c] = point[c]! + radius * (Math.cos(t) * u[c]! + Math.sin(t) * v[c]!);
      }
    }
  }
  return out;
}
