/** Where the distance of the last search is `level`, as segments over the triangles round the vertices it reached. */

import type { Rows } from './adjacency';
import type { SurfaceSearch } from './search';

export function contour(
  search: SurfaceSearch,
  positions: Float32Array,
  triangles: Uint32Array,
  around: Rows,
  level: number,
): Float32Array {
  const out: number[] = [];
  const crossing = (a: number, b: number, da: number, db: number) => {
    const t = (level - da) / (db - da);
    for (let c = 0; c < 3; c++) {
      out.push(positions[3 * a + c]! * (1 - t) + positions[3 * b + c]! * t);
    }
  };
  for (let i = 0; i < search.nReached; i++) {
    const v = search.reached[i]!;
    if (search.distance(v) > level) continue;
    for (let e = around.offsets[v]!; e < around.offsets[v + 1]!; e++) {
      const t = 3 * around.entries[e]!;
      const ids = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!] as const;
      const d = ids.map((w) => search.distance(w));
      const inside = d.map((x) => x <= level);
      const n = Number(inside[0]) + Number(inside[1]) + Number(inside[2]);
      if (n === 3 || d.includes(Infinity)) continue;
      // Each triangle once: at the first of its vertices that is inside.
      if (ids[inside.indexOf(true)] !== v) continue;
      const lone = n === 1 ? inside.indexOf(true) : inside.indexOf(false);
      const p = (lone + 1) % 3;
      const q = (lone + 2) % 3;
      crossing(ids[lone]!, ids[p]!, d[lone]!, d[p]!);
      crossing(ids[lone]!, ids[q]!, d[lone]!, d[q]!);
    }
  }
  return Float32Array.from(out);
}
