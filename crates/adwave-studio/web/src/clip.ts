/** A plane that cuts the shape in the picture, and what is picked. */

export interface Clip {
  axis: 0 | 1 | 2;
  /** Position between the ends of the bounding box along the axis, in [0, 1]. */
  at: number;
  /** Cuts away the side of smaller coordinates instead of that of larger ones. */
  flipped: boolean;
}

/** Plane a x + b y + c z + d = 0 of unit normal, positive where the shape is cut away. */
export type ClipEquation = readonly [number, number, number, number];

/** Equation of a plane that cuts nothing away. */
export const WHOLE: ClipEquation = [0, 0, 0, -1];

export function clipEquation(
  { axis, at, flipped }: Clip,
  { low, high }: { low: readonly number[]; high: readonly number[] },
): ClipEquation {
  const sign = flipped ? -1 : 1;
  const place = low[axis]! + at * (high[axis]! - low[axis]!);
  const normal = [0, 0, 0].with(axis, sign) as [number, number, number];
  return [...normal, -sign * place];
}

export function isClipped([a, b, c, d]: ClipEquation, p: ArrayLike<number>, i = 0): boolean {
  return a * p[i]! + b * p[i + 1]! + c * p[i + 2]! + d > 0;
}

/** A clip from storage; `null` if it is none. */
export function parseClip(value: unknown): Clip | null {
  const clip = value as Clip | null;
  const isClip =
    typeof clip === 'object' &&
    clip !== null &&
    [0, 1, 2].includes(clip.axis) &&
    clip.at >= 0 &&
    clip.at <= 1 &&
    typeof clip.flipped === 'boolean';
  return isClip ? { axis: clip.axis, at: clip.at, flipped: clip.flipped } : null;
}
