/** Values of a field after an edit: f′ = f + Σ_j (Γ_j(x) − 1) W_j(x), with the Γ_j of positions. */

import { globalGains, type LayerTerm, maskedTerms } from './positions';

/** A field that is edited: its values and its bands, fine to coarse. A vertex without a value has NaN. */
export interface EditableField {
  values: Float32Array;
  bands: Float32Array[];
}

/** Splits values and bands of `n` numbers each, one after the other. */
export function splitField(all: Float32Array, n: number): EditableField {
  const part = (k: number) => all.subarray(k * n, (k + 1) * n);
  return {
    values: part(0),
    bands: Array.from({ length: Math.max(0, all.length / n - 1) }, (_, j) => part(j + 1)),
  };
}

export function editedField({ values, bands }: EditableField, layers: readonly LayerTerm[]): Float32Array {
  const out = values.slice();
  const gains = globalGains(layers, bands.length);
  const masked = maskedTerms(layers);
  for (const [j, band] of bands.entries()) {
    const terms = masked
      .map((l) => ({ mask: l.mask!, slope: (l.opacity * ((l.gains[j] ?? 1) - 1)) / 255 }))
      .filter((t) => t.slope !== 0);
    const global = gains[j]!;
    if (terms.length === 0) {
      const c = global - 1;
      if (c !== 0) for (let v = 0; v < out.length; v++) out[v]! += c * band[v]!;
      continue;
    }
    for (let v = 0; v < out.length; v++) {
      let gain = global;
      for (const t of terms) gain *= 1 + t.slope * t.mask[v]!;
      if (gain !== 1) out[v]! += (gain - 1) * band[v]!;
    }
  }
  return out;
}

/** Largest and root mean square change of the vertices with a value. */
export function fieldChange(before: Float32Array, after: Float32Array): { greatest: number; rms: number } {
  let greatest = 0;
  let sum = 0;
  let n = 0;
  for (let v = 0; v < before.length; v++) {
    const d = Math.abs(after[v]! - before[v]!);
    if (Number.isNaN(d)) continue;
    n++;
    sum += d * d;
    if (d > greatest) greatest = d;
  }
  return { greatest, rms: n > 0 ? Math.sqrt(sum / n) : 0 };
}
