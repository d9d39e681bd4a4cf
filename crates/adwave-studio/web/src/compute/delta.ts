/** What a stroke changed in a mask, packed: it undoes and redoes the stroke. */

/** Gaps between touched vertices, a byte each (255: go on adding), and what is to be xored there. */
export interface MaskDelta {
  gaps: Uint8Array;
  changes: Uint8Array;
}

export function packDelta(touched: Uint32Array, before: (v: number) => number, after: Uint8Array): MaskDelta {
  const sorted = touched.slice().sort();
  const gaps: number[] = [];
  const changes: number[] = [];
  let last = -1;
  for (const v of sorted) {
    const change = before(v) ^ after[v]!;
    if (change === 0 || v === last) continue;
    let gap = v - last - 1;
    for (; gap >= 255; gap -= 255) gaps.push(255);
    gaps.push(gap);
    changes.push(change);
    last = v;
  }
  return { gaps: Uint8Array.from(gaps), changes: Uint8Array.from(changes) };
}

/** Undoes or redoes: the range of vertices that changed, or null. */
export function applyDelta(mask: Uint8Array, delta: MaskDelta): [number, number] | null {
  let v = -1;
  let k = 0;
  let first = -1;
  let gap = 0;
  for (const g of delta.gaps) {
    gap += g;
    if (g === 255) continue;
    v += gap + 1;
    gap = 0;
    mask[v]! ^= delta.changes[k++]!;
    if (first < 0) first = v;
  }
  return first < 0 ? null : [first, v + 1];
}
