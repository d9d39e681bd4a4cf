/**
 * Mock server of PROTOCOL.md, to test the page without the real one: a bumpy sphere of any size, whose bands are waves
 * along its normals.
 */

import { readFile } from 'node:fs/promises';
import { createServer, type IncomingMessage, type Server, type ServerResponse } from 'node:http';
import type { AddressInfo } from 'node:net';
import { extname, join, normalize } from 'node:path';
import type { Edit, EditSummary, Layer, Shape } from '../../src/protocol';

const POLICY =
  "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' blob: data:; worker-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
const TYPES: Record<string, string> = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css' };
const TOKEN = 'mock-token';

interface MockBand {
  level: number;
  scale: number;
  values: Int16Array;
  sigma: number;
}

interface MockModel {
  n: number;
  positions: Float32Array;
  triangles: Uint32Array;
  bands: MockBand[];
}

/** Sphere of about `target` vertices with waves along its normals; each wave is a band. */
function bumpySphere(target: number, nLevels: number): MockModel {
  const rings = Math.max(3, Math.round(Math.sqrt(target / 2)));
  const around = Math.max(4, Math.round((target - 2) / rings));
  const n = rings * around + 2;
  const sphere = new Float64Array(3 * n);
  const at = (r: number, a: number) => 1 + r * around + (a % around);
  for (let r = 0; r < rings; r++) {
    const theta = (Math.PI * (r + 1)) / (rings + 1);
    for (let a = 0; a < around; a++) {
      const phi = (2 * Math.PI * a) / around;
      sphere.set(
        [Math.sin(theta) * Math.cos(phi), Math.cos(theta), -Math.sin(theta) * Math.sin(phi)],
        3 * at(r, a),
      );
    }
  }
  sphere.set([0, 1, 0], 0);
  sphere.set([0, -1, 0], 3 * (n - 1));
  const triangles = new Uint32Array(6 * rings * around);
  let k = 0;
  for (let a = 0; a < around; a++) {
    triangles.set([0, at(0, a), at(0, a + 1)], k);
    k += 3;
    triangles.set([n - 1, at(rings - 1, a + 1), at(rings - 1, a)], k);
    k += 3;
    for (let r = 0; r + 1 < rings; r++) {
      triangles.set([at(r, a), at(r + 1, a), at(r + 1, a + 1), at(r, a), at(r + 1, a + 1), at(r, a + 1)], k);
      k += 6;
    }
  }
  const positions = Float32Array.from(sphere);
  const bands: MockBand[] = [];
  for (let j = 1; j <= nLevels; j++) {
    const frequency = 60 / 1.6 ** (j - 1);
    const amplitude = 0.006 * 1.45 ** (j - 1);
    const scale = amplitude / 32767;
    const values = new Int16Array(4 * n);
    for (let v = 0; v < n; v++) {
      const [x, y, z] = [sphere[3 * v]!, sphere[3 * v + 1]!, sphere[3 * v + 2]!];
      const wave = Math.sin(frequency * x + j) * Math.sin(frequency * y + 2 * j) * Math.sin(frequency * z);
      // Fine detail on one side only, so that spots differ.
      const w = wave * (j < 4 ? 0.5 + 0.5 * y : 1);
      for (let c = 0; c < 3; c++) {
        const q = Math.round(32767 * w * sphere[3 * v + c]!);
        values[4 * v + c] = q;
        positions[3 * v + c]! += q * scale;
      }
    }
    bands.push({ level: j, scale, values, sigma: 0.01 * 1.6 ** (j - 1) });
  }
  return { n, positions, triangles, bands };
}

function gainAt(layers: readonly Layer[], j: number): number {
  let gain = 1;
  for (const l of layers) if (l.on && !l.region) gain *= 1 + l.opacity * ((l.gains[j] ?? 1) - 1);
  return gain;
}

export interface MockServer {
  url: string;
  server: Server;
}

export interface MockOptions {
  nVertices: number;
  /** Folder with the files of the page. */
  dist: string;
  isCloud?: boolean;
  nLevels?: number;
}

/** Starts a mock server. It ignores regions, because the page computes its own masks. */
export function startMockServer({
  nVertices,
  dist,
  isCloud = false,
  nLevels = 8,
}: MockOptions): Promise<MockServer> {
  const model = bumpySphere(nVertices, nLevels);
  const name = isCloud ? 'bumpy.pts' : 'bumpy.ply';
  let edit: Edit = {
    revision: 0,
    layers: [{ name: '', on: true, opacity: 1, gains: new Array<number>(nLevels).fill(1), region: null }],
    along: null,
    border: 'natural',
    volume: 'free',
  };
  const shapes: { id: number; name: string | null }[] = [{ id: 1, name }];
  const describe = (id: number): Shape => ({
    id,
    name: shapes.find((s) => s.id === id)?.name ?? name,
    format: 'PLY',
    formats: ['PLY', 'OBJ', 'STL'],
    kind: isCloud ? 'cloud' : 'mesh',
    n_vertices: model.n,
    n_triangles: isCloud ? 0 : model.triangles.length / 3,
    center: [0, 0, 0],
    diagonal: 3.5,
    mean_length: 3.5 / Math.sqrt(model.n),
    closed: !isCloud,
    volume: isCloud ? null : 4.19,
    components: 1,
    notes: ['Created by the mock server.'],
    choice: { levels: nLevels },
    levels: model.bands.map((b) => ({
      level: b.level,
      steps: 2 ** (b.level - 1),
      sigma: b.sigma,
      fwhm: 1.665 * b.sigma,
    })),
    fields: [
      { name: 'mean-curvature', label: 'mean curvature', unit: '1/unit', edited: true },
      { name: 'saliency', label: 'saliency', unit: '', edited: true },
    ],
    presets: [
      { name: 'smooth', gains: Array.from({ length: nLevels }, (_, j) => (j < 3 ? 0 : 1)) },
      { name: 'enhance', gains: Array.from({ length: nLevels }, (_, j) => (j < 4 ? 2 : 1)) },
    ],
    resumed: edit.revision > 0,
  });
  const edited = () => {
    const out = model.positions.slice();
    for (const [j, b] of model.bands.entries()) {
      const c = (gainAt(edit.layers, j) - 1) * b.scale;
      if (c === 0) continue;
      for (let v = 0; v < model.n; v++) {
        for (let d = 0; d < 3; d++) out[3 * v + d] += c * b.values[4 * v + d];
      }
    }
    return out;
  };
  const summarize = (): EditSummary => {
    const a = model.positions;
    const b = edited();
    let most = 0;
    let sum = 0;
    for (let i = 0; i < a.length; i += 3) {
      const d = (b[i] - a[i]) ** 2 + (b[i + 1] - a[i + 1]) ** 2 + (b[i + 2] - a[i + 2]) ** 2;
      sum += d;
      most = Math.max(most, d);
    }
    return {
      revision: edit.revision,
      greatest: Math.sqrt(most),
      rms: Math.sqrt(sum / model.n),
      volume: isCloud ? null : [4.19, 4.19],
    };
  };

  const bytes = (array: ArrayBufferView) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);
  async function answer(
    request: IncomingMessage,
    response: ServerResponse,
    url: URL,
    body: string,
  ): Promise<unknown> {
    const json = (value: unknown, status = 200) => {
      response.writeHead(status, { 'Content-Type': 'application/json' });
      response.end(JSON.stringify(value));
    };
    const raw = (array: ArrayBufferView, headers: Record<string, string> = {}) => {
      const b = bytes(array);
      response.writeHead(200, {
        'Content-Type': 'application/octet-stream',
        'Content-Length': b.length,
        ...headers,
      });
      response.end(b);
    };
    if (request.headers.authorization !== `Bearer ${TOKEN}`)
      return json({ error: 'the token is wrong' }, 401);
    const [, , , id, what] = url.pathname.split('/');
    const { method } = request;
    if (!id) {
      if (method === 'GET') return json({ version: 'mock', shapes });
      const shape = { id: shapes.length + 1, name: url.searchParams.get('name') };
      shapes.push(shape);
      return json(shape);
    }
    if (!shapes.some((s) => s.id === Number(id))) return json({ error: `shape ${id} is not open` }, 404);
    switch (`${method} ${what ?? ''}`) {
      case 'GET ':
        return json(describe(Number(id)));
      case 'DELETE ':
        shapes.splice(
          shapes.findIndex((s) => s.id === Number(id)),
          1,
        );
        return json({});
      case 'GET positions':
        return raw(model.positions);
      case 'GET triangles':
        return raw(isCloud ? new Uint32Array(0) : model.triangles);
      case 'GET surface': {
        // No vertices are welded.
        const places = Uint32Array.from({ length: model.n }, (_, v) => v);
        return raw(Buffer.concat([bytes(Float64Array.from(model.positions)), bytes(places)]));
      }
      case 'PUT levels':
        return json({ levels: describe(1).levels, choice: { levels: nLevels }, edit });
      case 'GET bands': {
        response.writeHead(200, { 'Content-Type': 'application/octet-stream' });
        for (const band of model.bands.toReversed()) {
          const head = Buffer.alloc(8);
          head.writeUInt32LE(band.level, 0);
          head.writeFloatLE(band.scale, 4);
          response.write(head);
          if (!response.write(bytes(band.values)))
            await new Promise((resolve) => response.once('drain', resolve));
        }
        return response.end();
      }
      case 'GET edit':
        return json(edit);
      case 'PUT edit': {
        const next = JSON.parse(body);
        if (next.revision <= edit.revision) return json(edit, 409);
        edit = next;
        return json(summarize());
      }
      case 'GET exact':
        return raw(edited());
      case 'POST weights':
        return raw(
          new Uint8Array(model.n).map((_, v) => Math.round(127 + 127 * model.positions[3 * v + 1] * 0.9)),
        );
      case 'GET field': {
        const which = url.searchParams.get('name')!;
        const field = new Float32Array(model.n).map((_, v) => {
          const b = model.bands[3]!.values;
          const x = Math.hypot(b[4 * v], b[4 * v + 1], b[4 * v + 2]) / 32767;
          return which === 'saliency' ? x : x * Math.sign(model.positions[3 * v]);
        });
        const info = {
          label: which.replace('-', ' '),
          unit: which === 'saliency' ? '' : '1/unit',
          diverging: which !== 'saliency',
        };
        return raw(field, { 'X-Field': JSON.stringify(info) });
      }
      case 'GET features':
        return json(
          Array.from({ length: 24 }, (_, i) => {
            const v = Math.floor((i * model.n) / 24);
            const position = [...model.positions.subarray(3 * v, 3 * v + 3)];
            return {
              vertex: v,
              position,
              level: 1 + (i % 4),
              sigma: 0.03 + 0.01 * (i % 4),
              strength: i,
              sign: i % 2 ? 1 : -1,
            };
          }),
        );
      case 'GET recipe':
        response.writeHead(200, { 'Content-Type': 'application/toml' });
        return response.end(`levels = ${nLevels}\n# ${JSON.stringify(edit.layers)}\n`);
      case 'PUT recipe':
        return json({ levels: describe(1).levels, choice: { levels: nLevels }, edit });
      case 'POST save':
        return json({
          path: `/tmp/${JSON.parse(body).name ?? 'bumpy-edited.ply'}`,
          notes: ['Nothing was written by the mock server.'],
        });
      case 'GET download':
        return raw(edited());
      default:
        return json({ error: `not found: ${method} ${url.pathname}` }, 404);
    }
  }

  const server = createServer(async (request, response) => {
    const url = new URL(request.url!, 'http://localhost');
    for (const [k, v] of Object.entries({
      'Content-Security-Policy': POLICY,
      'Cross-Origin-Opener-Policy': 'same-origin',
      'Cross-Origin-Embedder-Policy': 'require-corp',
      'Cross-Origin-Resource-Policy': 'same-origin',
      'X-Content-Type-Options': 'nosniff',
      'Cache-Control': 'no-store',
    })) {
      response.setHeader(k, v);
    }
    try {
      if (url.pathname.startsWith('/api/')) {
        const chunks: Buffer[] = [];
        for await (const chunk of request) chunks.push(chunk);
        await answer(request, response, url, Buffer.concat(chunks).toString());
        return;
      }
      const path = normalize(url.pathname === '/' ? '/index.html' : url.pathname);
      const file = await readFile(join(dist, path));
      response.writeHead(200, { 'Content-Type': TYPES[extname(path)] ?? 'application/octet-stream' });
      response.end(file);
    } catch (error) {
      if (!response.headersSent)
        response.writeHead((error as NodeJS.ErrnoException).code === 'ENOENT' ? 404 : 500);
      response.end(String(error));
    }
  });
  return new Promise((resolve) => {
    server.listen(0, '127.0.0.1', () => {
      resolve({ url: `http://127.0.0.1:${(server.address() as AddressInfo).port}/#${TOKEN}`, server });
    });
  });
}
