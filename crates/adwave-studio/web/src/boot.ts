/** Starts what takes longest, the arrays of the shape, before the rest of the page is read. */

import { Api, takeToken } from './api';
import type { Shape } from './protocol';

export interface Early {
  id: number;
  shape: Promise<Shape>;
  positions: Promise<Float32Array<ArrayBuffer>>;
  triangles: Promise<Uint32Array<ArrayBuffer>>;
}

const started = performance.now();
const api = new Api(takeToken());

export function fetchShape(from: Api, id: number): Early {
  const early = {
    id,
    shape: from.shape(id),
    positions: from.floats(`shapes/${id}/positions`),
    triangles: from.indices(`shapes/${id}/triangles`),
  };
  // Whoever waits for them sees the error; nobody does before the rest of the page is there.
  for (const promise of [early.shape, early.positions, early.triangles]) promise.catch(() => {});
  return early;
}

const list = api.shapes();
const early = list.then((l) => {
  const last = Number(sessionStorage.getItem('adwave-shape'));
  const shape = l.shapes.find((s) => s.id === last) ?? l.shapes[0];
  return shape ? fetchShape(api, shape.id) : null;
});
early.catch(() => {});

void import('./main').then(({ start }) => start({ api, list, early, fetchShape, started }));
