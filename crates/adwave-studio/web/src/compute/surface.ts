/**
 * Surface on which distances are measured. Vertices at one point are welded to one place. Places have the order of the
 * server and the double precision positions of the file, so that brush strokes are bit-identical to the server's replay.
 */

import { neighborsOfMesh, type Rows, trianglesOfVertices } from './adjacency';

export interface Surface {
  /** Place of each vertex. */
  places: Uint32Array;
  /** Positions of the places, 3 numbers each. */
  points: Float64Array;
  /** Vertices at each place. */
  members: Rows;
  /** Adjacent places of each place. */
  neighbors: Rows;
  /** The other two corners of the triangles at each place, two entries each; null for a cloud or a graph. */
  corners: Rows | null;
  /** True if distances are numbers of edges: on a graph without positions. */
  countsEdges: boolean;
}

/** Parses the response of `GET surface`: `f64 × 3 × n` positions, then `u32 × n` places. */
export function readSurface(buffer: ArrayBuffer, n: number, triangles: Uint32Array): Surface {
  const positions = new Float64Array(buffer, 0, 3 * n);
  const places = new Uint32Array(buffer, 24 * n, n);
  let nPlaces = 0;
  for (let v = 0; v < n; v++) if (places[v]! >= nPlaces) nPlaces = places[v]! + 1;
  const points = new Float64Array(3 * nPlaces);
  for (let v = 0; v < n; v++) {
    for (let c = 0; c < 3; c++) points[3 * places[v]! + c] = positions[3 * v + c]!;
  }
  const welded = triangles.map((v) => places[v]!);
  const neighbors = neighborsOfMesh(welded, nPlaces, trianglesOfVertices(welded, nPlaces));
  const corners = listCorners(welded, nPlaces);
  return {
    places: places.slice(),
    points,
    members: listMembers(places, nPlaces),
    neighbors,
    corners,
    countsEdges: false,
  };
}

/** Builds the surface of a cloud or a graph, an approximation of the server's, which computes the final mask of a stroke. */
export function linkedPoints(positions: Float32Array, neighbors: Rows, countsEdges = false): Surface {
  const n = positions.length / 3;
  const places = Uint32Array.from({ length: n }, (_, v) => v);
  return {
    places,
    points: Float64Array.from(positions),
    members: listMembers(places, n),
    neighbors,
    corners: null,
    countsEdges,
  };
}

/** Lists the pairs of other corners in ascending order, each pair the smaller corner first. */
function listCorners(welded: Uint32Array, nPlaces: number): Rows {
  const offsets = new Uint32Array(nPlaces + 1);
  for (const place of welded) offsets[place + 1]! += 2;
  for (let p = 0; p < nPlaces; p++) offsets[p + 1]! += offsets[p]!;
  const next = offsets.slice(0, nPlaces);
  const entries = new Uint32Array(2 * welded.length);
  for (let t = 0; t < welded.length; t += 3) {
    for (let k = 0; k < 3; k++) {
      const p = welded[t + ((k + 1) % 3)]!;
      const q = welded[t + ((k + 2) % 3)]!;
      const at = next[welded[t + k]!]!;
      next[welded[t + k]!] = at + 2;
      entries[at] = Math.min(p, q);
      entries[at + 1] = Math.max(p, q);
    }
  }
  for (let x = 0; x < nPlaces; x++) sortPairs(entries, offsets[x]!, offsets[x + 1]!);
  return { offsets, entries };
}

/** Sorts the few pairs from `first` to `end` by insertion. */
function sortPairs(entries: Uint32Array, first: number, end: number): void {
  for (let i = first + 2; i < end; i += 2) {
    const p = entries[i]!;
    const q = entries[i + 1]!;
    let at = i;
    while (at > first && (entries[at - 2]! > p || (entries[at - 2] === p && entries[at - 1]! > q))) {
      entries[at] = entries[at - 2]!;
      entries[at + 1] = entries[at - 1]!;
      at -= 2;
    }
    entries[at] = p;
    entries[at + 1] = q;
  }
}

function listMembers(places: Uint32Array, nPlaces: number): Rows {
  const offsets = new Uint32Array(nPlaces + 1);
  for (const place of places) offsets[place + 1]!++;
  for (let p = 0; p < nPlaces; p++) offsets[p + 1]! += offsets[p]!;
  const next = offsets.slice(0, nPlaces);
  const entries = new Uint32Array(places.length);
  for (let v = 0; v < places.length; v++) entries[next[places[v]!]!++] = v;
  return { offsets, entries };
}

/** Area-weighted unit normals of the places; 0 for places without triangles. */
export function placeNormals({ places, points }: Surface, triangles: Uint32Array): Float64Array {
  const sums = new Float64Array(points.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * places[triangles[t]!]!;
    const b = 3 * places[triangles[t + 1]!]!;
    const c = 3 * places[triangles[t + 2]!]!;
    const ux = points[b]! - points[a]!;
    const uy = points[b + 1]! - points[a + 1]!;
    const uz = points[b + 2]! - points[a + 2]!;
    const vx = points[c]! - points[a]!;
    const vy = points[c + 1]! - points[a + 1]!;
    const vz = points[c + 2]! - points[a + 2]!;
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    for (const i of [a, b, c]) {
      sums[i]! += nx;
      sums[i + 1]! += ny;
      sums[i + 2]! += nz;
    }
  }
  for (let i = 0; i < sums.length; i += 3) {
    const [x, y, z] = [sums[i]!, sums[i + 1]!, sums[i + 2]!];
    const length = Math.sqrt(x * x + y * y + z * z);
    if (length === 0) continue;
    sums[i] = x / length;
    sums[i + 1] = y / length;
    sums[i + 2] = z / length;
  }
  return sums;
}
