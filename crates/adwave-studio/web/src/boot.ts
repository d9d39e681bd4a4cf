/** Entry point: starts fetching the arrays of the shape before the rest of the page is loaded. */

import { Api, readToken } from './api';
import type { Shape } from './protocol';

export interface ShapeRequest {
  id: number;
  shape: Promise<Shape>;
  positions: Promise<Float32Array<ArrayBuffer>>;
  triangles: Promise<Uint32Array<ArrayBuffer>>;
}

const started = performance.now();
const api = new Api(readToken());

export function fetchShape(from: Api, id: number): ShapeRequest {
  const early = {
    id,
    shape: from.shape(id),
    positions: from.floats(`shapes/${id}/positions`),
    triangles: from.indices(`shapes/${id}/triangles`),
  };
  // Errors are reported by the code that awaits these promises, once the page is loaded.
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
