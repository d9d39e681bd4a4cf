import type { Length } from './protocol';

/** A length in model units: a number is one already, `"2%"` is of the diagonal. */
export function lengthOf(length: Length, diagonal: number): number {
  if (typeof length === 'number') return length;
  const text = length.trim();
  return text.endsWith('%') ? (Number(text.slice(0, -1)) / 100) * diagonal : Number(text);
}

/** A number with three significant digits, as short as it gets. */
export function short(x: number, digits = 3): string {
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

/** A count with thin spaces between thousands. */
export function count(n: number): string {
  return Math.round(n)
    .toString()
    .replace(/\B(?=(\d{3})+$)/g, '\u202f');
}
