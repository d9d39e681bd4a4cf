/** Turns of vectors by the quaternions of a pose. */

/**
 * Turns vector `from` of a list of three numbers each by quaternion k, or back if `sign` is −1, and returns it as `out`.
 * Quaternions x, y, z, w are signed integers, of which 32767 is 1; without any the vector stays as it is.
 */
export function turn(
  turns: ArrayLike<number> | null,
  k: number,
  sign: 1 | -1,
  list: ArrayLike<number>,
  from: number,
  out: number[],
): number[] {
  const [x, y, z] = [list[from]!, list[from + 1]!, list[from + 2]!];
  out[0] = x;
  out[1] = y;
  out[2] = z;
  if (!turns) return out;
  const s = sign / 32767;
  const [a, b, c] = [turns[4 * k]! * s, turns[4 * k + 1]! * s, turns[4 * k + 2]! * s];
  const w = turns[4 * k + 3]! / 32767;
  // As in the shader: v + 2 a × (a × v + w v).
  const p = b * z - c * y + w * x;
  const q = c * x - a * z + w * y;
  const r = a * y - b * x + w * z;
  out[0] = x + 2 * (b * r - c * q);
  out[1] = y + 2 * (c * p - a * r);
  out[2] = z + 2 * (a * q - b * p);
  return out;
}
