/** Bounding sphere of positions, and updates of vertex attributes. */

import { BufferAttribute, type BufferGeometry } from 'three';

/** Corners and center of the bounding box, and the largest distance of a vertex from the center. */
export function boundsOf(p: Float32Array): {
  low: number[];
  high: number[];
  center: number[];
  radius: number;
} {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < p.length; i += 3) {
    for (let c = 0; c < 3; c++) {
      const x = p[i + c]!;
      if (x < low[c]!) low[c] = x;
      if (x > high[c]!) high[c] = x;
    }
  }
  const center = low.map((x, c) => (x + high[c]!) / 2);
  let radius = 0;
  const [cx, cy, cz] = center as [number, number, number];
  for (let i = 0; i < p.length; i += 3) {
    const d = (p[i]! - cx) ** 2 + (p[i + 1]! - cy) ** 2 + (p[i + 2]! - cz) ** 2;
    if (d > radius) radius = d;
  }
  return { low, high, center, radius: Math.sqrt(radius) };
}

/** Sets the array of an attribute; reuses the buffer if size and type are the same. */
export function setAttributeArray(
  geometry: BufferGeometry,
  name: string,
  array: Float32Array | Int8Array | Int16Array,
  itemSize: number,
  normalized: boolean,
): void {
  const attribute = geometry.getAttribute(name) as BufferAttribute | undefined;
  if (
    attribute &&
    attribute.array.length === array.length &&
    attribute.array.constructor === array.constructor
  ) {
    attribute.array = array as typeof attribute.array;
    attribute.needsUpdate = true;
  } else {
    geometry.setAttribute(name, new BufferAttribute(array, itemSize, normalized));
  }
}
