import { expect, test } from 'vitest';
import type { Shape } from './protocol';
import { stillInward, turnedTriangles, withTurned } from './turned-parts';

test('triangles of turned parts keep their first corner', () => {
  const triangles = Uint32Array.of(0, 1, 2, 3, 4, 5);
  const parts = Uint32Array.of(0, 0, 0, 3, 3, 3);
  expect([...turnedTriangles(triangles, parts, [3])]).toEqual([0, 1, 2, 3, 5, 4]);
  expect([...turnedTriangles(triangles, parts, [0, 3])]).toEqual([0, 2, 1, 3, 5, 4]);
  expect([...triangles], 'the given ones stay').toEqual([0, 1, 2, 3, 4, 5]);
});

test('the list of turned parts is ascending, each once', () => {
  expect(withTurned([7], [3, 7, 12], true)).toEqual([3, 7, 12]);
  expect(withTurned([3, 7, 12], [7], false)).toEqual([3, 12]);
  const shape = {
    inward: [
      { vertex: 9, n_faces: 4, volume: -1 },
      { vertex: 2, n_faces: 4, volume: -1 },
    ],
  } as Shape;
  expect(stillInward(shape, [2])).toEqual([9]);
});
