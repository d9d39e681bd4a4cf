/**
 * Distance along a surface, by the rule of the server's `SurfaceSearch`: shortest paths over the edges, in which two
 * edges in a row may be replaced by the straight line between their ends; of equal distances the smaller vertex first.
 * Memory is kept from one search to the next, so that a search costs what it finds.
 */

import type { Rows, weld } from './adjacency';

const NONE = 0xffffffff;

export class SurfaceSearch {
  /** Vertices within the radius of the last search, in the order in which they were first seen. */
  reached: Uint32Array;
  nReached = 0;
  private readonly distances: Float64Array;
  private readonly before: Uint32Array;
  private readonly stamps: Uint32Array;
  private stamp = 0;
  private heapKeys = new Float64Array(1024);
  private heapVertices = new Uint32Array(1024);
  private heapSize = 0;

  constructor(
    private readonly neighbours: Rows,
    private readonly points: Float32Array,
    /** Where several vertices are at one place: `neighbours` are those of the first. */
    private readonly welded: ReturnType<typeof weld> = null,
  ) {
    const n = points.length / 3;
    this.distances = new Float64Array(n);
    this.before = new Uint32Array(n);
    this.stamps = new Uint32Array(n);
    this.reached = new Uint32Array(1024);
  }

  /** The distance of a vertex from the nearest source of the last search; infinite beyond its radius. */
  distance(v: number): number {
    return this.stamps[v] === this.stamp ? this.distances[v]! : Infinity;
  }

  /** Searches from `sources`, all with distance 0. At most `most` vertices are looked at; false where there were more. */
  run(sources: ArrayLike<number>, radius: number, most = Infinity): boolean {
    this.stamp++;
    this.nReached = 0;
    this.heapSize = 0;
    for (let i = 0; i < sources.length; i++) {
      const source = this.welded ? this.welded.first[sources[i]!]! : sources[i]!;
      if (this.distance(source) > 0) this.label(source, 0, NONE);
    }
    const { offsets, entries } = this.neighbours;
    while (this.heapSize > 0) {
      const key = this.heapKeys[0]!;
      const x = this.heapVertices[0]!;
      this.pop();
      const here = this.distances[x]!;
      if (key > here) continue; // reached on a shorter way since it was put in
      if (this.nReached > most) return false;
      const before = this.before[x]!;
      const start = before === NONE ? 0 : this.distances[before]!;
      for (let e = offsets[x]!; e < offsets[x + 1]!; e++) {
        const y = entries[e]!;
        const known = this.stamps[y] === this.stamp ? this.distances[y]! : Infinity;
        let there = here + this.length(x, y);
        if (before !== NONE) {
          const straight = start + this.length(before, y);
          if (straight < there) there = straight;
        }
        if (there < known && there <= radius) this.label(y, there, x);
      }
    }
    if (this.welded) this.labelTwins();
    return true;
  }

  /** Vertices at the place of one that was reached have its distance. */
  private labelTwins(): void {
    const n = this.nReached;
    for (let i = 0; i < n; i++) {
      const v = this.reached[i]!;
      for (const w of this.welded!.twins.get(v) ?? []) this.label(w, this.distances[v]!, NONE);
    }
    this.heapSize = 0;
  }

  private length(x: number, y: number): number {
    const p = this.points;
    const a = p[3 * x]! - p[3 * y]!;
    const b = p[3 * x + 1]! - p[3 * y + 1]!;
    const c = p[3 * x + 2]! - p[3 * y + 2]!;
    return Math.sqrt(a * a + b * b + c * c);
  }

  private label(v: number, distance: number, before: number): void {
    if (this.stamps[v] !== this.stamp) {
      this.stamps[v] = this.stamp;
      if (this.nReached === this.reached.length) {
        const larger = new Uint32Array(2 * this.nReached);
        larger.set(this.reached);
        this.reached = larger;
      }
      this.reached[this.nReached++] = v;
    }
    this.distances[v] = distance;
    this.before[v] = before;
    this.push(distance, v);
  }

  private push(key: number, vertex: number): void {
    if (this.heapSize === this.heapKeys.length) {
      const keys = new Float64Array(2 * this.heapSize);
      keys.set(this.heapKeys);
      this.heapKeys = keys;
      const vertices = new Uint32Array(2 * this.heapSize);
      vertices.set(this.heapVertices);
      this.heapVertices = vertices;
    }
    const keys = this.heapKeys;
    const vertices = this.heapVertices;
    let i = this.heapSize++;
    while (i > 0) {
      const up = (i - 1) >> 1;
      const k = keys[up]!;
      if (k < key || (k === key && vertices[up]! <= vertex)) break;
      keys[i] = k;
      vertices[i] = vertices[up]!;
      i = up;
    }
    keys[i] = key;
    vertices[i] = vertex;
  }

  private pop(): void {
    const keys = this.heapKeys;
    const vertices = this.heapVertices;
    const size = --this.heapSize;
    const key = keys[size]!;
    const vertex = vertices[size]!;
    let i = 0;
    for (;;) {
      let child = 2 * i + 1;
      if (child >= size) break;
      const right = child + 1;
      if (
        right < size &&
        (keys[right]! < keys[child]! || (keys[right] === keys[child] && vertices[right]! < vertices[child]!))
      ) {
        child = right;
      }
      const k = keys[child]!;
      if (key < k || (key === k && vertex <= vertices[child]!)) break;
      keys[i] = k;
      vertices[i] = vertices[child]!;
      i = child;
    }
    keys[i] = key;
    vertices[i] = vertex;
  }
}
