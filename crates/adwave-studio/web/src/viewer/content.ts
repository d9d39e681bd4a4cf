/** Content of the exported file: a JSON head and arrays, compressed with gzip and encoded in Base64. */

import type { Band } from '../compute/positions';

export interface ContentHead {
  name: string;
  n_vertices: number;
  n_triangles: number;
  /** Number of vertices of the original shape. */
  n_vertices_before: number;
  levels: { level: number; sigma: number }[];
  scales: number[];
  layers: { name: string; opacity: number; gains: number[]; mask: number | null }[];
  n_masks: number;
  /** True if the edit has constraints, which only the server can apply. */
  rules: boolean;
}

export interface ViewerContent {
  head: ContentHead;
  positions: Float32Array;
  triangles: Uint32Array;
  bands: Band[];
  masks: Uint8Array[];
}

export async function unpack(base64: string): Promise<ViewerContent> {
  const text = atob(base64);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < packed.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return parseContent(await new Response(stream).arrayBuffer());
}

/** Parses the head and the arrays, which begin at multiples of four. */
export function parseContent(buffer: ArrayBuffer): ViewerContent {
  const size = new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size))) as ContentHead;
  let at = 4 + size;
  /** Offset of the next array of `bytes` bytes. */
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
    values: padToFour(new Int16Array(buffer, next(6 * n), 3 * n)),
  }));
  const masks = Array.from({ length: head.n_masks }, () => new Uint8Array(buffer, next(n), n));
  return { head, positions, triangles, bands, masks };
}

/** Pads three numbers per vertex to four, the layout of the sum of bands. */
function padToFour(values: Int16Array): Int16Array {
  const out = new Int16Array((4 * values.length) / 3);
  for (let i = 0, k = 0; i < values.length; i += 3, k += 4) {
    out[k] = values[i]!;
    out[k + 1] = values[i + 1]!;
    out[k + 2] = values[i + 2]!;
  }
  return out;
}
