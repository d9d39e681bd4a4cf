/** Geometry of the handles of regions: boxes and planes. */

import type { Region } from './protocol';

type RegionOf<K extends string> = Extract<Region, Record<K, unknown>>;
export type BoxRegion = RegionOf<'box'>['box'];
export type HalfSpaceRegion = RegionOf<'half-space'>['half-space'];

/** Cosine of the angle to an axis below which a direction becomes the axis: 4°. */
const SNAP = Math.cos((4 * Math.PI) / 180);

export function dot(a: readonly number[], b: readonly number[]): number {
  return a.reduce((sum, x, c) => sum + x * b[c]!, 0);
}

/** a + k b. */
export function addScaled(a: readonly number[], b: readonly number[], k: number): number[] {
  return a.map((x, c) => x + k * b[c]!);
}

export function normalized(v: readonly number[]): number[] {
  const length = Math.hypot(...v) || 1;
  return v.map((x) => x / length);
}

function cross(a: readonly number[], b: readonly number[]): number[] {
  return [a[1]! * b[2]! - a[2]! * b[1]!, a[2]! * b[0]! - a[0]! * b[2]!, a[0]! * b[1]! - a[1]! * b[0]!];
}

/** The axis that a direction of length 1 nearly has, otherwise the direction. */
export function snapToAxis(direction: readonly number[]): number[] {
  const c = direction.findIndex((x) => Math.abs(x) > SNAP);
  return c < 0 ? [...direction] : [0, 0, 0].with(c, Math.sign(direction[c]!));
}

/** The box with one face moved along its axis, up to the opposite face. */
export function resizedBox(box: BoxRegion, end: 'min' | 'max', axis: number, by: number): BoxRegion {
  const moved = box[end][axis]! + by;
  const limit = box[end === 'min' ? 'max' : 'min'][axis]!;
  const value = end === 'min' ? Math.min(moved, limit) : Math.max(moved, limit);
  return { ...box, [end]: box[end].with(axis, value) };
}

export function movedBox(box: BoxRegion, by: readonly number[]): BoxRegion {
  return { ...box, min: addScaled(box.min, by, 1), max: addScaled(box.max, by, 1) };
}

/** The twelve edges of a box, as four lines. */
export function boxEdges(low: readonly number[], high: readonly number[]): number[][][] {
  const corner = (x: number, y: number, z: number) => [x, y, z].map((end, c) => (end ? high[c]! : low[c]!));
  const ring = (z: number) => [
    corner(0, 0, z),
    corner(1, 0, z),
    corner(1, 1, z),
    corner(0, 1, z),
    corner(0, 0, z),
  ];
  const posts = [0, 1].flatMap((x) => [0, 1].map((y) => [corner(x, y, 0), corner(x, y, 1)]));
  return [ring(0), ring(1), ...posts];
}

/** Square in the plane through a place, closed. */
export function planeQuad(place: readonly number[], normal: readonly number[], half: number): number[][] {
  const least = normal.reduce((best, x, c) => (Math.abs(x) < Math.abs(normal[best]!) ? c : best), 0);
  const u = normalized(cross(normal, [0, 0, 0].with(least, 1)));
  const v = cross(normal, u);
  const corner = (a: number, b: number) => addScaled(addScaled(place, u, a * half), v, b * half);
  return [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1), corner(-1, -1)];
}
