/**
 * Subset of the vertices, contiguous in memory, for a coarse set of triangles. Without it the GPU would fetch every tenth
 * vertex out of a dozen long arrays.
 */

import { BufferAttribute, BufferGeometry, type TypedArray } from 'three';

export class VertexSubset {
  readonly geometry = new BufferGeometry();
  /** Indices of the vertices, ascending. */
  readonly vertices: Uint32Array;

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

  /** Copies the values of the subset from an array of all vertices. */
  copyAttribute(name: string, all: TypedArray, itemSize: number, normalized: boolean): void {
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

  /** Copies only the vertices `from` up to `to` of an existing attribute. */
  copyRange(name: string, all: TypedArray, from: number, to: number): void {
    const attribute = this.geometry.getAttribute(name) as BufferAttribute | undefined;
    if (!attribute) return;
    const { array, itemSize } = attribute;
    const first = this.lowerBound(from);
    const end = this.lowerBound(to);
    if (first === end) return;
    for (let i = first, k = itemSize * first; i < end; i++) {
      const at = itemSize * this.vertices[i]!;
      for (let c = 0; c < itemSize; c++) array[k++] = all[at + c]!;
    }
    attribute.addUpdateRange(itemSize * first, itemSize * (end - first));
    attribute.needsUpdate = true;
  }

  /** Position of the first vertex that is not less than `v`. */
  private lowerBound(v: number): number {
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
