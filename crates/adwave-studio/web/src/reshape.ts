/** Growing, shrinking and blurring of regions. */

import { toModelUnits } from './lengths';
import type { Region } from './protocol';

export type Change = 'grow' | 'shrink' | 'blur';

/**
 * Applies a change by a length in model units. Repeated changes are merged: lengths of growing add up, squared lengths of
 * blurs add up.
 */
export function reshapeRegion(region: Region, change: Change, by: number, diagonal: number): Region {
  const length = (l: number | string) => toModelUnits(l, diagonal);
  switch (change) {
    case 'grow':
      if ('grown' in region) {
        return { grown: { by: length(region.grown.by) + by, region: region.grown.region } };
      }
      return { grown: { by, region } };
    case 'shrink': {
      const outside = 'not' in region ? region.not : { not: region };
      return { not: reshapeRegion(outside, 'grow', by, diagonal) };
    }
    case 'blur':
      if ('blurred' in region) {
        return { blurred: { by: Math.hypot(length(region.blurred.by), by), region: region.blurred.region } };
      }
      return { blurred: { by, region } };
  }
}
