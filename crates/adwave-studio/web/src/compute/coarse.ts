/**
 * Coarse triangles over the same vertices, drawn during motion: all vertices in a cube are replaced by the first of them.
 * Edits apply unchanged, because no new vertices are created.
 */
export function coarseTriangles(
  positions: Float32Array,
  triangles: Uint32Array,
  target: number,
): Uint32Array {
  const n = positions.length / 3;
  const { area, low } = extent(positions, triangles);
  // A surface of area A meets about 1.7 A / h² cubes of side h, with two triangles per vertex.
  const h = Math.sqrt((3.4 * area) / target) || 1;
  let bits = 1 << 16;
  while (bits < 4 * target) bits <<= 1;
  const keys = new Int32Array(bits).fill(-1);
  const firsts = new Uint32Array(bits);
  const first = new Uint32Array(n);
  for (let v = 0; v < n; v++) {
    const x = Math.floor((positions[3 * v]! - low[0]!) / h) & 1023;
    const y = Math.floor((positions[3 * v + 1]! - low[1]!) / h) & 1023;
    const z = Math.floor((positions[3 * v + 2]! - low[2]!) / h) & 1023;
    const key = (z << 20) | (y << 10) | x;
    let slot = (Math.imul(key, 0x9e3779b1) >>> 8) & (bits - 1);
    // If the table is full (many loose points), the vertex is kept.
    let tries = 0;
    while (keys[slot] !== -1 && keys[slot] !== key && tries < 64) {
      slot = (slot + 1) & (bits - 1);
      tries++;
    }
    if (keys[slot] === key) first[v] = firsts[slot]!;
    else {
      first[v] = v;
      if (keys[slot] === -1) {
        keys[slot] = key;
        firsts[slot] = v;
      }
    }
  }
  const out = new Uint32Array(triangles.length);
  let size = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = first[triangles[t]!]!;
    const b = first[triangles[t + 1]!]!;
    const c = first[triangles[t + 2]!]!;
    if (a === b || b === c || c === a) continue;
    out[size++] = a;
    out[size++] = b;
    out[size++] = c;
  }
  return out.slice(0, size);
}

function extent(p: Float32Array, triangles: Uint32Array): { area: number; low: number[] } {
  const low = [Infinity, Infinity, Infinity];
  for (let i = 0; i < p.length; i++) if (p[i]! < low[i % 3]!) low[i % 3] = p[i]!;
  let twice = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t]!;
    const b = 3 * triangles[t + 1]!;
    const c = 3 * triangles[t + 2]!;
    const ux = p[b]! - p[a]!;
    const uy = p[b + 1]! - p[a + 1]!;
    const uz = p[b + 2]! - p[a + 2]!;
    const vx = p[c]! - p[a]!;
    const vy = p[c + 1]! - p[a + 1]!;
    const vz = p[c + 2]! - p[a + 2]!;
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    twice += Math.sqrt(x * x + y * y + z * z);
  }
  return { area: twice / 2, low };
}

/** Lists every edge once, as pairs of vertices. */
export function edgePairs(offsets: Uint32Array, entries: Uint32Array): Uint32Array {
  const out = new Uint32Array(entries.length);
  let size = 0;
  for (let v = 0; v + 1 < offsets.length; v++) {
    for (let e = offsets[v]!; e < offsets[v + 1]!; e++) {
      if (entries[e]! > v) {
        out[size++] = v;
        out[size++] = entries[e]!;
      }
    }
  }
  return out.slice(0, size);
}
