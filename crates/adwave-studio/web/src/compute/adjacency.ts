/** Adjacency in compressed rows. */

export interface Rows {
  /** Offsets, n + 1 numbers: the entries of row v are `entries[offsets[v] .. offsets[v + 1]]`. */
  offsets: Uint32Array;
  entries: Uint32Array;
}

/** Lists the triangles of each vertex. */
export function trianglesOfVertices(triangles: Uint32Array, n: number): Rows {
  const offsets = new Uint32Array(n + 1);
  for (let k = 0; k < triangles.length; k++) offsets[triangles[k]! + 1]!++;
  for (let v = 0; v < n; v++) offsets[v + 1]! += offsets[v]!;
  const next = offsets.slice(0, n);
  const entries = new Uint32Array(triangles.length);
  for (let t = 0, k = 0; k < triangles.length; t++, k += 3) {
    for (let c = 0; c < 3; c++) entries[next[triangles[k + c]!]!++] = t;
  }
  return { offsets, entries };
}

/** Lists the one-ring of each vertex, without duplicates, in ascending order. */
export function neighborsOfMesh(triangles: Uint32Array, n: number, around: Rows): Rows {
  const offsets = new Uint32Array(n + 1);
  let entries = new Uint32Array(Math.max(16, triangles.length + n));
  let size = 0;
  const seen = new Int32Array(n).fill(-1);
  let ring = new Uint32Array(64);
  for (let v = 0; v < n; v++) {
    let k = 0;
    for (let e = around.offsets[v]!; e < around.offsets[v + 1]!; e++) {
      const t = 3 * around.entries[e]!;
      for (let c = 0; c < 3; c++) {
        const w = triangles[t + c]!;
        if (w === v || seen[w] === v) continue;
        seen[w] = v;
        if (k === ring.length) ring = growArray(ring);
        ring[k++] = w;
      }
    }
    // Insertion sort is fastest for short rings.
    if (k > 40) ring.subarray(0, k).sort();
    else {
      for (let i = 1; i < k; i++) {
        const w = ring[i]!;
        let j = i - 1;
        while (j >= 0 && ring[j]! > w) {
          ring[j + 1] = ring[j]!;
          j--;
        }
        ring[j + 1] = w;
      }
    }
    while (size + k > entries.length) entries = growArray(entries);
    for (let i = 0; i < k; i++) entries[size++] = ring[i]!;
    offsets[v + 1] = size;
  }
  return { offsets, entries: entries.slice(0, size) };
}

function growArray(array: Uint32Array<ArrayBuffer>): Uint32Array<ArrayBuffer> {
  const larger = new Uint32Array(2 * array.length);
  larger.set(array);
  return larger;
}

/**
 * Lists the `k` nearest neighbors of each point of a cloud, with a grid whose cells hold four points on average. It is a
 * preview of the neighbor graph of the server, which computes the mask of a stroke on a cloud.
 */
export function neighborsOfCloud(positions: Float32Array, k: number): Rows {
  const n = positions.length / 3;
  const grid = new Grid(positions);
  const offsets = new Uint32Array(n + 1);
  const entries = new Uint32Array(n * k);
  const best = new Float64Array(k);
  const who = new Uint32Array(k);
  let size = 0;
  for (let v = 0; v < n; v++) {
    let found = 0;
    const px = positions[3 * v]!;
    const py = positions[3 * v + 1]!;
    const pz = positions[3 * v + 2]!;
    for (let reach = 1; reach <= 4; reach++) {
      found = 0;
      grid.visit(px, py, pz, reach, (w) => {
        if (w === v) return;
        const x = positions[3 * w]! - px;
        const y = positions[3 * w + 1]! - py;
        const z = positions[3 * w + 2]! - pz;
        const d = x * x + y * y + z * z;
        if (found === k && d >= best[k - 1]!) return;
        let i = found < k ? found++ : k - 1;
        while (i > 0 && best[i - 1]! > d) {
          best[i] = best[i - 1]!;
          who[i] = who[i - 1]!;
          i--;
        }
        best[i] = d;
        who[i] = w;
      });
      // All points within the visited cubes have been seen.
      if (found === Math.min(k, n - 1) && best[found - 1]! <= (reach * grid.cell) ** 2) break;
    }
    for (let i = 0; i < found; i++) entries[size++] = who[i]!;
    offsets[v + 1] = size;
  }
  return { offsets, entries: entries.slice(0, size) };
}

/** Lists the neighbors of each node of a graph; `pairs` has two nodes for each edge. */
export function neighborsOfGraph(pairs: Uint32Array, n: number): Rows {
  const offsets = new Uint32Array(n + 1);
  for (const v of pairs) offsets[v + 1]!++;
  for (let v = 0; v < n; v++) offsets[v + 1]! += offsets[v]!;
  const next = offsets.slice(0, n);
  const entries = new Uint32Array(pairs.length);
  for (let i = 0; i < pairs.length; i++) entries[next[pairs[i]!]!++] = pairs[i ^ 1]!;
  return { offsets, entries };
}

/** Hash grid of points in cubes of equal size. */
export class Grid {
  readonly cell: number;
  private readonly heads: Int32Array;
  private readonly nexts: Int32Array;
  private readonly bits: number;

  constructor(positions: Float32Array) {
    const n = positions.length / 3;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < positions.length; i++) {
      const c = i % 3;
      const x = positions[i]!;
      if (x < low[c]!) low[c] = x;
      if (x > high[c]!) high[c] = x;
    }
    const sides = [0, 1, 2].map((c) => Math.max(0, high[c]! - low[c]!)).sort((a, b) => b - a);
    // Scans are surfaces, so that two of the three sides count.
    this.cell = Math.max(
      Math.sqrt((4 * sides[0]! * Math.max(sides[1]!, sides[0]! * 1e-3)) / Math.max(1, n)),
      1e-30,
    );
    this.bits = (1 << Math.max(4, Math.ceil(Math.log2(n + 1)))) - 1;
    this.heads = new Int32Array(this.bits + 1).fill(-1);
    this.nexts = new Int32Array(n);
    for (let v = n - 1; v >= 0; v--) {
      const h = this.hash(
        Math.floor(positions[3 * v]! / this.cell),
        Math.floor(positions[3 * v + 1]! / this.cell),
        Math.floor(positions[3 * v + 2]! / this.cell),
      );
      this.nexts[v] = this.heads[h]!;
      this.heads[h] = v;
    }
  }

  private hash(x: number, y: number, z: number): number {
    return (Math.imul(x, 73856093) ^ Math.imul(y, 19349663) ^ Math.imul(z, 83492791)) & this.bits;
  }

  /** Calls `see` once for each point in the cubes up to `reach` cubes away, and possibly for some others. */
  visit(x: number, y: number, z: number, reach: number, see: (v: number) => void): void {
    const cx = Math.floor(x / this.cell);
    const cy = Math.floor(y / this.cell);
    const cz = Math.floor(z / this.cell);
    const seen: number[] = [];
    for (let i = -reach; i <= reach; i++) {
      for (let j = -reach; j <= reach; j++) {
        for (let k = -reach; k <= reach; k++) {
          const h = this.hash(cx + i, cy + j, cz + k);
          if (seen.includes(h)) continue; // two cubes may share a slot of the table
          seen.push(h);
          for (let v = this.heads[h]!; v >= 0; v = this.nexts[v]!) see(v);
        }
      }
    }
  }
}
