/** Colors of the values of a plane: gray or a color map over a window, channels as colors, or the shading of a relief. */

import { colorTable } from '../colors';

/** `color` shows channels as red, green and blue. */
const SHADE_MODES = ['gray', 'map', 'relief', 'color'] as const;
export type ShadeMode = (typeof SHADE_MODES)[number];

export function isShadeMode(name: unknown): name is ShadeMode {
  return SHADE_MODES.some((mode) => mode === name);
}

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
  { spacings, height }: Shading,
  pixels: Uint32Array,
): void {
  const [perRow, perColumn] = [height / (8 * spacings[0]), height / (8 * spacings[1])];
  // A neighbor without data is as high as the place itself.
  const known = (x: number, z: number) => (Number.isNaN(x) ? z : x);
  for (let r = 0; r < rows; r++) {
    const row = r * columns;
    const up = Math.max(0, r - 1) * columns;
    const down = Math.min(rows - 1, r + 1) * columns;
    for (let c = 0; c < columns; c++) {
      const z = values[(row + c) * nChannels]!;
      if (Number.isNaN(z)) {
        pixels[row + c] = 0;
        continue;
      }
      const left = c > 0 ? c - 1 : 0;
      const right = c + 1 < columns ? c + 1 : c;
      let upLeft = values[(up + left) * nChannels]!;
      let above = values[(up + c) * nChannels]!;
      let upRight = values[(up + right) * nChannels]!;
      let before = values[(row + left) * nChannels]!;
      let after = values[(row + right) * nChannels]!;
      let downLeft = values[(down + left) * nChannels]!;
      let below = values[(down + c) * nChannels]!;
      let downRight = values[(down + right) * nChannels]!;
      if (Number.isNaN(upLeft + above + upRight + before + after + downLeft + below + downRight)) {
        [upLeft, above, upRight] = [known(upLeft, z), known(above, z), known(upRight, z)];
        [before, after] = [known(before, z), known(after, z)];
        [downLeft, below, downRight] = [known(downLeft, z), known(below, z), known(downRight, z)];
      }
      const slopeX = (upRight + 2 * after + downRight - upLeft - 2 * before - downLeft) * perColumn;
      const slopeY = (downLeft + 2 * below + downRight - upLeft - 2 * above - upRight) * perRow;
      // The light comes from (−½, −½, 1/√2): left, up and above.
      const lit = (0.5 * (slopeX + slopeY) + Math.SQRT1_2) / Math.sqrt(1 + slopeX * slopeX + slopeY * slopeY);
      pixels[row + c] = GRAYS[lit <= 0 ? 0 : lit >= 1 ? 255 : (255 * lit + 0.5) | 0]!;
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
