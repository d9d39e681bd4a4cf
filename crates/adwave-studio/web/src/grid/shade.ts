/** Colors of the values of a plane: gray or a color map over a window, channels as colors, or the shading of a relief. */

import { colorTable } from '../colors';

/** `color` shows channels as red, green and blue. */
export type ShadeMode = 'gray' | 'map' | 'relief' | 'color';

export interface Shading {
  mode: ShadeMode;
  /** Values shown in black and in white, or in the first and the last color. */
  window: readonly [number, number];
  /** Distances of rows and columns of the plane in the unit of the values, for a relief. */
  spacings: readonly [number, number];
  /** Factor of the heights of a relief. */
  height: number;
  /** True if the last channel is the opacity, of which `full` is opaque. */
  opacity: { full: number } | null;
}

/** Values of a plane by rows. */
export interface ShadedValues {
  values: Float32Array;
  rows: number;
  columns: number;
  nChannels: number;
}

const VIRIDIS = new Uint32Array(colorTable('viridis').buffer);

/** Gray 0 … 255 as an opaque pixel. */
const GRAYS = Uint32Array.from({ length: 256 }, (_, k) => (0xff000000 | (k << 16) | (k << 8) | k) >>> 0);

/** Writes the colors of values as RGBA; a place without data is transparent. */
export function shade(shown: ShadedValues, shading: Shading, rgba: Uint8ClampedArray): void {
  const pixels = new Uint32Array(rgba.buffer, rgba.byteOffset, rgba.byteLength / 4);
  if (shading.mode === 'relief') shadeRelief(shown, shading, pixels);
  else if (shading.mode === 'color' && shown.nChannels >= 3) shadeColors(shown, shading, pixels);
  else shadeFirst(shown, shading, pixels);
}

function shadeFirst(
  { values, nChannels }: ShadedValues,
  { window, mode }: Shading,
  pixels: Uint32Array,
): void {
  const table = mode === 'map' ? VIRIDIS : GRAYS;
  const [low, high] = window;
  const perUnit = 255 / (high - low);
  for (let i = 0; i < pixels.length; i++) {
    const x = values[i * nChannels]!;
    const t = (x - low) * perUnit + 0.5;
    // NaN is neither below nor above.
    pixels[i] = t >= 255 ? table[255]! : t <= 0 ? table[0]! : t > 0 ? table[t | 0]! : 0;
  }
}

function shadeColors(
  { values, nChannels }: ShadedValues,
  { window: [low, high], opacity }: Shading,
  pixels: Uint32Array,
): void {
  const perUnit = 255 / (high - low);
  const byte = (t: number) => (t >= 255 ? 255 : t > 0 ? (t + 0.5) | 0 : 0);
  for (let i = 0, k = 0; i < pixels.length; i++, k += nChannels) {
    const red = values[k]!;
    if (Number.isNaN(red)) {
      pixels[i] = 0;
      continue;
    }
    const alpha = opacity ? byte((255 * values[k + nChannels - 1]!) / opacity.full) : 255;
    const green = values[k + 1]!;
    const blue = values[k + 2]!;
    pixels[i] =
      ((alpha << 24) |
        (byte((blue - low) * perUnit) << 16) |
        (byte((green - low) * perUnit) << 8) |
        byte((red - low) * perUnit)) >>>
      0;
  }
}

/** Brightness of a relief that is lit from the upper left at 45°, by Horn's differences. */
function shadeRelief(
  { values, rows, columns, nChannels }: ShadedValues,
  shading: Shading,
  pixels: Uint32Array,
): void {
  const { spacings, height } = shading;
  const [perRow, perColumn] = [height / (8 * spacings[0]), height / (8 * spacings[1])];
  const light = Math.SQRT1_2;
  const at = (r: number, c: number, centre: number) => {
    const x = values[(r * columns + c) * nChannels]!;
    return Number.isNaN(x) ? centre : x;
  };
  for (let r = 0; r < rows; r++) {
    const [up, down] = [Math.max(0, r - 1), Math.min(rows - 1, r + 1)];
    for (let c = 0; c < columns; c++) {
      const i = r * columns + c;
      const z = values[i * nChannels]!;
      if (Number.isNaN(z)) {
        pixels[i] = 0;
        continue;
      }
      const [left, right] = [Math.max(0, c - 1), Math.min(columns - 1, c + 1)];
      const [a, b, d] = [at(up, left, z), at(up, c, z), at(up, right, z)];
      const [e, f] = [at(r, left, z), at(r, right, z)];
      const [g, k, m] = [at(down, left, z), at(down, c, z), at(down, right, z)];
      const slopeX = (d + 2 * f + m - a - 2 * e - g) * perColumn;
      const slopeY = (g + 2 * k + m - a - 2 * b - d) * perRow;
      // The light comes from (−½, −½, 1/√2): left, up and above.
      const lit = (0.5 * (slopeX + slopeY) + light) / Math.sqrt(1 + slopeX * slopeX + slopeY * slopeY);
      pixels[i] = GRAYS[lit <= 0 ? 0 : Math.min(255, (255 * lit + 0.5) | 0)]!;
    }
  }
}

/** Factor of heights for which the root mean square slope of a relief is about 0.4. */
export function usualHeight(
  { values, rows, columns, nChannels }: ShadedValues,
  spacings: readonly [number, number],
): number {
  const step = Math.max(1, Math.floor(Math.sqrt((rows * columns) / 40_000)));
  let sum = 0;
  let n = 0;
  for (let r = 0; r + 1 < rows; r += step) {
    for (let c = 0; c + 1 < columns; c += step) {
      const i = (r * columns + c) * nChannels;
      const slopeX = (values[i + nChannels]! - values[i]!) / spacings[1];
      const slopeY = (values[i + columns * nChannels]! - values[i]!) / spacings[0];
      const square = slopeX * slopeX + slopeY * slopeY;
      if (Number.isNaN(square)) continue;
      sum += square;
      n++;
    }
  }
  return sum > 0 ? 0.4 / Math.sqrt(sum / n) : 1;
}
