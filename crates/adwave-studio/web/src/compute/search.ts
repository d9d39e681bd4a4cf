/**
 * Distance along a surface, by the rules of the server: on a mesh by straight lines over unfolded triangles (`front.ts`), on
 * a cloud or a graph by shortest paths over the edges, in which two consecutive edges may be replaced by the straight line between
 * their ends; ties are broken by the smaller index. Memory is reused, so that a search costs only what it reaches.
 */

import { Front } from './front';
import { Heap } from './heap';
import type { Surface } from './surface';

const NONE = 0xffffffff;

export class SurfaceSearch {
  /** Vertices reached by the last search: all within its radius, or those whose distance `add` has reduced. */
  reached = new Uint32Array(1024);
  nReached = 0;
  /** Reached points of the surface, in the order of discovery. */
  private found = new Uint32Array(1024);
  private nFound = 0;
  private readonly distances: Float64Array;
  private readonly before: Uint32Array;
  private readonly stamps: Uint32Array;
  private stamp = 0;
  /** Stamp of the search that later ones were added to. */
  private first = 0;
  private readonly heap = new Heap();

  private longestOnce: number | null = null;
  /** Distances on a mesh. */
  private readonly front: Front | null;
  /** Radius of the last search. */
  private radius = 0;

  constructor(private readonly surface: Surface) {
    const n = surface.points.length / 3;
    this.distances = new Float64Array(n);
    this.before = new Uint32Array(n);
    this.stamps = new Uint32Array(n);
    this.front = surface.corners ? new Front(surface) : null;
  }

  /** Length of the longest edge. */
  get longest(): number {
    this.longestOnce ??= longestEdge(this.surface);
    return this.longestOnce;
  }

  /** Distance of a vertex from the nearest source of the last search; infinite beyond its radius. */
  distance(v: number): number {
    return this.distanceOf(this.surface.places[v]!);
  }

  private distanceOf(place: number): number {
    if (this.front) {
      const distance = this.front.distances[place]!;
      return distance <= this.radius ? distance : Infinity;
    }
    return this.stamps[place]! >= this.first ? this.distances[place]! : Infinity;
  }

  /** Searches from `sources`, all at distance 0. Returns false if more than `most` points were reached. */
  run(sources: ArrayLike<number>, radius: number, most = Infinity): boolean {
    this.first = this.stamp + 1;
    this.front?.clear();
    return this.add(sources, radius, most);
  }

  /** Adds sources to those since the last `run`; costs only the points that are nearer to the new ones. */
  add(sources: ArrayLike<number>, radius: number, most = Infinity): boolean {
    const { places, neighbors, points, countsEdges } = this.surface;
    this.stamp++;
    this.nFound = 0;
    this.nReached = 0;
    this.heap.size = 0;
    this.radius = radius;
    if (this.front) return this.addToFront(this.front, sources, radius, most);
    for (let i = 0; i < sources.length; i++) {
      const source = places[sources[i]!]!;
      if (this.distanceOf(source) > 0) this.label(source, 0, NONE);
    }
    const { offsets, entries } = neighbors;
    const { stamps, distances, first } = this;
    while (this.heap.size > 0) {
      const key = this.heap.firstKey;
      const x = this.heap.firstNumber;
      this.heap.pop();
      const here = distances[x]!;
      if (key > here) continue; // outdated entry: a shorter path was found
      if (this.nFound > most) return false;
      const before = this.before[x]!;
      const start = before === NONE ? 0 : distances[before]!;
      for (let e = offsets[x]!, end = offsets[x + 1]!; e < end; e++) {
        const y = entries[e]!;
        const known = stamps[y]! >= first ? distances[y]! : Infinity;
        let there = here + (countsEdges ? 1 : pointDistance(points, x, y));
        if (before !== NONE && !countsEdges) {
          const straight = start + pointDistance(points, before, y);
          if (straight < there) there = straight;
        }
        if (there < known && there <= radius) this.label(y, there, x);
      }
    }
    this.listVertices();
    return true;
  }

  private addToFront(front: Front, sources: ArrayLike<number>, radius: number, most: number): boolean {
    const places = Array.from(sources, (v) => this.surface.places[v]!);
    if (!front.add(places, radius, most, (place) => this.reach(place))) return false;
    // Lines within the radius may pass between places beyond it.
    let n = 0;
    for (let i = 0; i < this.nFound; i++) {
      const place = this.found[i]!;
      if (front.distances[place]! <= radius) this.found[n++] = place;
    }
    this.nFound = n;
    this.listVertices();
    return true;
  }

  /** Lists the vertices at the reached points. */
  private listVertices(): void {
    const { offsets, entries } = this.surface.members;
    for (let i = 0; i < this.nFound; i++) {
      const place = this.found[i]!;
      for (let e = offsets[place]!; e < offsets[place + 1]!; e++) {
        if (this.nReached === this.reached.length) this.reached = growArray(this.reached);
        this.reached[this.nReached++] = entries[e]!;
      }
    }
  }

  /** Notes that the distance of a place is reduced. */
  private reach(place: number): void {
    if (this.stamps[place] === this.stamp) return;
    this.stamps[place] = this.stamp;
    if (this.nFound === this.found.length) this.found = growArray(this.found);
    this.found[this.nFound++] = place;
  }

  private label(place: number, distance: number, before: number): void {
    this.reach(place);
    this.distances[place] = distance;
    this.before[place] = before;
    this.heap.push(distance, place);
  }
}

/** Straight distance of two points. */
function pointDistance(p: Float64Array, x: number, y: number): number {
  const a = p[3 * x]! - p[3 * y]!;
  const b = p[3 * x + 1]! - p[3 * y + 1]!;
  const c = p[3 * x + 2]! - p[3 * y + 2]!;
  return Math.sqrt(a * a + b * b + c * c);
}

function longestEdge({ points, neighbors: { offsets, entries } }: Surface): number {
  let most = 0;
  for (let x = 0; x + 1 < offsets.length; x++) {
    for (let e = offsets[x]!; e < offsets[x + 1]!; e++) {
      if (entries[e]! > x) most = Math.max(most, pointDistance(points, x, entries[e]!));
    }
  }
  return most;
}

function growArray(array: Uint32Array<ArrayBuffer>): Uint32Array<ArrayBuffer> {
  const larger = new Uint32Array(2 * array.length);
  larger.set(array);
  return larger;
}
