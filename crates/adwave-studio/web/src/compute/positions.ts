/** Positions of an edit: f′ = f + Σ_j (Γ_j(x) − 1) W_j(x), Γ_j(x) = Π_l (1 + opacity_l r_l(x) (g_lj − 1)). */

/** One band as received: W = scale · (x, y, z), four numbers per vertex, of which the last is 0. */
export interface Band {
  scale: number;
  values: Int16Array;
}

/** Term of a layer in the sum: `mask` is 255 r(x), or `null` for a layer without a region. */
export interface LayerTerm {
  opacity: number;
  gains: readonly number[];
  mask: Uint8Array | null;
}

/** Π_l (1 + opacity_l (g_lj − 1)) over the layers without a region, for each of `nLevels` bands. */
export function globalGains(layers: readonly LayerTerm[], nLevels: number): Float64Array {
  const gains = new Float64Array(nLevels).fill(1);
  for (const layer of layers) {
    if (layer.mask) continue;
    for (let j = 0; j < nLevels; j++) gains[j]! *= 1 + layer.opacity * ((layer.gains[j] ?? 1) - 1);
  }
  return gains;
}

/** Selects layers with a mask that change something. */
export function maskedTerms(layers: readonly LayerTerm[]): LayerTerm[] {
  return layers.filter((l) => l.mask && l.opacity !== 0 && l.gains.some((g) => g !== 1));
}

/**
 * Writes the positions after an edit into `out` (3 n). `bands[j]` is the band of level j + 1, `null` before it is loaded.
 * Bands without masks are added four per pass; each masked band has its own pass, which skips unmasked vertices.
 */
export function editedPositions(
  base: Float32Array,
  bands: readonly (Band | null)[],
  layers: readonly LayerTerm[],
  out: Float32Array,
): void {
  const nLevels = bands.length;
  const gains = globalGains(layers, nLevels);
  const masked = maskedTerms(layers);
  out.set(base);
  const n = base.length / 3;
  let plain: Term[] = [];
  for (let j = 0; j < nLevels; j++) {
    const band = bands[j];
    if (!band) continue;
    // Masked factors of band j: (mask, opacity (g − 1) / 255).
    const terms = masked
      .map((l) => ({ mask: l.mask!, slope: (l.opacity * ((l.gains[j] ?? 1) - 1)) / 255 }))
      .filter((t) => t.slope !== 0);
    const global = gains[j]!;
    if (terms.length === 0) {
      const c = (global - 1) * band.scale;
      if (c !== 0) plain.push({ c, w: band.values });
      continue;
    }
    // Bands are added in order, so that rounding is the same with and without masks.
    addBands(out, plain);
    plain = [];
    if (terms.length === 1) addBandMasked(out, band, global, terms[0]!.mask, terms[0]!.slope, n);
    else addBandManyMasks(out, band, global, terms, n);
  }
  addBands(out, plain);
}

/** A band and its factor. */
interface Term {
  c: number;
  w: Int16Array;
}

/** Adds c · w of each term, in their order, rounded to single precision after each. */
function addBands(out: Float32Array, terms: readonly Term[]): void {
  let j = 0;
  for (; j + 4 <= terms.length; j += 4) addFour(out, terms[j]!, terms[j + 1]!, terms[j + 2]!, terms[j + 3]!);
  for (; j < terms.length; j++) addOne(out, terms[j]!);
}

function addOne(out: Float32Array, { c, w }: Term): void {
  for (let i = 0, k = 0; i < out.length; i += 3, k += 4) {
    out[i]! += c * w[k]!;
    out[i + 1]! += c * w[k + 1]!;
    out[i + 2]! += c * w[k + 2]!;
  }
}

/** Adds four terms in one pass over `out`, with the rounding of four separate passes. */
function addFour(
  out: Float32Array,
  { c: c0, w: w0 }: Term,
  { c: c1, w: w1 }: Term,
  { c: c2, w: w2 }: Term,
  { c: c3, w: w3 }: Term,
): void {
  const { fround } = Math;
  for (let i = 0, k = 0; i < out.length; i += 3, k += 4) {
    const x = fround(fround(fround(out[i]! + c0 * w0[k]!) + c1 * w1[k]!) + c2 * w2[k]!);
    const y = fround(fround(fround(out[i + 1]! + c0 * w0[k + 1]!) + c1 * w1[k + 1]!) + c2 * w2[k + 1]!);
    const z = fround(fround(fround(out[i + 2]! + c0 * w0[k + 2]!) + c1 * w1[k + 2]!) + c2 * w2[k + 2]!);
    out[i] = x + c3 * w3[k]!;
    out[i + 1] = y + c3 * w3[k + 1]!;
    out[i + 2] = z + c3 * w3[k + 2]!;
  }
}

function addBandMasked(
  out: Float32Array,
  band: Band,
  global: number,
  mask: Uint8Array,
  slope: number,
  n: number,
): void {
  const { values: w, scale } = band;
  const outside = (global - 1) * scale;
  const inside = global * slope * scale;
  for (let v = 0; v < n; v++) {
    const m = mask[v]!;
    if (m === 0 && outside === 0) continue;
    const c = outside + inside * m;
    const i = 3 * v;
    const k = 4 * v;
    out[i]! += c * w[k]!;
    out[i + 1]! += c * w[k + 1]!;
    out[i + 2]! += c * w[k + 2]!;
  }
}

function addBandManyMasks(
  out: Float32Array,
  band: Band,
  global: number,
  terms: readonly { mask: Uint8Array; slope: number }[],
  n: number,
): void {
  const { values: w, scale } = band;
  for (let v = 0; v < n; v++) {
    let g = global;
    for (const t of terms) g *= 1 + t.slope * t.mask[v]!;
    const c = (g - 1) * scale;
    if (c === 0) continue;
    const i = 3 * v;
    const k = 4 * v;
    out[i]! += c * w[k]!;
    out[i + 1]! += c * w[k + 1]!;
    out[i + 2]! += c * w[k + 2]!;
  }
}

/**
 * Carries edited positions into a pose: place + R · (edited − base), with the place of each vertex at rest and the rotation R
 * of its frame as a quaternion x, y, z, w of 16-bit integers.
 */
export function carryInto(
  base: Float32Array,
  places: Float32Array,
  turns: Int16Array,
  out: Float32Array,
): void {
  const unit = 1 / 32767;
  for (let i = 0, k = 0; i < out.length; i += 3, k += 4) {
    const dx = out[i]! - base[i]!;
    const dy = out[i + 1]! - base[i + 1]!;
    const dz = out[i + 2]! - base[i + 2]!;
    const x = unit * turns[k]!;
    const y = unit * turns[k + 1]!;
    const z = unit * turns[k + 2]!;
    const w = unit * turns[k + 3]!;
    // d + 2 q × (q × d + w d)
    const ax = y * dz - z * dy + w * dx;
    const ay = z * dx - x * dz + w * dy;
    const az = x * dy - y * dx + w * dz;
    out[i] = places[i]! + dx + 2 * (y * az - z * ay);
    out[i + 1] = places[i + 1]! + dy + 2 * (z * ax - x * az);
    out[i + 2] = places[i + 2]! + dz + 2 * (x * ay - y * ax);
  }
}

/** Largest and root mean square displacement of an edit, in model units. */
export function displacement(base: Float32Array, edited: Float32Array): { greatest: number; rms: number } {
  let greatest = 0;
  let sum = 0;
  for (let i = 0; i < base.length; i += 3) {
    const x = edited[i]! - base[i]!;
    const y = edited[i + 1]! - base[i + 1]!;
    const z = edited[i + 2]! - base[i + 2]!;
    const d = x * x + y * y + z * z;
    sum += d;
    if (d > greatest) greatest = d;
  }
  const n = Math.max(1, base.length / 3);
  return { greatest: Math.sqrt(greatest), rms: Math.sqrt(sum / n) };
}

/** Volume enclosed by a closed mesh: Σ det(a, b, c) / 6 over its triangles. */
export function volume(positions: Float32Array, triangles: Uint32Array): number {
  let six = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t]!;
    const b = 3 * triangles[t + 1]!;
    const c = 3 * triangles[t + 2]!;
    const bx = positions[b]!;
    const by = positions[b + 1]!;
    const bz = positions[b + 2]!;
    const cx = positions[c]!;
    const cy = positions[c + 1]!;
    const cz = positions[c + 2]!;
    six +=
      positions[a]! * (by * cz - bz * cy) +
      positions[a + 1]! * (bz * cx - bx * cz) +
      positions[a + 2]! * (bx * cy - by * cx);
  }
  return six / 6;
}
