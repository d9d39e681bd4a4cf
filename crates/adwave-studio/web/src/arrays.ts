/**
 * GPU buffers of the shape: positions, normals, bands and masks of the original (`base`), of the edited shape as computed
 * by the worker (`edited`), of a compared method (`comparison`), and coarse versions with fewer triangles.
 */

import { BufferAttribute, BufferGeometry } from 'three';
import type { Bent } from './compute/messages';
import { nearestVertex } from './compute/pick';
import { setAttributeArray } from './geometry';
import type { ReshapedBy } from './protocol';
import { maskPacks } from './shader';
import { turn } from './turns';
import { VertexSubset } from './vertex-subset';

/** Largest number of triangles drawn in full during motion, without and with a GPU. */
const MOVING_LIMIT = { software: 60_000, hardware: 4_000_000 };
/** Number of triangles from which the shader sums the bands during motion. */
const LARGE = { software: 60_000, hardware: 300_000 };

/** Geometry to draw. */
export interface DrawnGeometry {
  geometry: BufferGeometry;
  /** True if the shader adds the bands to the positions. */
  summed: boolean;
  /** True for a coarse version with fewer triangles. */
  few: boolean;
}

export class ShapeArrays {
  nLevels = 0;
  cloud = false;
  /** How an edit is drawn before it is computed: as a sum of bands by the shader, or turned with the frames of a pull. */
  live: 'sum' | 'pull' | null = null;
  /** Scales of the bands for the shader, by level − 1. */
  scales: number[] = [];
  private readonly base = new BufferGeometry();
  private readonly edited = new BufferGeometry();
  /** Positions of a compared method, shown instead of the original. */
  private readonly comparison = new BufferGeometry();
  /** The shape at rest in a pose, to which the shader adds the edit. */
  private readonly posed = new BufferGeometry();
  /** The coarse version of `posed`. */
  private fewPosed: BufferGeometry | null = null;
  /** The edited shape while a handle is pulled, where the shader cannot sum its bands; coarse if there is a coarse version. */
  private readonly pulledShape = new BufferGeometry();
  /** Clones and pose of `posed`; `null` without any. */
  by: ReshapedBy | null = null;
  /** True if the original is colored by other numbers than the edited shape. */
  hasUneditedScalar = false;
  /** Normals and displacements by the edit, turned back to rest, of the vertices that are drawn during a pull. */
  private pulled: { normals: Int8Array; offsets: Float32Array } | null = null;
  private hasEdited = false;
  private hasComparison = false;
  private bands: Int16Array[] = [];
  /** Coarse versions of the original and of the edited shape. */
  private coarse: { base: VertexSubset; edited: VertexSubset } | null = null;
  private nTriangles = 0;
  private n = 0;

  constructor(
    private readonly software: boolean,
    /** Called when the picture must be redrawn. */
    private readonly onChange: () => void,
  ) {}

  /** Sets a new shape; the previous one must be cleared before. */
  setShape(positions: Float32Array, triangles: Uint32Array, cloud: boolean): BufferGeometry {
    this.n = positions.length / 3;
    this.cloud = cloud;
    this.nTriangles = triangles.length / 3;
    this.base.setAttribute('position', new BufferAttribute(positions, 3));
    const all = cloud ? null : new BufferAttribute(triangles, 1);
    for (const geometry of [this.base, this.edited, this.posed, this.comparison]) geometry.setIndex(all);
    return this.base;
  }

  /** Replaces the triangles by others of the same vertices, and those of the coarse version. */
  setTriangles(triangles: Uint32Array, coarse: Uint32Array | null): void {
    const all = new BufferAttribute(triangles, 1);
    for (const geometry of [this.base, this.edited, this.posed, this.comparison]) geometry.setIndex(all);
    if (coarse) {
      this.coarse?.base.geometry.dispose();
      this.coarse?.edited.geometry.dispose();
      this.setCoarse(coarse);
      // The pose is sent again for the new coarse version.
      if (this.fewPosed) this.setPosed(null, null);
    }
    this.onChange();
  }

  clear(): void {
    this.setPosed(null, null);
    for (const geometry of [this.base, this.edited, this.posed, this.comparison, this.pulledShape]) {
      geometry.dispose();
      for (const name of Object.keys(geometry.attributes)) geometry.deleteAttribute(name);
      geometry.setIndex(null);
    }
    this.coarse?.base.geometry.dispose();
    this.coarse?.edited.geometry.dispose();
    this.coarse = null;
    this.pulled = null;
    this.hasEdited = false;
    this.hasComparison = false;
    this.hasUneditedScalar = false;
    this.setLevels(0);
  }

  /** True if the shader sums the bands while a slider moves; for small shapes the worker is fast enough and gives smooth normals. */
  get large(): boolean {
    return (
      this.n > 0 &&
      this.nTriangles + (this.cloud ? this.n : 0) > (this.software ? LARGE.software : LARGE.hardware)
    );
  }

  /** True if the shape needs a coarse version during motion. */
  get heavy(): boolean {
    return this.isHeavy(this.nTriangles);
  }

  /** True if a shape of so many triangles needs a coarse version during motion. */
  isHeavy(nTriangles: number): boolean {
    return nTriangles > (this.software ? MOVING_LIMIT.software : MOVING_LIMIT.hardware);
  }

  /** True if a coarse version is needed and available. */
  get hasFew(): boolean {
    return this.heavy && this.coarse !== null;
  }

  /** Sets the normals of the original shape. */
  setNormals(normals: Int8Array): void {
    this.base.setAttribute('normal', new BufferAttribute(normals, 4, true));
    this.coarse?.base.copyAttribute('normal', normals, 4, true);
    this.onChange();
  }

  setEdited(positions: Float32Array, normals: Int8Array): void {
    setAttributeArray(this.edited, 'position', positions, 3, false);
    setAttributeArray(this.edited, 'normal', normals, 4, true);
    shareAttributes(this.edited, this.base, ['normal']);
    this.coarse?.edited.copyAttribute('position', positions, 3, false);
    this.coarse?.edited.copyAttribute('normal', normals, 4, true);
    this.hasEdited = true;
    this.live = null;
    this.pulled = null;
    this.onChange();
  }

  /** True if the shader turns the edit with the frames of a pose. */
  get isPosed(): boolean {
    return this.by !== null;
  }

  /** Vertices that are drawn while the shape moves; `null` if all are. */
  get drawn(): Uint32Array | null {
    return this.hasFew ? this.coarse!.base.vertices : null;
  }

  /** Places of all vertices of the original shape, relative to the center. */
  get originals(): Float32Array {
    return (this.base.getAttribute('position')?.array ?? new Float32Array(0)) as Float32Array;
  }

  /** Place of a vertex, relative to the center. */
  place(vertex: number): number[] {
    const array = this.places;
    return [array[3 * vertex]!, array[3 * vertex + 1]!, array[3 * vertex + 2]!];
  }

  /** Vertex that is nearest to a place, relative to the center. */
  nearest([x, y, z]: readonly number[]): number {
    return nearestVertex(this.places, x!, y!, z!);
  }

  private get places(): Float32Array {
    const geometry = this.hasEdited ? this.edited : this.base;
    return geometry.getAttribute('position').array as Float32Array;
  }

  /** Sets the shape at rest in a pose, of all vertices or of those that are drawn while it moves. */
  setPosed(by: ReshapedBy | null, bent: Bent | null): void {
    this.by = by;
    if (!by || !bent) {
      this.fewPosed?.dispose();
      this.fewPosed = null;
      return;
    }
    const { drawn } = this;
    const isFew = drawn !== null && bent.places.length === 3 * drawn.length;
    if (drawn) {
      this.fewPosed ??= new BufferGeometry();
      this.fewPosed.setIndex(this.coarse!.base.geometry.index);
      const few = isFew ? bent : pickVertices(bent, drawn);
      setAttributeArray(this.fewPosed, 'position', few.places, 3, false);
      setAttributeArray(this.fewPosed, 'turn', few.turns, 4, true);
    } else {
      setAttributeArray(this.posed, 'position', bent.places, 3, false);
      setAttributeArray(this.posed, 'turn', bent.turns, 4, true);
    }
  }

  /** Keeps what turns with the shape while a handle is pulled: its normals, and how far the edit moves each vertex. */
  startPull(): void {
    const { drawn, originals } = this;
    const shown = this.hasEdited ? this.edited : this.base;
    const normals = shown.getAttribute('normal')?.array;
    // The shape of a pull that has just ended is not computed yet.
    if (!this.large || !normals || (this.live && this.pulled)) return;
    const posed = this.by && (this.fewPosed ?? this.posed);
    const turns = posed?.getAttribute('turn')?.array ?? null;
    const rest = posed?.getAttribute('position')?.array ?? null;
    const n = drawn?.length ?? this.n;
    const pulled = { normals: new Int8Array(4 * n), offsets: new Float32Array(3 * n) };
    const [offset, out] = [
      [0, 0, 0],
      [0, 0, 0],
    ];
    for (let k = 0; k < n; k++) {
      const v = drawn ? drawn[k]! : k;
      for (let c = 0; c < 3; c++)
        offset[c] = this.places[3 * v + c]! - (rest ? rest[3 * k + c]! : originals[3 * v + c]!);
      pulled.offsets.set(turn(turns, k, -1, offset, 0, out), 3 * k);
      pulled.normals.set(turn(turns, k, -1, normals, 4 * v, out), 4 * k);
    }
    this.pulled = pulled;
  }

  /** True if the shape that is pulled has normals. */
  get hasPulledNormals(): boolean {
    return this.pulled !== null;
  }

  /** Largest and root mean square displacement of the vertices that are drawn while a handle is pulled. */
  pulledBy({ places, turns }: Bent): { greatest: number; rms: number } | null {
    const { drawn, originals, pulled } = this;
    if (places.length !== pulled?.offsets.length) return null;
    const offset = [0, 0, 0];
    let [most, sum] = [0, 0];
    const n = places.length / 3;
    for (let k = 0; k < n; k++) {
      const v = drawn ? drawn[k]! : k;
      turn(turns, k, 1, pulled.offsets, 3 * k, offset);
      let square = 0;
      for (let c = 0; c < 3; c++) square += (places[3 * k + c]! + offset[c]! - originals[3 * v + c]!) ** 2;
      most = Math.max(most, square);
      sum += square;
    }
    return { greatest: Math.sqrt(most), rms: Math.sqrt(sum / n) };
  }

  /**
   * Shows the shape that is pulled by what turns with it. Returns false if that is not known for the vertices of `bent`.
   */
  showPulled({ places, turns }: Bent): boolean {
    const { pulled, pulledShape } = this;
    if (places.length !== pulled?.offsets.length) return false;
    const positions = new Float32Array(places.length);
    const normals = new Int8Array(pulled.normals.length);
    const out = [0, 0, 0];
    for (let k = 0; 3 * k < places.length; k++) {
      turn(turns, k, 1, pulled.offsets, 3 * k, out);
      for (let c = 0; c < 3; c++) positions[3 * k + c] = places[3 * k + c]! + out[c]!;
      normals.set(turn(turns, k, 1, pulled.normals, 4 * k, out), 4 * k);
    }
    pulledShape.setIndex((this.hasFew ? this.coarse!.base.geometry : this.base).index);
    setAttributeArray(pulledShape, 'position', positions, 3, false);
    setAttributeArray(pulledShape, 'normal', normals, 4, true);
    this.live = 'pull';
    return true;
  }

  /** Discards the edited shape, so that the original is shown. */
  setUnedited(): void {
    this.hasEdited = false;
    this.live = null;
    this.onChange();
  }

  /** Shows a compared method instead of the original; `null` shows the original again. */
  setComparison(positions: Float32Array | null, normals: Int8Array | null): void {
    this.hasComparison = positions !== null;
    if (positions && normals) {
      setAttributeArray(this.comparison, 'position', positions, 3, false);
      setAttributeArray(this.comparison, 'normal', normals, 4, true);
      shareAttributes(this.comparison, this.base, ['normal']);
    }
    this.onChange();
  }

  /** Sets the number of levels and discards all bands. */
  setLevels(nLevels: number): void {
    const few = this.coarse ? [this.coarse.base.geometry] : [];
    if (this.fewPosed) few.push(this.fewPosed);
    for (const geometry of [this.base, this.edited, this.posed, this.pulledShape, ...few]) {
      for (let j = 0; j < 64; j++) geometry.deleteAttribute(`band${j}`);
    }
    this.nLevels = nLevels;
    this.scales = [];
    this.bands = [];
    this.live = null;
  }

  setBand(level: number, scale: number, values: Int16Array): void {
    // The shader reads normalized integers, value / 32767.
    this.scales[level - 1] = scale * 32767;
    if (maskPacks(this.nLevels, 0) === null) return;
    this.bands[level - 1] = values;
    if (this.heavy) {
      // Only the coarse version is summed by the shader.
      this.coarse?.base.copyAttribute(`band${level - 1}`, values, 4, true);
      return;
    }
    if (!this.large) return;
    const attribute = new BufferAttribute(values, 4, true);
    this.base.setAttribute(`band${level - 1}`, attribute);
    // Attaching the band to the drawn geometry uploads it now instead of at the first slider movement.
    if (this.hasEdited) this.edited.setAttribute(`band${level - 1}`, attribute);
    this.onChange();
  }

  /** Sets the coarse triangles and copies all attributes for them. */
  setCoarse(triangles: Uint32Array): void {
    const base = new VertexSubset(triangles, this.n);
    const edited = new VertexSubset(triangles, this.n);
    copyAllAttributes(base, this.base);
    for (const [j, values] of this.bands.entries())
      if (values) base.copyAttribute(`band${j}`, values, 4, true);
    if (this.hasEdited) copyAllAttributes(edited, this.edited);
    this.coarse = { base, edited };
  }

  /** Updates the mask of a slot from vertex `from` on. */
  setMask(slot: number, from: number, bytes: Uint8Array): void {
    if (slot > 7) return;
    const name = `masks${slot >> 2}`;
    let attribute = this.base.getAttribute(name) as BufferAttribute | undefined;
    if (!attribute) {
      attribute = new BufferAttribute(new Uint8Array(4 * this.n), 4, true);
      this.base.setAttribute(name, attribute);
      if (this.hasEdited) this.edited.setAttribute(name, attribute);
    }
    const array = attribute.array as Uint8Array;
    for (let v = 0, k = 4 * from + (slot & 3); v < bytes.length; v++, k += 4) array[k] = bytes[v]!;
    attribute.addUpdateRange(4 * from, 4 * bytes.length);
    attribute.needsUpdate = true;
    for (const few of this.coarse ? [this.coarse.base, this.coarse.edited] : []) {
      if (few.geometry.hasAttribute(name)) few.copyRange(name, array, from, from + bytes.length);
      else few.copyAttribute(name, array, 4, true);
    }
    this.onChange();
  }

  /** Sets one number per vertex, shown as colors. */
  setScalar(values: Float32Array): void {
    setAttributeArray(this.base, 'scalar', values, 1, false);
    if (this.hasEdited) this.edited.setAttribute('scalar', this.base.getAttribute('scalar'));
    this.coarse?.base.copyAttribute('scalar', values, 1, false);
    this.coarse?.edited.copyAttribute('scalar', values, 1, false);
  }

  /** Sets the numbers that color the original, if those of the edited shape differ. */
  setUneditedScalar(values: Float32Array | null): void {
    this.hasUneditedScalar = values !== null;
    if (!values) return;
    setAttributeArray(this.base, 'unedited', values, 1, false);
    this.coarse?.base.copyAttribute('unedited', values, 1, false);
  }

  /** Sets the colors of the file, `u8 × 4 × n`. */
  setRgb(colors: Uint8Array): void {
    const attribute = new BufferAttribute(colors, 4, true);
    this.base.setAttribute('paint', attribute);
    if (this.hasEdited) this.edited.setAttribute('paint', attribute);
    if (this.hasComparison) this.comparison.setAttribute('paint', attribute);
    this.coarse?.base.copyAttribute('paint', colors, 4, true);
    this.coarse?.edited.copyAttribute('paint', colors, 4, true);
  }

  /** Selects the original (or the compared method) or the edited shape; its coarse version if `few` and available. */
  selectGeometry(before: boolean, few: boolean): DrawnGeometry {
    // The compared method has no coarse version.
    if (before && this.hasComparison) {
      shareAttributes(this.comparison, this.base, ['normal']);
      return { geometry: this.comparison, summed: false, few: false };
    }
    if (!before && this.live === 'pull') {
      const few = this.hasFew;
      shareAttributes(this.pulledShape, few ? this.coarse!.base.geometry : this.base, ['normal']);
      return { geometry: this.pulledShape, summed: false, few };
    }
    const summed = !before && this.live === 'sum' && this.nLevels > 0;
    if (summed && this.by) {
      const geometry = this.fewPosed ?? this.posed;
      const { pulled } = this;
      if (pulled) setAttributeArray(geometry, 'normal', pulled.normals, 4, true);
      const of = this.fewPosed ? this.coarse!.base.geometry : this.base;
      shareAttributes(geometry, of, pulled ? ['normal'] : []);
      return { geometry, summed, few: this.fewPosed !== null };
    }
    const which = !before && !summed && this.hasEdited ? 'edited' : 'base';
    const coarse = few ? this.coarse : null;
    return { geometry: coarse ? coarse[which].geometry : this[which], summed, few: coarse !== null };
  }
}

/** Shares all attributes of another geometry other than positions and those of the names `own`. */
function shareAttributes(to: BufferGeometry, from: BufferGeometry, own: readonly string[] = []): void {
  for (const [name, attribute] of Object.entries(from.attributes)) {
    if (name !== 'position' && !own.includes(name) && to.getAttribute(name) !== attribute)
      to.setAttribute(name, attribute);
  }
}

/** Places and turns of some vertices. */
function pickVertices({ places, turns }: Bent, vertices: Uint32Array): Bent {
  const few = { places: new Float32Array(3 * vertices.length), turns: new Int16Array(4 * vertices.length) };
  for (const [k, v] of vertices.entries()) {
    few.places.set(places.subarray(3 * v, 3 * v + 3), 3 * k);
    few.turns.set(turns.subarray(4 * v, 4 * v + 4), 4 * k);
  }
  return few;
}

function copyAllAttributes(few: VertexSubset, all: BufferGeometry): void {
  for (const [name, attribute] of Object.entries(all.attributes)) {
    const { array, itemSize, normalized } = attribute as BufferAttribute;
    few.copyAttribute(name, array, itemSize, normalized);
  }
}
