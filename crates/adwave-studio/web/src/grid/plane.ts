/** Part of an image or a slice of a volume: its values and bands, and the values after an edit. */

import type { GridInfo, SliceView } from '../protocol';

/** Rectangle of indices of which every `step`-th row and column is loaded. */
export interface Part {
  /** Index along the axis that is fixed; 0 in an image. */
  index: number;
  /** Frame of a series; `null` without frames. */
  frame: number | null;
  from: [number, number];
  to: [number, number];
  step: number;
}

/** Number of rows and columns of a part that are loaded. */
export function sizesOf({ from, to, step }: Part): [number, number] {
  return [Math.ceil((to[0] - from[0]) / step), Math.ceil((to[1] - from[1]) / step)];
}

/** Query of the request for a part. */
export function queryOf(view: SliceView, { index, frame, from, to, step }: Part): string {
  const fixed = view.fixed === null ? '' : `&index=${index}`;
  const ofSeries = frame === null ? '' : `&frame=${frame}`;
  return `axes=${view.axes}&from=${from}&to=${to}&step=${step}${fixed}${ofSeries}`;
}

export class Plane {
  readonly rows: number;
  readonly columns: number;
  /** Values of the file, `rows × columns × channels`; NaN at places without data. */
  readonly values: Float32Array;
  /** Values after the edit. */
  readonly edited: Float32Array;
  private readonly bands: Float32Array[];

  constructor(
    readonly part: Part,
    readonly nChannels: number,
    /** The values and then the bands from fine to coarse. */
    content: Float32Array,
  ) {
    [this.rows, this.columns] = sizesOf(part);
    const n = this.rows * this.columns * nChannels;
    if (n === 0 || content.length % n !== 0) throw new Error(`a plane of ${n} values has ${content.length}`);
    this.values = content.subarray(0, n);
    this.edited = this.values.slice();
    this.bands = [];
    for (let at = n; at < content.length; at += n) this.bands.push(content.subarray(at, at + n));
  }

  get nLevels(): number {
    return this.bands.length;
  }

  /** Computes the values after an edit with these gains: f + Σ_j (Γ_j − 1) W_j. */
  edit(gains: ArrayLike<number>): void {
    const { edited, values } = this;
    edited.set(values);
    for (const [j, band] of this.bands.entries()) {
      const by = (gains[j] ?? 1) - 1;
      if (by === 0) continue;
      for (let i = 0; i < edited.length; i++) edited[i]! += by * band[i]!;
    }
  }

  /** Number of a place among those loaded, from its indices in the grid; −1 outside. */
  at(row: number, column: number): number {
    const { from, step } = this.part;
    const r = Math.round((row - from[0]) / step);
    const c = Math.round((column - from[1]) / step);
    return r < 0 || c < 0 || r >= this.rows || c >= this.columns ? -1 : r * this.columns + c;
  }

  /** Sizes of the bands at a place, the largest of its channels. */
  spectrumAt(place: number): number[] {
    const channels = Array.from({ length: this.nChannels }, (_, c) => place * this.nChannels + c);
    return this.bands.map((band) => Math.max(...channels.map((k) => Math.abs(band[k]!))));
  }
}

/** Position of a place in the coordinates of the file, from its index along each axis. */
export function positionOf(grid: GridInfo, at: readonly number[]): number[] {
  return [0, 1, 2].map((c) => at.reduce((sum, k, axis) => sum + k * grid.steps[axis]![c]!, grid.origin[c]!));
}

/**
 * Part to load for the indices that are seen, `null` if the loaded one will do. Only as many rows and columns are loaded as the
 * screen shows, and at most `most` values, with a margin to move within.
 */
export function partFor(
  sizes: readonly [number, number],
  seen: { low: readonly [number, number]; high: readonly [number, number]; perPixel: number },
  most: number,
  loaded: Part | null,
): Part | null {
  const clip = (x: number, k: 0 | 1) => Math.min(sizes[k], Math.max(0, x));
  const low = [clip(Math.floor(seen.low[0]), 0), clip(Math.floor(seen.low[1]), 1)] as const;
  const high = [clip(Math.ceil(seen.high[0]) + 1, 0), clip(Math.ceil(seen.high[1]) + 1, 1)] as const;
  if (high[0] <= low[0] || high[1] <= low[1]) return null;
  const isWhole = sizes[0] * sizes[1] <= most;
  const margin = ([0, 1] as const).map((k) => (isWhole ? sizes[k] : Math.ceil((high[k] - low[k]) / 4)));
  let step = isWhole ? 1 : Math.max(1, Math.floor(seen.perPixel));
  const from: [number, number] = [clip(low[0] - margin[0]!, 0), clip(low[1] - margin[1]!, 1)];
  const to: [number, number] = [clip(high[0] + margin[0]!, 0), clip(high[1] + margin[1]!, 1)];
  while (Math.ceil((to[0] - from[0]) / step) * Math.ceil((to[1] - from[1]) / step) > most) step++;
  const covers =
    loaded !== null &&
    loaded.step <= step &&
    ([0, 1] as const).every((k) => loaded.from[k] <= low[k] && loaded.to[k] >= high[k]);
  return covers ? null : { index: 0, frame: null, from, to, step };
}
