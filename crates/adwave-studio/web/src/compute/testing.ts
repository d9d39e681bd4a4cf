/** Small shapes for tests. */

import { neighborsOfMesh, trianglesOfVertices } from './adjacency';
import type { RegionContext } from './regions';
import { SurfaceSearch } from './search';
import { placeNormals, readSurface, type Surface } from './surface';

/** Grid of (k + 1)² vertices in the unit square, bumpy in z, with a fixed pattern of diagonals. */
export function sheet(k: number, bump = 0): { positions: Float32Array; triangles: Uint32Array; n: number } {
  const n = (k + 1) ** 2;
  const positions = new Float32Array(3 * n);
  for (let i = 0; i <= k; i++) {
    for (let j = 0; j <= k; j++) {
      positions.set([i / k, j / k, bump * Math.sin(7 * i + 3 * j)], 3 * (i * (k + 1) + j));
    }
  }
  const triangles: number[] = [];
  for (let i = 0; i < k; i++) {
    for (let j = 0; j < k; j++) {
      const a = i * (k + 1) + j;
      const b = a + k + 1;
      if ((i * 5 + j * 3) % 4 < 2) triangles.push(a, b, b + 1, a, b + 1, a + 1);
      else triangles.push(a, b, a + 1, b, b + 1, a + 1);
    }
  }
  return { positions, triangles: Uint32Array.from(triangles), n };
}

export function rows(s: { triangles: Uint32Array; n: number }) {
  const around = trianglesOfVertices(s.triangles, s.n);
  return { around, neighbors: neighborsOfMesh(s.triangles, s.n, around) };
}

/** Surface of a sheet without welded vertices. */
export function surfaceOf(s: { positions: Float32Array; triangles: Uint32Array; n: number }): Surface {
  const bytes = new ArrayBuffer(28 * s.n);
  new Float64Array(bytes, 0, 3 * s.n).set(s.positions);
  new Uint32Array(bytes, 24 * s.n).set(Uint32Array.from({ length: s.n }, (_, v) => v));
  return readSurface(bytes, s.n, s.triangles);
}

export function ground(s: ReturnType<typeof sheet>): RegionContext {
  const surface = surfaceOf(s);
  return {
    n: s.n,
    diagonal: Math.SQRT2,
    surface,
    search: new SurfaceSearch(surface),
    normals: placeNormals(surface, s.triangles),
    local: true,
    ask: () => Promise.reject(new Error('asked')),
  };
}

/** Deterministic pseudorandom numbers in [0, 1). */
export function random(seed: number): () => number {
  let x = seed;
  return () => {
    x = (Math.imul(x, 1664525) + 1013904223) >>> 0;
    return x / 2 ** 32;
  };
}
