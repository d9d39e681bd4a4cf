/** Entry point: starts fetching the arrays of the shape before the rest of the page is loaded. */

import { Api, readToken } from './api';
import type { OpenedName, Shape } from './protocol';

export interface ShapeRequest {
  id: number;
  shape: Promise<Shape>;
  /** Positions and triangles of a shape; empty for an image or a volume. */
  positions: Promise<Float32Array<ArrayBuffer>>;
  triangles: Promise<Uint32Array<ArrayBuffer>>;
}

const started = performance.now();
const api = new Api(readToken());

export function fetchShape(from: Api, { id, domain }: Pick<OpenedName, 'id' | 'domain'>): ShapeRequest {
  const isGrid = domain === 'grid';
  const early = {
    id,
    shape: from.shape(id),
    positions: isGrid ? Promise.resolve(new Float32Array(0)) : from.floats(`shapes/${id}/positions`),
    triangles: isGrid ? Promise.resolve(new Uint32Array(0)) : from.indices(`shapes/${id}/triangles`),
  };
  // Errors are reported by the code that awaits these promises, once the page is loaded.
  for (const promise of [early.shape, early.positions, early.triangles]) promise.catch(() => {});
  return early;
}

const list = api.shapes();
const early = list.then((l) => {
  const last = Number(sessionStorage.getItem('adwave-shape'));
  const shape = l.shapes.find((s) => s.id === last) ?? l.shapes[0];
  return shape ? fetchShape(api, shape) : null;
});
early.catch(() => {});

void import('./main').then(({ start }) => start({ api, list, early, fetchShape, started }));
