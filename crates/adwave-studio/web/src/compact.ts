/**
 * A few of the vertices with all that they have, close together in memory: what a coarse set of triangles needs. Without it
 * the graphics would fetch every tenth vertex out of a dozen long arrays.
 */

import { BufferAttribute, BufferGeometry, type TypedArray } from 'three';

export class Compact {
  readonly geometry = new BufferGeometry();
  /** The vertices, ascending. */
  private readonly vertices: Uint32Array;

  constructor(triangles: Uint32Array, n: number) {
    const place = new Int32Array(n).fill(-1);
    for (const v of triangles) place[v] = 0;
    let size = 0;
    for (let v = 0; v < n; v++) if (place[v] === 0) place[v] = size++;
    this.vertices = new Uint32Array(size);
    for (let v = 0; v < n; v++) if (place[v]! >= 0) this.vertices[place[v]!] = v;
    this.geometry.setIndex(
      new BufferAttribute(
        triangles.map((v) => place[v]!),
        1,
      ),
    );
  }

  /** Takes the values of these vertices from those of all. */
  take(name: string, all: TypedArray, itemSize: number, normalized: boolean): void {
    let attribute = this.geometry.getAttribute(name) as BufferAttribute | undefined;
    if (attribute?.array.constructor !== all.constructor) {
      const kind = all.constructor as new (size: number) => TypedArray;
      attribute = new BufferAttribute(new kind(itemSize * this.vertices.length), itemSize, normalized);
      this.geometry.setAttribute(name, attribute);
    }
    const { array } = attribute;
    for (let i = 0, k = 0; i < this.vertices.length; i++) {
      const from = itemSize * this.vertices[i]!;
      for (let c = 0; c < itemSize; c++) array[k++] = all[from + c]!;
    }
    attribute.needsUpdate = true;
  }

  /** Takes the values of the vertices from `from` up to `to` only, of an attribute that is there. */
  takeRange(name: string, all: TypedArray, from: number, to: number): void {
    const attribute = this.geometry.getAttribute(name) as BufferAttribute | undefined;
    if (!attribute) return;
    const { array, itemSize } = attribute;
    const first = this.firstFrom(from);
    const end = this.firstFrom(to);
    if (first === end) return;
    for (let i = first, k = itemSize * first; i < end; i++) {
      const at = itemSize * this.vertices[i]!;
      for (let c = 0; c < itemSize; c++) array[k++] = all[at + c]!;
    }
    attribute.addUpdateRange(itemSize * first, itemSize * (end - first));
    attribute.needsUpdate = true;
  }

  /** The place of the first vertex that is `v` or after it. */
  private firstFrom(v: number): number {
    let low = 0;
    let high = this.vertices.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.vertices[middle]! < v) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}
