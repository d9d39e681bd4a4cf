/** Regions made of the one that is there: grown, shrunk, blurred. */

import { lengthOf } from './lengths';
import type { Region } from './protocol';

export type Change = 'grow' | 'shrink' | 'blur';

/**
 * The region after a change by a length, in model units. The same change twice is one by more: lengths of growing add up, of blurs
 * their squares.
 */
export function reshaped(region: Region, change: Change, by: number, diagonal: number): Region {
  const length = (l: number | string) => lengthOf(l, diagonal);
  switch (change) {
    case 'grow':
      if ('grown' in region) {
        return { grown: { by: length(region.grown.by) + by, region: region.grown.region } };
      }
      return { grown: { by, region } };
    case 'shrink': {
      const outside = 'not' in region ? region.not : { not: region };
      return { not: reshaped(outside, 'grow', by, diagonal) };
    }
    case 'blur':
      if ('blurred' in region) {
        return { blurred: { by: Math.hypot(length(region.blurred.by), by), region: region.blurred.region } };
      }
      return { blurred: { by, region } };
  }
}
