/** What the one file holds: a head in JSON, then arrays, all packed by gzip and written in base64. */

import type { Band } from '../compute/positions';

export interface Head {
  name: string;
  n_vertices: number;
  n_triangles: number;
  /** Of the shape that the file was made of. */
  n_vertices_before: number;
  levels: { level: number; sigma: number }[];
  scales: number[];
  layers: { name: string; opacity: number; gains: number[]; mask: number | null }[];
  n_masks: number;
  /** Whether the edit asks for more than a sum of bands, which only the server does. */
  rules: boolean;
}

export interface Content {
  head: Head;
  positions: Float32Array;
  triangles: Uint32Array;
  bands: Band[];
  masks: Uint8Array[];
}

export async function unpack(base64: string): Promise<Content> {
  const text = atob(base64);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return read(await new Response(stream).arrayBuffer());
}

/** The arrays, each at a multiple of four. */
export function read(buffer: ArrayBuffer): Content {
  const size = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size))) as Head;
  let at = 4 + size;
  /** Where the next array of so many bytes begins. */
  const next = (bytes: number): number => {
    const here = (at + 3) & ~3;
    at = here + bytes;
    return here;
  };
  const n = head.n_vertices;
  const positions = new Float32Array(buffer, next(12 * n), 3 * n);
  const triangles = new Uint32Array(buffer, next(12 * head.n_triangles), 3 * head.n_triangles);
  const bands = head.scales.map((scale) => ({
    scale,
    values: fourths(new Int16Array(buffer, next(6 * n), 3 * n)),
  }));
  const masks = Array.from({ length: head.n_masks }, () => new Uint8Array(buffer, next(n), n));
  return { head, positions, triangles, bands, masks };
}

/** Three numbers a vertex as four, as the sum of the bands takes them. */
function fourths(values: Int16Array): Int16Array {
  const out = new Int16Array((4 * values.length) / 3);
  for (let i = 0, k = 0; i < values.length; i += 3, k += 4) {
    out[k] = values[i]!;
    out[k + 1] = values[i + 1]!;
    out[k + 2] = values[i + 2]!;
  }
  return out;
}
