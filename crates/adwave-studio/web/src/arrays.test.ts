import { describe, expect, test } from 'vitest';
import { ShapeArrays } from './arrays';

/** Vertices along a side of a square, so many that the shape is not recomputed while it moves. */
const SIDE = 200;

/** Positions of a square and their copy turned by 90° about z. */
function square(height: (k: number) => number): { rest: Float32Array; turned: Float32Array } {
  const rest = new Float32Array(3 * SIDE * SIDE);
  const turned = new Float32Array(rest.length);
  for (let k = 0; k < SIDE * SIDE; k++) {
    const [x, y, z] = [k % SIDE, Math.floor(k / SIDE), height(k)];
    rest.set([x, y, z], 3 * k);
    turned.set([-y, x, z], 3 * k);
  }
  return { rest, turned };
}

function triangles(): Uint32Array {
  const list: number[] = [];
  for (let k = 0; k + SIDE + 1 < SIDE * SIDE; k++) {
    if (k % SIDE === SIDE - 1) continue;
    list.push(k, k + 1, k + SIDE + 1, k, k + SIDE + 1, k + SIDE);
  }
  return Uint32Array.from(list);
}

describe('the shape that is pulled', () => {
  const n = SIDE * SIDE;
  const { rest, turned } = square(() => 0);
  const edited = Float32Array.from(rest, (c, i) => c + [0.25, 0, (i % 7) / 8][i % 3]!);
  const normals = new Int8Array(4 * n);
  for (let k = 0; k < n; k++) normals.set([127, 0, 0, 0], 4 * k);
  const arrays = new ShapeArrays(true, () => {});
  arrays.setShape(rest, triangles(), false);
  arrays.setNormals(normals);
  arrays.setEdited(edited, normals);
  const turns = new Int16Array(4 * n);
  for (let k = 0; k < n; k++)
    turns.set([0, 0, Math.round(32767 * Math.SQRT1_2), Math.round(32767 * Math.SQRT1_2)], 4 * k);

  test('is unknown before a pull, and for other vertices', () => {
    expect(arrays.showPulled({ places: turned, turns })).toBe(false);
    arrays.startPull();
    expect(arrays.showPulled({ places: turned.slice(3), turns })).toBe(false);
    expect(arrays.selectGeometry(false, false).geometry).not.toBe(
      arrays.selectGeometry(true, false).geometry,
    );
  });

  test('has its edit and its normals turned with the frames', () => {
    arrays.startPull();
    expect(arrays.showPulled({ places: turned, turns })).toBe(true);
    const { geometry, summed } = arrays.selectGeometry(false, false);
    expect(summed).toBe(false);
    const shown = geometry.getAttribute('position').array;
    for (let k = 0; k < n; k += 97) {
      const [x, y, z] = [0, 1, 2].map((c) => edited[3 * k + c]!);
      for (const [c, value] of [-y!, x!, z!].entries()) expect(shown[3 * k + c]).toBeCloseTo(value, 3);
      expect([...geometry.getAttribute('normal').array.slice(4 * k, 4 * k + 2)]).toEqual([0, 127]);
    }
  });

  test('is no longer drawn once the edit is computed, and never for the original', () => {
    const before = arrays.selectGeometry(true, false).geometry;
    expect(before.getAttribute('position').array).toBe(rest);
    arrays.setEdited(edited, normals);
    expect(arrays.selectGeometry(false, false).geometry.getAttribute('position').array).toBe(edited);
  });
});
