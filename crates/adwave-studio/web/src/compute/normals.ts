/** Vertex normals as four signed bytes each, of which the last is 0. */

/** Sums the area-weighted normals of the triangles of each vertex in `sums` (3 n) and packs them into `out` (4 n). */
export function meshNormals(
  positions: Float32Array,
  triangles: Uint32Array,
  sums: Float32Array,
  out: Int8Array,
): void {
  sums.fill(0);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t]!;
    const b = 3 * triangles[t + 1]!;
    const c = 3 * triangles[t + 2]!;
    const ax = positions[a]!;
    const ay = positions[a + 1]!;
    const az = positions[a + 2]!;
    const ux = positions[b]! - ax;
    const uy = positions[b + 1]! - ay;
    const uz = positions[b + 2]! - az;
    const vx = positions[c]! - ax;
    const vy = positions[c + 1]! - ay;
    const vz = positions[c + 2]! - az;
    const nx = uy * vz - uz * vy;
    const ny = uz * vx - ux * vz;
    const nz = ux * vy - uy * vx;
    sums[a]! += nx;
    sums[a + 1]! += ny;
    sums[a + 2]! += nz;
    sums[b]! += nx;
    sums[b + 1]! += ny;
    sums[b + 2]! += nz;
    sums[c]! += nx;
    sums[c + 1]! += ny;
    sums[c + 2]! += nz;
  }
  pack(sums, out);
}

function pack(sums: Float32Array, out: Int8Array): void {
  for (let i = 0, k = 0; i < sums.length; i += 3, k += 4) {
    const x = sums[i]!;
    const y = sums[i + 1]!;
    const z = sums[i + 2]!;
    const length = Math.sqrt(x * x + y * y + z * z);
    const s = length > 0 ? 127 / length : 0;
    out[k] = x * s;
    out[k + 1] = y * s;
    out[k + 2] = z * s;
  }
}

/**
 * Computes the normals of a cloud: the eigenvector of the smallest eigenvalue of the covariance of the neighbors. Their
 * sign is arbitrary; the shader turns them to the viewer.
 */
export function cloudNormals(
  positions: Float32Array,
  offsets: Uint32Array,
  neighbors: Uint32Array,
  out: Int8Array,
): void {
  const n = positions.length / 3;
  for (let v = 0; v < n; v++) {
    const from = offsets[v]!;
    const to = offsets[v + 1]!;
    let xx = 0;
    let xy = 0;
    let xz = 0;
    let yy = 0;
    let yz = 0;
    let zz = 0;
    const px = positions[3 * v]!;
    const py = positions[3 * v + 1]!;
    const pz = positions[3 * v + 2]!;
    let mx = 0;
    let my = 0;
    let mz = 0;
    for (let e = from; e < to; e++) {
      const q = 3 * neighbors[e]!;
      const x = positions[q]! - px;
      const y = positions[q + 1]! - py;
      const z = positions[q + 2]! - pz;
      mx += x;
      my += y;
      mz += z;
      xx += x * x;
      xy += x * y;
      xz += x * z;
      yy += y * y;
      yz += y * z;
      zz += z * z;
    }
    const k = to - from + 1;
    xx -= (mx * mx) / k;
    xy -= (mx * my) / k;
    xz -= (mx * mz) / k;
    yy -= (my * my) / k;
    yz -= (my * mz) / k;
    zz -= (mz * mz) / k;
    // Powers of (trace − C) make the direction of least spread the dominant one.
    const trace = xx + yy + zz;
    if (trace <= 0) continue;
    let a = [trace - xx, -xy, -xz, trace - yy, -yz, trace - zz] as [
      number,
      number,
      number,
      number,
      number,
      number,
    ];
    for (let round = 0; round < 5; round++) {
      const [p, q, r, s, t, u] = a;
      const scale = 1 / (p + s + u);
      const f = scale * scale;
      a = [
        (p * p + q * q + r * r) * f,
        (p * q + q * s + r * t) * f,
        (p * r + q * t + r * u) * f,
        (q * q + s * s + t * t) * f,
        (q * r + s * t + t * u) * f,
        (r * r + t * t + u * u) * f,
      ];
    }
    const [p, q, r, s, t, u] = a;
    // The longest column of a matrix of almost rank 1 is its direction.
    let x = p;
    let y = q;
    let z = r;
    if (s > p && s >= u) {
      x = q;
      y = s;
      z = t;
    } else if (u > p && u > s) {
      x = r;
      y = t;
      z = u;
    }
    const length = Math.hypot(x, y, z);
    const scale = length > 0 ? 127 / length : 0;
    out[4 * v] = x * scale;
    out[4 * v + 1] = y * scale;
    out[4 * v + 2] = z * scale;
  }
}
