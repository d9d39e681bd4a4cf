/**
 * Packed undo data of a stroke: the previous values of a mask at the vertices that it changed. Vertices are ordered along
 * the server's space-filling curve, so that a stroke consists of few runs, most of them with one value.
 */

/** Growing byte buffer with numbers of variable length. */
class VarintWriter {
  private bytes = new Uint8Array(256);
  private size = 0;

  byte(value: number): void {
    if (this.size === this.bytes.length) {
      const larger = new Uint8Array(2 * this.size);
      larger.set(this.bytes);
      this.bytes = larger;
    }
    this.bytes[this.size++] = value;
  }

  /** Writes a number with seven bits per byte, lowest first. */
  number(value: number): void {
    let rest = value;
    for (; rest > 127; rest >>>= 7) this.byte((rest & 127) | 128);
    this.byte(rest);
  }

  get all(): Uint8Array {
    return this.bytes.slice(0, this.size);
  }
}

class VarintReader {
  private at = 0;
  constructor(private readonly bytes: Uint8Array) {}

  byte(): number {
    return this.bytes[this.at++]!;
  }

  number(): number {
    let value = 0;
    for (let shift = 0; ; shift += 7) {
      const byte = this.byte();
      value |= (byte & 127) << shift;
      if (byte < 128) return value >>> 0;
    }
  }
}

/** Shortest run of equal values that is written with its length. */
const RUN = 3;

/** Packs the previous values at `ranks`, ascending: first the runs of ranks, then the runs of values. */
export function packBefore(ranks: Uint32Array, before: (i: number) => number): Uint8Array {
  const out = new VarintWriter();
  const n = ranks.length;
  let nRuns = 0;
  for (let i = 0; i < n; i++) if (i === 0 || ranks[i] !== ranks[i - 1]! + 1) nRuns++;
  out.number(nRuns);
  for (let i = 0, end = 0; i < n; ) {
    let j = i + 1;
    while (j < n && ranks[j] === ranks[j - 1]! + 1) j++;
    out.number(ranks[i]! - end);
    out.number(j - i);
    end = ranks[j - 1]! + 1;
    i = j;
  }
  const equalFrom = (i: number) => {
    let j = i + 1;
    while (j < n && before(j) === before(i)) j++;
    return j;
  };
  for (let i = 0; i < n; ) {
    const end = equalFrom(i);
    if (end - i >= RUN) {
      out.number(2 * (end - i));
      out.byte(before(i));
      i = end;
      continue;
    }
    let j = end;
    for (let next = j; j < n; j = next) {
      next = equalFrom(j);
      if (next - j >= RUN) break;
    }
    out.number(2 * (j - i) + 1);
    for (; i < j; i++) out.byte(before(i));
  }
  return out.all;
}

/** Calls `see` with each rank and its previous value. */
export function unpackBefore(packed: Uint8Array, see: (rank: number, value: number) => void): void {
  const runs = new VarintReader(packed);
  const n = runs.number();
  const lengths: number[] = [];
  for (let k = 0; k < 2 * n; k++) lengths.push(runs.number());
  // The values follow.
  let left = 0;
  let equal = false;
  let value = 0;
  let rank = 0;
  for (let k = 0; k < 2 * n; k += 2) {
    rank += lengths[k]!;
    for (let i = 0; i < lengths[k + 1]!; i++, rank++, left--) {
      if (left === 0) {
        const head = runs.number();
        left = head >>> 1;
        equal = head % 2 === 0;
        if (equal) value = runs.byte();
      }
      if (!equal) value = runs.byte();
      see(rank, value);
    }
  }
}
