/**
 * The shape as the graphics have it: positions, normals, bands and masks of its vertices, as it was opened (`base`), after the edit as
 * the worker gave it (`edited`), as another method has it (`other`), and the same with fewer triangles.
 */

import { BufferAttribute, BufferGeometry } from 'three';
import { Compact } from './compact';
import { replace } from './geometry';
import { maskPacks } from './shader';

/** Triangles up to which a moving shape is drawn in full: without and with a graphics processor. */
const MOVING_LIMIT = { software: 60_000, hardware: 4_000_000 };
/** Triangles from which the shader sums what moves. */
const LARGE = { software: 60_000, hardware: 300_000 };

/** What is to be drawn of a shape. */
export interface Drawn {
  geometry: BufferGeometry;
  /** Whether the shader adds the bands to its positions. */
  summed: boolean;
  /** Whether it has fewer triangles. */
  few: boolean;
}

export class ShapeArrays {
  nLevels = 0;
  cloud = false;
  /** Whether the edit is drawn as a sum by the shader. */
  live = false;
  /** Of the bands, by level − 1, as the shader needs them. */
  scales: number[] = [];
  private readonly base = new BufferGeometry();
  private readonly edited = new BufferGeometry();
  /** Another shape of the same vertices, shown in place of the one that was opened. */
  private readonly other = new BufferGeometry();
  private hasEdited = false;
  private hasOther = false;
  private bands: Int16Array[] = [];
  /** Fewer triangles, as opened and after the edit. */
  private coarse: { base: Compact; edited: Compact } | null = null;
  private nTriangles = 0;
  private n = 0;

  constructor(
    private readonly software: boolean,
    /** Called when what is drawn is another. */
    private readonly changed: () => void,
  ) {}

  /** A new shape; what there was is cleared before. */
  setShape(positions: Float32Array, triangles: Uint32Array, cloud: boolean): BufferGeometry {
    this.n = positions.length / 3;
    this.cloud = cloud;
    this.nTriangles = triangles.length / 3;
    this.base.setAttribute('position', new BufferAttribute(positions, 3));
    const all = cloud ? null : new BufferAttribute(triangles, 1);
    for (const geometry of [this.base, this.edited, this.other]) geometry.setIndex(all);
    return this.base;
  }

  clear(): void {
    for (const geometry of [this.base, this.edited, this.other]) {
      geometry.dispose();
      for (const name of Object.keys(geometry.attributes)) geometry.deleteAttribute(name);
      geometry.setIndex(null);
    }
    this.coarse?.base.geometry.dispose();
    this.coarse?.edited.geometry.dispose();
    this.coarse = null;
    this.hasEdited = false;
    this.hasOther = false;
    this.setLevels(0);
  }

  /** Whether moving sliders are summed by the shader; else the worker is fast enough, and its normals are smooth. */
  get large(): boolean {
    return (
      this.n > 0 &&
      this.nTriangles + (this.cloud ? this.n : 0) > (this.software ? LARGE.software : LARGE.hardware)
    );
  }

  /** Whether a moving shape needs fewer triangles. */
  get heavy(): boolean {
    return this.nTriangles > (this.software ? MOVING_LIMIT.software : MOVING_LIMIT.hardware);
  }

  /** Whether there are fewer triangles for a shape that needs them while it moves. */
  get hasFew(): boolean {
    return this.heavy && this.coarse !== null;
  }

  /** Normals of the shape as it was opened. */
  setNormals(normals: Int8Array): void {
    this.base.setAttribute('normal', new BufferAttribute(normals, 4, true));
    this.coarse?.base.take('normal', normals, 4, true);
    this.changed();
  }

  setEdited(positions: Float32Array, normals: Int8Array): void {
    replace(this.edited, 'position', positions, 3, false);
    replace(this.edited, 'normal', normals, 4, true);
    this.shareAttributes(this.edited);
    this.coarse?.edited.take('position', positions, 3, false);
    this.coarse?.edited.take('normal', normals, 4, true);
    this.hasEdited = true;
    this.live = false;
    this.changed();
  }

  /** Forgets the edited shape: what is shown is the shape as it was opened. */
  setUnedited(): void {
    this.hasEdited = false;
    this.live = false;
    this.changed();
  }

  /** Another shape of the same vertices in place of the one that was opened, or that one again. */
  setOther(positions: Float32Array | null, normals: Int8Array | null): void {
    this.hasOther = positions !== null;
    if (positions && normals) {
      replace(this.other, 'position', positions, 3, false);
      replace(this.other, 'normal', normals, 4, true);
      this.shareAttributes(this.other);
    }
    this.changed();
  }

  /** What is not of a position is that of the shape as it was opened. */
  private shareAttributes(geometry: BufferGeometry): void {
    for (const [name, attribute] of Object.entries(this.base.attributes)) {
      if (name !== 'position' && name !== 'normal') geometry.setAttribute(name, attribute);
    }
  }

  /** Other levels, whose bands have not come yet. */
  setLevels(nLevels: number): void {
    const few = this.coarse ? [this.coarse.base.geometry] : [];
    for (const geometry of [this.base, this.edited, ...few]) {
      for (let j = 0; j < 64; j++) geometry.deleteAttribute(`band${j}`);
    }
    this.nLevels = nLevels;
    this.scales = [];
    this.bands = [];
    this.live = false;
  }

  setBand(level: number, scale: number, values: Int16Array): void {
    // What the shader sees is value / 32767.
    this.scales[level - 1] = scale * 32767;
    if (maskPacks(this.nLevels, 0) === null) return;
    this.bands[level - 1] = values;
    if (this.heavy) {
      // Only the few vertices that are drawn while it moves need them there.
      this.coarse?.base.take(`band${level - 1}`, values, 4, true);
      return;
    }
    if (!this.large) return;
    const attribute = new BufferAttribute(values, 4, true);
    this.base.setAttribute(`band${level - 1}`, attribute);
    // What is drawn is what is sent to the graphics: not only when a slider is moved first.
    if (this.hasEdited) this.edited.setAttribute(`band${level - 1}`, attribute);
    this.changed();
  }

  /** Fewer triangles, which have all that the others have. */
  setCoarse(triangles: Uint32Array): void {
    const base = new Compact(triangles, this.n);
    const edited = new Compact(triangles, this.n);
    takeAll(base, this.base);
    for (const [j, values] of this.bands.entries()) if (values) base.take(`band${j}`, values, 4, true);
    if (this.hasEdited) takeAll(edited, this.edited);
    this.coarse = { base, edited };
  }

  /** Values of one layer's mask from vertex `from` on. */
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
      if (few.geometry.hasAttribute(name)) few.takeRange(name, array, from, from + bytes.length);
      else few.take(name, array, 4, true);
    }
    this.changed();
  }

  /** A number of each vertex, for colors. */
  setScalar(values: Float32Array): void {
    replace(this.base, 'scalar', values, 1, false);
    if (this.hasEdited) this.edited.setAttribute('scalar', this.base.getAttribute('scalar'));
    this.coarse?.base.take('scalar', values, 1, false);
    this.coarse?.edited.take('scalar', values, 1, false);
  }

  /** The shape as it was opened (or the other one in its place), or the present edit; with few triangles where there are any. */
  drawn(before: boolean, few: boolean): Drawn {
    // The other shape has no coarse triangles of its own: it is drawn in full.
    if (before && this.hasOther) return { geometry: this.other, summed: false, few: false };
    const summed = !before && this.live && this.nLevels > 0;
    const which = !before && !summed && this.hasEdited ? 'edited' : 'base';
    const coarse = few ? this.coarse : null;
    return { geometry: coarse ? coarse[which].geometry : this[which], summed, few: coarse !== null };
  }
}

function takeAll(few: Compact, all: BufferGeometry): void {
  for (const [name, attribute] of Object.entries(all.attributes)) {
    const { array, itemSize, normalized } = attribute as BufferAttribute;
    few.take(name, array, itemSize, normalized);
  }
}
