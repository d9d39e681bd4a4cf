/**
 * Distance along a mesh, by the rule of the server (`crates/adwave/src/region/front.rs`), with the same arithmetic in the
 * same order, so that brush strokes are bit-identical. A front runs straight over unfolded triangles and bends at places
 * only; each place keeps its origin in the plane of the triangle through which the front came.
 */

import { Heap } from './heap';
import type { Surface } from './surface';

const EQUAL = 1e-12;
const TOUCHING = 1e-9;
const FLAT = 1e-12;
const ONE_WAY = 0.5;
const OBTUSE = 4e-4;
const MOST_VISITS = 30;

const NONE = 0xffffffff;

/** A way across an edge: distance, place of the origin in the plane of the triangle, and the end whose origin it is. */
interface Way {
  distance: number;
  along: number;
  across: number;
  end: number;
}

/** The plane of a triangle: its edge from `a` to `b`, the corner behind it, and the origins along the edge. */
interface Crossing {
  a: number;
  b: number;
  length: number;
  cornerAlong: number;
  height: number;
  fromA: number;
  fromB: number;
}

type Vector = [number, number, number];

const dot = (a: Vector, b: Vector): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

export class Front {
  /** Places that have a label, in the order of discovery. */
  labelled = new Uint32Array(1024);
  nLabels = 0;
  readonly distances: Float64Array;
  private readonly labels: Uint32Array;
  private readonly starts: Float64Array;
  private readonly origins: Float64Array;
  /** Number of the origin: the place of a source or bend. */
  private readonly numbers: Uint32Array;
  private readonly visits: Uint32Array;
  private readonly waiting: Uint8Array;
  private readonly heap = new Heap();
  private readonly bits = new DataView(new ArrayBuffer(8));

  constructor(private readonly surface: Surface) {
    const n = surface.points.length / 3;
    this.distances = new Float64Array(n).fill(Infinity);
    this.labels = new Uint32Array(n).fill(NONE);
    this.starts = new Float64Array(n);
    this.origins = new Float64Array(3 * n);
    this.numbers = new Uint32Array(n);
    this.visits = new Uint32Array(n);
    this.waiting = new Uint8Array(n);
  }

  /** Forgets all distances. */
  clear(): void {
    for (let i = 0; i < this.nLabels; i++) {
      const place = this.labelled[i]!;
      this.labels[place] = NONE;
      this.distances[place] = Infinity;
    }
    this.nLabels = 0;
    this.heap.size = 0;
  }

  /**
   * Adds places at distance 0 and follows the front up to `radius`; `reach` is told each place whose distance is reduced.
   * Returns false if more than `most` places have a label.
   */
  add(sources: ArrayLike<number>, radius: number, most: number, reach: (place: number) => void): boolean {
    const { points } = this.surface;
    for (let i = 0; i < sources.length; i++) {
      const x = sources[i]!;
      this.offer(x, 0, 0, points[3 * x]!, points[3 * x + 1]!, points[3 * x + 2]!, x, reach);
    }
    while (this.heap.size > 0) {
      const key = this.heap.firstKey;
      const x = this.labelled[this.heap.firstNumber]!;
      this.heap.pop();
      if (!this.waiting[x] || key !== this.key(this.distances[x]!)) continue;
      if (this.nLabels > most) {
        this.heap.size = 0;
        return false;
      }
      this.waiting[x] = 0;
      this.visits[x]!++;
      this.passOn(x, radius, reach);
    }
    return true;
  }

  private vector(from: number, to: number): Vector {
    const { points } = this.surface;
    return [
      points[3 * to]! - points[3 * from]!,
      points[3 * to + 1]! - points[3 * from + 1]!,
      points[3 * to + 2]! - points[3 * from + 2]!,
    ];
  }

  private length(x: number, y: number): number {
    const v = this.vector(x, y);
    return Math.sqrt(dot(v, v));
  }

  private hasPassed(x: number): boolean {
    return this.labels[x] !== NONE && this.visits[x]! > 0;
  }

  private passOn(x: number, radius: number, reach: (place: number) => void): void {
    const { offsets, entries } = this.surface.corners!;
    const { points } = this.surface;
    const end = offsets[x + 1]!;
    for (let e = offsets[x]!; e < end; e += 2) {
      const p = entries[e]!;
      const q = entries[e + 1]!;
      const fromP = this.hasPassed(p);
      const fromQ = this.hasPassed(q);
      if (fromP && fromQ && this.isSettled(x, p, q)) continue;
      for (let k = 0; k < 2; k++) {
        if (!(k === 0 ? fromP : fromQ)) continue;
        this.cross(x, k === 0 ? p : q, k === 0 ? q : p, radius, p, q, reach);
      }
    }
    const here = this.distances[x]!;
    for (let e = offsets[x]!; e < end; e += 2) {
      for (let k = 0; k < 2; k++) {
        const y = entries[e + k]!;
        if (this.labels[y] !== NONE) {
          if (this.distances[y]! <= here || (this.numbers[y] === x && this.starts[y] === here)) continue;
        }
        const distance = here + this.length(x, y);
        if (
          distance <= radius ||
          (y !== x && distance <= radius + this.longestSide(x, entries[e]!, entries[e + 1]!))
        ) {
          this.offer(y, distance, here, points[3 * x]!, points[3 * x + 1]!, points[3 * x + 2]!, x, reach);
        }
      }
    }
  }

  private longestSide(x: number, p: number, q: number): number {
    return Math.max(this.length(x, p), this.length(x, q));
  }

  private isSettled(x: number, p: number, q: number): boolean {
    const { numbers, distances } = this;
    const isBefore = (y: number) => numbers[y] === numbers[x] && distances[y]! <= distances[x]!;
    if (!isBefore(p) || !isBefore(q)) return false;
    const side = this.vector(q, p);
    const squared = dot(side, side);
    const isAcuteOrRight = (toX: Vector, cosine: number) =>
      cosine > 0 || cosine * cosine < OBTUSE * dot(toX, toX) * squared;
    const fromP = this.vector(p, x);
    const fromQ = this.vector(q, x);
    return isAcuteOrRight(fromP, -dot(fromP, side)) && isAcuteOrRight(fromQ, dot(fromQ, side));
  }

  /** Offers the place `behind` the edge from `x` to `side` the straight way across it, if there is one. */
  private cross(
    x: number,
    side: number,
    behind: number,
    radius: number,
    p: number,
    q: number,
    reach: (place: number) => void,
  ): void {
    const { origins, distances, starts, numbers } = this;
    const { points } = this.surface;
    const a = Math.min(x, side);
    const b = Math.max(x, side);
    const edge = this.vector(a, b);
    const length = Math.sqrt(dot(edge, edge));
    const u: Vector = [edge[0] / length, edge[1] / length, edge[2] / length];
    const toCorner = this.vector(a, behind);
    const cornerAlong = dot(toCorner, u);
    const v: Vector = [
      toCorner[0] + -cornerAlong * u[0],
      toCorner[1] + -cornerAlong * u[1],
      toCorner[2] + -cornerAlong * u[2],
    ];
    const height = Math.sqrt(dot(v, v));
    if (!(length > 0 && height > FLAT * length)) return;
    const seen = (end: number) => {
      const d: Vector = [
        origins[3 * end]! - points[3 * end]!,
        origins[3 * end + 1]! - points[3 * end + 1]!,
        origins[3 * end + 2]! - points[3 * end + 2]!,
      ];
      return dot(d, u);
    };
    const crossing = { a, b, length, cornerAlong, height, fromA: seen(a), fromB: seen(b) };
    const way = shortest(crossing, distances, starts, numbers);
    if (!way) return;
    if (!(way.distance <= radius || way.distance <= radius + this.longestSide(x, p, q))) return;
    const scale = way.across / height;
    const at = (c: number) => points[3 * a + c]! + way.along * u[c]! + scale * v[c]!;
    this.offer(behind, way.distance, starts[way.end]!, at(0), at(1), at(2), numbers[way.end]!, reach);
  }

  private offer(
    place: number,
    distance: number,
    start: number,
    ox: number,
    oy: number,
    oz: number,
    number: number,
    reach: (place: number) => void,
  ): void {
    if (this.labels[place] === NONE) {
      if (this.nLabels === this.labelled.length) {
        const larger = new Uint32Array(2 * this.nLabels);
        larger.set(this.labelled);
        this.labelled = larger;
      }
      this.labels[place] = this.nLabels;
      this.labelled[this.nLabels++] = place;
      this.visits[place] = 0;
    } else {
      const known = this.distances[place]!;
      const isShorter = distance < known * (1 - EQUAL);
      const isStraighter = distance <= known * (1 + EQUAL) && start < this.starts[place]! - EQUAL * distance;
      if (!(isShorter || isStraighter) || this.visits[place]! > MOST_VISITS) return;
    }
    this.distances[place] = distance;
    this.starts[place] = start;
    this.origins[3 * place] = ox;
    this.origins[3 * place + 1] = oy;
    this.origins[3 * place + 2] = oz;
    this.numbers[place] = number;
    this.waiting[place] = 1;
    this.heap.push(this.key(distance), this.labels[place]!);
    reach(place);
  }

  /** Upper half of the bits of a distance, which have the order of the distances. */
  private key(distance: number): number {
    this.bits.setFloat64(0, distance);
    return this.bits.getUint32(0);
  }
}

function shortest(
  c: Crossing,
  distances: Float64Array,
  starts: Float64Array,
  numbers: Uint32Array,
): Way | null {
  const ra = distances[c.a]! - starts[c.a]!;
  const rb = distances[c.b]! - starts[c.b]!;
  if (numbers[c.a] === numbers[c.b]) {
    const along = 0.5 * (((ra - rb) * (ra + rb)) / c.length + c.length);
    if (Math.abs(along - c.fromA) <= ONE_WAY * ra) {
      const across = Math.sqrt(Math.max((ra - along) * (ra + along), 0));
      return lineFrom(c, along, -across, c.a, starts);
    }
  }
  const unfolded = (reach: number, seen: number, offset: number): [number, number] => {
    const most = Math.max(reach, 0);
    const along = Math.min(Math.max(seen, -most), most);
    return [offset + along, -Math.sqrt((most - along) * (most + along))];
  };
  const fromA = unfolded(ra, c.fromA, 0);
  const fromB = unfolded(rb, c.fromB, c.length);
  let first = lineFrom(c, fromA[0], fromA[1], c.a, starts);
  if (first && !isSeen(c, [fromA, fromB], 0, distances, starts)) first = null;
  let second = lineFrom(c, fromB[0], fromB[1], c.b, starts);
  if (second && !isSeen(c, [fromA, fromB], 1, distances, starts)) second = null;
  if (first && second) return second.distance < first.distance ? second : first;
  return first ?? second;
}

function lineFrom(c: Crossing, along: number, across: number, end: number, starts: Float64Array): Way | null {
  const at = crossingPoint(along, across, c.cornerAlong, c.height);
  const margin = TOUCHING * c.length;
  if (!(at >= -margin && at <= c.length + margin)) return null;
  const dx = c.cornerAlong - along;
  const dy = c.height - across;
  return { distance: starts[end]! + Math.sqrt(dx * dx + dy * dy), along, across, end };
}

function isSeen(
  c: Crossing,
  origins: [[number, number], [number, number]],
  end: number,
  distances: Float64Array,
  starts: Float64Array,
): boolean {
  const [own, other, atOther] = end === 0 ? [c.a, c.b, c.length] : [c.b, c.a, 0];
  const place = origins[end]!;
  const bend = origins[1 - end]!;
  const along = atOther - place[0];
  const straight = starts[own]! + Math.sqrt(along * along + place[1] * place[1]);
  if (straight >= distances[other]! * (1 - EQUAL)) return true;
  if (bend[1] <= place[1]) return false;
  const border = crossingPoint(place[0], place[1], bend[0], bend[1]);
  const at = crossingPoint(place[0], place[1], c.cornerAlong, c.height);
  return end === 0 ? at <= border : at >= border;
}

function crossingPoint(x: number, y: number, toX: number, toY: number): number {
  const rise = toY - y;
  return rise > 0 ? x + (toX - x) * (-y / rise) : x;
}
