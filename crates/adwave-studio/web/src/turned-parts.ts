/** Parts of a mesh whose faces are turned over by the edit: their triangles in the picture and in the worker. */

import { coarseTriangles } from './compute/coarse';
import { volume } from './compute/positions';
import type { Shape } from './protocol';
import type { Studio } from './studio';

/** The list with or without a part, ascending. */
export function withTurned(turned: readonly number[], parts: readonly number[], on: boolean): number[] {
  const others = turned.filter((vertex) => !parts.includes(vertex));
  return (on ? [...others, ...parts] : others).sort((a, b) => a - b);
}

/** First vertices of the parts whose faces point inward and are not turned by the edit. */
export function stillInward({ inward }: Shape, turned: readonly number[]): number[] {
  return (inward ?? []).map((part) => part.vertex).filter((vertex) => !turned.includes(vertex));
}

/** Triangles of which those of some parts are turned over: their second and third corners are exchanged. */
export function turnedTriangles(
  triangles: Uint32Array,
  partOfVertex: Uint32Array,
  turned: readonly number[],
): Uint32Array<ArrayBuffer> {
  const isTurned = new Set(turned);
  const out = new Uint32Array(triangles);
  for (let t = 0; t < out.length; t += 3) {
    if (!isTurned.has(partOfVertex[out[t]!]!)) continue;
    const second = out[t + 1]!;
    out[t + 1] = out[t + 2]!;
    out[t + 2] = second;
  }
  return out;
}

export class TurnedParts {
  private triangles = new Uint32Array(0);
  private nCoarse = 0;
  /** First vertex of the part of each vertex; `null` until it is needed. */
  private partOfVertex: Promise<Uint32Array> | null = null;
  private shown: readonly number[] = [];
  private turn = 0;
  /** Volume that the unedited shape encloses with its turned parts; `null` if that of the shape holds. */
  private volumeBefore: number | null = null;

  constructor(private readonly studio: Studio) {}

  /** Takes the triangles of a new shape, and the number of those of its coarse version. */
  reset(triangles: Uint32Array<ArrayBuffer>, nCoarse: number): void {
    this.turn++;
    this.triangles = triangles;
    this.nCoarse = nCoarse;
    this.partOfVertex = null;
    this.shown = [];
    this.volumeBefore = null;
    this.light();
  }

  /** Volume of the unedited shape, `null` if it encloses none. */
  get volume(): number | null {
    return this.volumeBefore ?? this.studio.shape?.volume ?? null;
  }

  /** First vertex of the part of a vertex; `null` if it has no faces. */
  async partAt(vertex: number): Promise<number | null> {
    const part = (await this.parts())[vertex];
    return part === undefined || part === 0xffffffff ? null : part;
  }

  private parts(): Promise<Uint32Array> {
    this.partOfVertex ??= this.studio.api.indices(`shapes/${this.studio.shape!.id}/parts`);
    return this.partOfVertex;
  }

  /** Turns parts over, or back, as one step. */
  set(parts: readonly number[], on: boolean): void {
    const { doc, history } = this.studio;
    history.commit({ ...doc, turned: withTurned(doc.turned, parts, on) });
  }

  /** Shows the faces as the document has them. */
  async show(): Promise<void> {
    const { studio } = this;
    const { turned } = studio.doc;
    if (studio.isGrid || !studio.shape || sameNumbers(turned, this.shown)) return;
    const turn = ++this.turn;
    this.shown = turned;
    const { view, engine } = studio;
    const triangles = turned.length
      ? turnedTriangles(this.triangles, await this.parts(), turned)
      : new Uint32Array(this.triangles);
    if (turn !== this.turn) return;
    const { originals } = view.arrays;
    this.volumeBefore = studio.shape.volume === null ? null : volume(originals, triangles);
    const { normals } = await engine.call('turn', { triangles });
    if (turn !== this.turn) return;
    const coarse = view.arrays.hasFew ? coarseTriangles(originals, triangles, this.nCoarse) : null;
    view.arrays.setTriangles(triangles, coarse);
    view.arrays.setNormals(normals);
    this.light();
    studio.display.settle();
    studio.emit('turned');
  }

  /** Lights the backs like the fronts while faces point inward. */
  private light(): void {
    const { shape, view } = this.studio;
    if (!shape) return;
    view.lit = stillInward(shape, this.shown).length > 0 ? 'both' : 'front';
    view.request();
  }
}

export function sameNumbers(a: readonly number[], b: readonly number[]): boolean {
  return a.length === b.length && a.every((x, i) => x === b[i]);
}
