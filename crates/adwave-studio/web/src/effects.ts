/** Effects of the brush: each paints a layer of its own, whose gains follow from the size of the brush. */

import { GREATEST_GAIN } from './gain';
import type { DocLayer } from './state';
import { text } from './text';

export type Effect = 'smooth' | 'enhance' | 'flatten' | 'match' | 'clone' | 'region';

/** Effects with gains that depend on the brush only. */
type SizedEffect = 'smooth' | 'enhance' | 'flatten';

/** Gain of the finest band of an enhancement, which is mostly noise. */
const FINEST_ENHANCED = 1.25;
const ENHANCED = 2.5;

/** Rises from 0 at the width `from` to 1 at `to`, linearly in octaves. */
function ramp(sigma: number, from: number, to: number): number {
  return Math.min(1, Math.max(0, Math.log2(sigma / from) / Math.log2(to / from)));
}

/** Gain of an effect for a band of width σ, with a brush of radius r. */
const GAINS: Record<SizedEffect, (sigma: number, r: number) => number> = {
  // Detail up to a quarter of the brush goes, that of its size stays.
  smooth: (sigma, r) => ramp(sigma, r / 4, r),
  enhance: (sigma, r) => 1 + (ENHANCED - 1) * (1 - ramp(sigma, r / 3, r)),
  // What is wider than the brush remains.
  flatten: (sigma, r) => ramp(sigma, 2 * r, 4 * r),
};

/** Gains of an effect for bands of widths σ, with a brush of this radius in the same units. */
export function effectGains(effect: SizedEffect, sigmas: readonly number[], radius: number): number[] {
  const gains = sigmas.map((sigma) => GAINS[effect](sigma, radius));
  // A brush finer than the bands still acts.
  if (gains.length > 0 && effect === 'enhance') gains[0] = gains.length > 1 ? FINEST_ENHANCED : ENHANCED;
  if (gains.length > 0 && effect !== 'enhance') gains[0] = 0;
  if (gains.length > 2 && effect === 'enhance') gains[1] = Math.max(gains[1]!, ENHANCED);
  return gains.map((gain) => Math.round(1000 * gain) / 1000);
}

/** Gains that give bands of root mean square `there` the sizes `wanted`. */
export function matchingGains(wanted: readonly number[], there: readonly number[]): number[] {
  return wanted.map((size, j) => {
    const gain = there[j]! > 0 ? size / there[j]! : 1;
    return Math.round(1000 * Math.min(GREATEST_GAIN, gain)) / 1000;
  });
}

/** The effect that a layer was painted with; `null` for other layers and renamed ones. */
export function effectOf(layer: DocLayer): Exclude<Effect, 'region' | 'clone'> | null {
  const { region } = layer;
  if (!region || !('painted' in region)) return null;
  const effects = ['smooth', 'enhance', 'flatten', 'match'] as const;
  return effects.find((effect) => layer.name === text.effects[effect]) ?? null;
}
