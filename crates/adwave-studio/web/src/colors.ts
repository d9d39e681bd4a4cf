/** Color maps and the displayed range of a field. */

/** `classes` is a palette for numbered classes, entry 0 … 255 of the table. */
export type MapName = 'viridis' | 'diverging' | 'gray' | 'classes';

type Rgb = [number, number, number];

/** Coefficients of polynomials of degree 6 that approximate viridis within a few units of 255. */
const VIRIDIS: Rgb[] = [
  [0.2777273272234177, 0.005407344544966578, 0.3340998053353061],
  [0.1050930431085774, 1.404613529898575, 1.384590162594685],
  [-0.3308618287255563, 0.214847559468213, 0.09509516302823659],
  [-4.634230498983486, -5.799100973351585, -19.33244095627987],
  [6.228269936347081, 14.17993336680509, 56.69055260068105],
  [4.776384997670288, -13.74514537774601, -65.35303263337234],
  [-5.435455855934631, 4.645852612178535, 26.3124352495832],
];

/** Blue, pale, red, with symmetric lightness. */
const DIVERGING: Rgb[] = [
  [0.13, 0.28, 0.6],
  [0.37, 0.57, 0.82],
  [0.93, 0.92, 0.9],
  [0.86, 0.48, 0.36],
  [0.6, 0.11, 0.16],
];

/** Colors of classes, which differ in lightness too; they repeat. */
const CLASSES: Rgb[] = [
  [0.12, 0.47, 0.71],
  [1, 0.73, 0.47],
  [0.17, 0.55, 0.24],
  [0.84, 0.15, 0.16],
  [0.77, 0.69, 0.84],
  [0.55, 0.34, 0.29],
  [0.97, 0.71, 0.82],
  [0.09, 0.75, 0.81],
  [0.74, 0.74, 0.13],
  [0.42, 0.24, 0.6],
  [0.68, 0.78, 0.91],
  [0.45, 0.45, 0.45],
];

/** Largest number of different whole numbers that are shown as classes. */
const MOST_CLASSES = 48;

/** Classes of a field of whole numbers, increasing; `null` for other fields. A missing value belongs to none. */
export function classesOf(values: Float32Array): number[] | null {
  const found = new Set<number>();
  for (const x of values) {
    if (Number.isNaN(x)) continue;
    if (!Number.isInteger(x)) return null;
    found.add(x);
    if (found.size > MOST_CLASSES) return null;
  }
  return found.size > 1 ? [...found].sort((a, b) => a - b) : null;
}

/** Color at t in [0, 1], each component in [0, 255]. */
export function colorAt(map: MapName, t: number): Rgb {
  const s = Math.min(1, Math.max(0, t));
  let rgb: Rgb;
  if (map === 'viridis') {
    rgb = [0, 1, 2].map((c) => VIRIDIS.reduceRight((sum, k) => sum * s + k[c]!, 0)) as Rgb;
  } else if (map === 'classes') {
    rgb = CLASSES[Math.round(255 * s) % CLASSES.length]!;
  } else if (map === 'gray') {
    rgb = [0.15 + 0.8 * s, 0.15 + 0.8 * s, 0.15 + 0.8 * s];
  } else {
    const x = s * (DIVERGING.length - 1);
    const k = Math.min(DIVERGING.length - 2, Math.floor(x));
    rgb = [0, 1, 2].map((c) => DIVERGING[k]![c]! * (1 - (x - k)) + DIVERGING[k + 1]![c]! * (x - k)) as Rgb;
  }
  return rgb.map((x) => Math.round(255 * Math.min(1, Math.max(0, x)))) as Rgb;
}

/** Table of 256 RGBA colors. */
export function colorTable(map: MapName): Uint8Array<ArrayBuffer> {
  const out = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) out.set([...colorAt(map, i / 255), 255], 4 * i);
  return out;
}

export type RangeRule = 'most' | 'all' | { low: number; high: number };

/** The displacements of vertices that moved: those of an edit elsewhere would make most of a local one a single color. */
export function movedOnly(values: Float32Array): Float32Array {
  let most = 0;
  for (const x of values) if (x > most) most = x;
  return most > 0 ? values.filter((x) => x > 1e-3 * most) : values;
}

/** Numbers of values in equal parts of a range; those beyond an end are counted in the last part. */
export function histogram(values: Float32Array, [low, high]: [number, number], nBins: number): number[] {
  const counts = new Array<number>(nBins).fill(0);
  const perUnit = nBins / (high - low);
  // An even sample is enough for large fields.
  const step = Math.max(1, Math.floor(values.length / 200_000));
  for (let v = 0; v < values.length; v += step) {
    const x = values[v]!;
    if (!Number.isFinite(x)) continue;
    const bin = Math.floor((x - low) * perUnit);
    counts[Math.min(nBins - 1, Math.max(0, bin))]!++;
  }
  return counts;
}

/** True if a field has a number at any vertex. */
export function hasValues(values: Float32Array): boolean {
  return values.some((x) => Number.isFinite(x));
}

/** Displayed range of a field. `most` spans the 2nd to the 98th percentile; a diverging field is symmetric about 0. */
export function rangeOf(values: Float32Array, rule: RangeRule, diverging: boolean): [number, number] {
  if (typeof rule === 'object') return [rule.low, rule.high];
  // An even sample is enough for large fields.
  const step = Math.max(1, Math.floor(values.length / 20_000));
  const sample: number[] = [];
  for (let v = 0; v < values.length; v += step) if (Number.isFinite(values[v]!)) sample.push(values[v]!);
  if (sample.length === 0) return [0, 1];
  sample.sort((a, b) => a - b);
  let low = sample[0]!;
  let high = sample.at(-1)!;
  if (rule === 'most') {
    low = sample[Math.floor(0.02 * (sample.length - 1))]!;
    high = sample[Math.ceil(0.98 * (sample.length - 1))]!;
  } else {
    for (const x of values) {
      if (x < low) low = x;
      if (x > high) high = x;
    }
  }
  if (diverging) {
    const most = Math.max(Math.abs(low), Math.abs(high)) || 1;
    return [-most, most];
  }
  if (low >= 0 && low < 0.2 * high) low = 0;
  return high > low ? [low, high] : [low, low + (Math.abs(low) || 1)];
}
