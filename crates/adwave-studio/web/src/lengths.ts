/** Lengths in model units, and the formatting of numbers. */

import type { Length } from './protocol';

/** Converts a length to model units; `"2%"` is relative to the diagonal. */
export function toModelUnits(length: Length, diagonal: number): number {
  if (typeof length === 'number') return length;
  const text = length.trim();
  return text.endsWith('%') ? (Number(text.slice(0, -1)) / 100) * diagonal : Number(text);
}

/** Formats a number with three significant digits. */
export function formatNumber(x: number, digits = 3): string {
  if (!Number.isFinite(x)) return '–';
  if (x === 0) return '0';
  const size = Math.abs(x);
  if (size >= 1e5 || size < 1e-4)
    return x
      .toExponential(Math.max(0, digits - 1))
      .replace('e+', 'e')
      .replace('-', '−');
  const text = Number(x.toPrecision(digits)).toString();
  return text.replace('-', '−');
}

/** Formats a count with thin spaces between thousands. */
export function formatCount(n: number): string {
  return Math.round(n)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, '\u202f');
}
