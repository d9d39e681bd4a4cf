/** Turns of vectors by the quaternions of a pose. */

/** Turns of the frames of vertices: quaternions x, y, z, w of signed integers, of which 32767 is 1. */
export type Turns = ArrayLike<number>;

/** Vector (x, y, z) turned by quaternion k, or turned back if `sign` is −1; without turns it stays as it is. */
export function turned(turns: Turns | null, k: number, sign: 1 | -1, v: readonly number[]): number[] {
  const [x, y, z] = v as [number, number, number];
  if (!turns) return [x, y, z];
  const s = sign / 32767;
  const [a, b, c] = [turns[4 * k]! * s, turns[4 * k + 1]! * s, turns[4 * k + 2]! * s];
  const w = turns[4 * k + 3]! / 32767;
  // As in the shader: v + 2 a × (a × v + w v).
  const p = b * z - c * y + w * x;
  const q = c * x - a * z + w * y;
  const r = a * y - b * x + w * z;
  return [x + 2 * (b * r - c * q), y + 2 * (c * p - a * r), z + 2 * (a * q - b * p)];
}
