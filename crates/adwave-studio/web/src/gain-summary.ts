/** Summary of the gains of a layer: its preset, and the number of bands that were changed since. */

import type { Shape } from './protocol';
import type { DocLayer } from './state';
import { text } from './text';

/**
 * Name of the preset of a layer and the number of bands that differ from it. Without a preset it is the number of changed
 * bands, or nothing for `presets` alone; empty if there is nothing to say.
 */
export function gainSummary(
  { gains, preset: name }: Pick<DocLayer, 'gains' | 'preset'>,
  presets: Shape['presets'],
  what: 'all' | 'presets' = 'all',
): string {
  const preset = presets.find((p) => p.name === name);
  const n = gains.reduce((sum, gain, j) => sum + Number(gain !== (preset?.gains[j] ?? 1)), 0);
  // With all bands changed the preset is not there any more.
  if (preset && n < gains.length) return text.presetChanged(text.presetNames[preset.name] ?? preset.name, n);
  return what === 'all' && n > 0 ? text.bandsChanged(n) : '';
}
