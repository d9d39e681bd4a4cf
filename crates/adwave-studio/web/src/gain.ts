/** Scale of a gain slider: positions 0 … 200 with gain 0 at the bottom, 1 in the middle and 4 at the top. */

export const SLIDER_MAX = 200;
export const GREATEST_GAIN = 4;
/** Largest gain that can be typed; the server accepts any gain. */
export const GREATEST_TYPED = 100;

/** Gain of a slider position: linear below the middle, exponential above. */
export function gainOf(position: number): number {
  const s = Math.min(SLIDER_MAX, Math.max(0, position)) / 100;
  const gain = s <= 1 ? s : GREATEST_GAIN ** (s - 1);
  return Math.round(gain * 1000) / 1000;
}

export function positionOf(gain: number): number {
  if (!(gain > 0)) return 0;
  const s = gain <= 1 ? gain : 1 + Math.log(gain) / Math.log(GREATEST_GAIN);
  return Math.min(SLIDER_MAX, Math.round(100 * s));
}

export function gainText(gain: number): string {
  return gain.toFixed(gain >= 10 ? 1 : 2);
}
