/** Web worker for everything that depends on the number of vertices: positions, normals, masks and picking. */

import type { ReshapedBy } from '../protocol';
import { neighborsOfCloud, neighborsOfGraph, type Rows, trianglesOfVertices } from './adjacency';
import { edgePairs } from './coarse';
import { type EditableField, editedField, fieldChange, splitField } from './field';
import type { Bent, Call, Calls, Follow, FromWorker, PickAnswer, ToWorker, WorkerLayer } from './messages';
import { cloudNormals, meshNormals } from './normals';
import { Painter } from './painter';
import { type Balls, enclosingBalls, type Hit, pickCloud, pickMesh, type Ray } from './pick';
import { type Band, carryInto, displacement, editedPositions, type LayerTerm, volume } from './positions';
import type { RegionContext } from './regions';
import { contour } from './ring';
import { SurfaceSearch } from './search';
import { readBands } from './stream';
import { linkedPoints, placeNormals, readSurface, type Surface } from './surface';

const post = self.postMessage.bind(self) as (message: FromWorker, transfer?: Transferable[]) => void;

/** Largest number of vertices within the brush for a circle along the surface. */
const RING_MOST = 60_000;
const CLOUD_NEIGHBORS = 8;

class Shape {
  readonly n: number;
  readonly edited: Float32Array;
  readonly ground: RegionContext;
  readonly painter: Painter;
  bands: (Band | null)[] = [];
  /** The field that is edited; `null` while the positions are. */
  field: EditableField | null = null;
  private readonly sums: Float32Array;
  private aroundRows: Rows | null = null;
  private surfaceOnce: Surface | null = null;
  private searchOnce: SurfaceSearch | null = null;
  private normalsOnce: Float64Array | null = null;
  private bandsAbort: AbortController | null = null;
  /** The shape with clones and in its pose, its bands unchanged; `null` without any. */
  bent: Bent | null = null;
  private bentBy = '';
  /** True until the page was sent the present pose. */
  isBentNew = false;
  /** Triangles of which the edit may have turned some over; regions use those of the file. */
  triangles: Uint32Array;
  /** Enclosing balls of the edited vertices, for picking; `null` after they moved. */
  balls: Balls | null = null;

  constructor(readonly given: Calls['shape'][0]) {
    this.n = given.n;
    this.triangles = given.triangles;
    this.edited = given.positions.slice();
    this.sums = given.cloud ? new Float32Array(0) : new Float32Array(3 * this.n);
    const shape = this;
    this.ground = {
      n: this.n,
      diagonal: given.diagonal,
      local: !given.cloud,
      get surface() {
        return shape.surface;
      },
      get search() {
        return shape.search;
      },
      get normals() {
        shape.normalsOnce ??= placeNormals(shape.surface, given.triangles);
        return shape.normalsOnce;
      },
      ask: async (region) => {
        const response = await this.fetch('weights', { method: 'POST', body: JSON.stringify(region) });
        return new Uint8Array(await response.arrayBuffer());
      },
    };
    this.painter = new Painter(this.ground, given.positions, (key, from, bytes) => {
      post({ event: 'mask', key, from, bytes }, [bytes.buffer as ArrayBuffer]);
    });
  }

  get around(): Rows {
    this.aroundRows ??= trianglesOfVertices(this.given.triangles, this.n);
    return this.aroundRows;
  }

  /** Fetches the surface once: distances must be measured on the data of the server. */
  async prepare(): Promise<void> {
    if (this.surfaceOnce) return;
    const { cloud, triangles } = this.given;
    this.surfaceOnce = cloud
      ? this.linked()
      : readSurface(await (await this.fetch('surface')).arrayBuffer(), this.n, triangles);
  }

  /** Points of a cloud or a graph with their neighbors. */
  private linked(): Surface {
    const { positions, edges, countsEdges } = this.given;
    const neighbors = edges ? neighborsOfGraph(edges, this.n) : neighborsOfCloud(positions, CLOUD_NEIGHBORS);
    return linkedPoints(positions, neighbors, countsEdges);
  }

  get hasSurface(): boolean {
    return this.surfaceOnce !== null;
  }

  private get surface(): Surface {
    if (!this.surfaceOnce) throw new Error('The surface is not loaded yet. Try again.');
    return this.surfaceOnce;
  }

  get search(): SurfaceSearch {
    this.searchOnce ??= new SurfaceSearch(this.surface);
    return this.searchOnce;
  }

  /** Lists every edge once, as pairs of vertices. */
  async edges(): Promise<Uint32Array> {
    await this.prepare();
    const { neighbors, members } = this.surface;
    const pairs = edgePairs(neighbors.offsets, neighbors.entries);
    for (let i = 0; i < pairs.length; i++) pairs[i] = members.entries[members.offsets[pairs[i]!]!]!;
    return pairs;
  }

  normals(positions: Float32Array): Int8Array<ArrayBuffer> {
    const out = new Int8Array(4 * this.n);
    // Nodes of a graph face the viewer.
    if (this.given.edges) return out;
    if (this.given.cloud) {
      this.surfaceOnce ??= this.linked();
      const { offsets, entries } = this.surface.neighbors;
      cloudNormals(positions, offsets, entries, out);
    } else meshNormals(positions, this.triangles, this.sums, out);
    return out;
  }

  async fetch(path: string, init: RequestInit = {}): Promise<Response> {
    const response = await fetch(this.given.url + path, {
      ...init,
      headers: { Authorization: `Bearer ${this.given.token}`, 'Content-Type': 'application/json' },
    });
    if (!response.ok) {
      const text = await response.text();
      let sentence = text;
      try {
        sentence = (JSON.parse(text) as { error: string }).error;
      } catch {
        // The body is not JSON: it is shown as text.
      }
      throw new Error(sentence || `The server responded with status ${response.status}.`);
    }
    return response;
  }

  async readBands(nLevels: number, shared: boolean): Promise<void> {
    this.bandsAbort?.abort();
    const abort = new AbortController();
    this.bandsAbort = abort;
    this.bands = Array.from({ length: nLevels }, () => null);
    const bands = this.bands;
    const response = await this.fetch('bands', { signal: abort.signal });
    if (!response.body) throw new Error('The server sent no bands. Reload the page.');
    await readBands(response.body, this.n, nLevels, shared, (level, band) => {
      bands[level - 1] = band;
      post({
        event: 'band',
        level,
        scale: band.scale,
        values: band.values,
        at: performance.timeOrigin + performance.now(),
      });
    });
  }

  /** Fetches the shape with clones and in a pose: of all vertices, or of those that are drawn while it moves. */
  async fetchBent(by: ReshapedBy, follow: Follow, drawn: boolean): Promise<Bent> {
    const path = `pose?follow=${follow}&of=${drawn ? 'drawn' : 'all'}`;
    const response = await this.fetch(path, { method: 'POST', body: JSON.stringify(by) });
    const bytes = await response.arrayBuffer();
    const n = bytes.byteLength / 20;
    return { places: new Float32Array(bytes.slice(0, 12 * n)), turns: new Int16Array(bytes.slice(12 * n)) };
  }

  /** Clones and bends all vertices, if they are not. */
  async bend(by: ReshapedBy | null, follow: Follow): Promise<void> {
    if (!by) {
      this.isBentNew ||= this.bent !== null;
      this.bent = null;
      this.bentBy = '';
      return;
    }
    const text = `${follow} ${JSON.stringify(by)}`;
    if (text === this.bentBy) return;
    this.bentBy = '';
    this.bent = await this.fetchBent(by, follow, false);
    this.bentBy = text;
    this.isBentNew = true;
  }

  /** Updates the masks of layers; returns a message about one whose region cannot be computed. The others have an effect. */
  async showMasks(layers: readonly WorkerLayer[]): Promise<string | null> {
    let problem: string | null = null;
    for (const l of layers) {
      if (l.region === null) continue;
      try {
        await this.prepare();
        await this.painter.show(l.key, l.region);
      } catch (error) {
        problem = (error as Error).message;
      }
    }
    return problem;
  }

  terms(layers: readonly WorkerLayer[]): LayerTerm[] {
    return layers
      .filter((l) => l.on && (l.region === null || this.painter.mask(l.key)))
      .map((l) => ({
        opacity: l.opacity,
        gains: l.gains,
        mask: l.region === null ? null : this.painter.mask(l.key),
      }));
  }

  hit(ray: Ray): Hit | null {
    const { triangles, meanLength, cloud } = this.given;
    this.balls ??= enclosingBalls(this.edited);
    return cloud
      ? pickCloud(this.edited, this.balls, meanLength, ray)
      : pickMesh(this.edited, this.balls, triangles, this.around, meanLength, ray);
  }

  spectrum(v: number): number[] {
    if (this.field) return this.field.bands.map((band) => Math.abs(band[v]!));
    return this.bands.map((b) =>
      b ? b.scale * Math.hypot(b.values[4 * v]!, b.values[4 * v + 1]!, b.values[4 * v + 2]!) : 0,
    );
  }

  answerPick(hit: Hit | null, radius: number | null, half: number, started: number): PickAnswer {
    const answer: PickAnswer = {
      hit,
      spectrum: hit ? this.spectrum(hit.vertex) : [],
      outer: null,
      inner: null,
      took: 0,
    };
    if (hit && radius && !this.given.cloud && this.hasSurface) {
      // Slightly beyond the radius, to include the triangles that the circle crosses.
      if (this.search.run([hit.vertex], radius + 2 * this.given.meanLength, RING_MOST)) {
        const { triangles } = this.given;
        answer.outer = contour(this.search, this.edited, triangles, this.around, radius);
        answer.inner = contour(this.search, this.edited, triangles, this.around, half);
      }
    }
    answer.took = performance.now() - started;
    return answer;
  }

  rms(weight: (see: (v: number, w: number) => void) => void): number[] {
    const sums = this.bands.map(() => 0);
    let total = 0;
    weight((v, w) => {
      total += w;
      for (let j = 0; j < sums.length; j++) {
        const b = this.bands[j];
        if (!b) continue;
        const x = b.values[4 * v]!;
        const y = b.values[4 * v + 1]!;
        const z = b.values[4 * v + 2]!;
        sums[j]! += w * b.scale * b.scale * (x * x + y * y + z * z);
      }
    });
    return sums.map((s) => (total > 0 ? Math.sqrt(s / total) : 0));
  }
}

let current: Shape | null = null;

function shape(): Shape {
  if (!current) throw new Error('No shape is open.');
  return current;
}

/** Number of triangles whose normals are computed faster than the first bands arrive. */
const FEW_TRIANGLES = 200_000;

const answers: { [C in Call]: (what: Calls[C][0]) => Calls[C][1] | Promise<Calls[C][1]> } = {
  async shape(what) {
    const opened = new Shape(what);
    current = opened;
    // The next message requests the bands. A few normals are computed while those are in transit; many would delay
    // unpacking them.
    if (what.triangles.length <= 3 * FEW_TRIANGLES) await new Promise((done) => setTimeout(done));
    return { normals: opened.normals(what.positions) };
  },
  turn({ triangles }) {
    const s = shape();
    s.triangles = triangles;
    return { normals: s.normals(s.given.positions) };
  },
  async edges() {
    return { pairs: await shape().edges() };
  },
  async bands({ nLevels, shared }) {
    const started = performance.now();
    await shape().readBands(nLevels, shared);
    return { seconds: (performance.now() - started) / 1000 };
  },
  field({ values }) {
    const s = shape();
    s.field = values && splitField(values, s.n);
    return {};
  },
  async fieldEdit({ layers, regions, keep }) {
    const s = shape();
    s.painter.updateRegions(regions);
    s.painter.retainLayers(new Set(keep));
    const problem = await s.showMasks(layers);
    if (!s.field) throw new Error('The bands of the field are not loaded yet. Try again.');
    const values = editedField(s.field, s.terms(layers));
    return { values, ...fieldChange(s.field.values, values), problem };
  },
  async edit({ layers, regions, keep, exact, by, follow }) {
    const s = shape();
    s.painter.updateRegions(regions);
    s.painter.retainLayers(new Set(keep));
    let problem = await s.showMasks(layers);
    try {
      await s.bend(by, follow);
    } catch (error) {
      problem = (error as Error).message;
    }
    const started = performance.now();
    s.balls = null;
    if (exact) {
      const response = await s.fetch('exact');
      s.edited.set(new Float32Array(await response.arrayBuffer()));
    } else {
      editedPositions(s.given.positions, s.bands, s.terms(layers), s.edited);
      if (s.bent) carryInto(s.given.positions, s.bent.places, s.bent.turns, s.edited);
    }
    const isNew = s.isBentNew;
    s.isBentNew = false;
    const normals = s.normals(s.edited);
    const took = performance.now() - started;
    const moved = displacement(s.given.positions, s.edited);
    return {
      positions: s.edited.slice(),
      normals,
      ...moved,
      places: isNew ? (s.bent?.places.slice() ?? null) : null,
      turns: isNew ? (s.bent?.turns.slice() ?? null) : null,
      problem,
      volume: s.given.cloud ? null : volume(s.edited, s.triangles),
      took,
    };
  },
  async drawn({ vertices }) {
    await shape().fetch('drawn', { method: 'PUT', body: vertices as Uint32Array<ArrayBuffer> });
    return {};
  },
  bend({ by, follow, drawn }) {
    return shape().fetchBent(by, follow, drawn);
  },
  shift({ vertex }) {
    const { bent, given } = shape();
    const by = [0, 1, 2].map((c) =>
      bent ? bent.places[3 * vertex + c]! - given.positions[3 * vertex + c]! : 0,
    );
    return { by };
  },
  async warm() {
    await shape().prepare();
    // Reading the property builds the search.
    void shape().search;
    return {};
  },
  async mask({ key, id, regions, smoothing }) {
    const s = shape();
    await s.prepare();
    s.painter.updateRegions(regions);
    await s.painter.show(key, id);
    if (smoothing !== null) await s.painter.prepareSmoothing(key, id, smoothing);
    return {};
  },
  maskBytes({ key }) {
    return { bytes: shape().painter.mask(key)?.slice() ?? new Uint8Array(0) };
  },
  pick({ ray, ring }) {
    const started = performance.now();
    const s = shape();
    return s.answerPick(s.hit(ray), ring?.radius ?? null, ring?.half ?? 0, started);
  },
  paint({ key, rays, brush, ring }) {
    const started = performance.now();
    const s = shape();
    const vertices: number[] = [];
    let hit: Hit | null = null;
    for (const ray of rays) {
      const h = s.hit(ray);
      if (!h) continue;
      hit = h;
      vertices.push(h.vertex);
    }
    const before = performance.now();
    const stamped = s.painter.stamp(key, vertices, brush);
    const stampTook = (performance.now() - before) / Math.max(1, stamped);
    return { ...s.answerPick(hit, brush.radius, ring, started), stamped, stampTook };
  },
  paintEnd({ keep, child }) {
    const s = shape();
    if (keep) return { indices: s.painter.end(child) };
    s.painter.cancel();
    return { indices: [] };
  },
  scalar(what) {
    const s = shape();
    const values = new Float32Array(s.n);
    if (what === 'change') {
      const a = s.given.positions;
      const b = s.edited;
      for (let v = 0, i = 0; v < s.n; v++, i += 3) {
        values[v] = Math.hypot(b[i]! - a[i]!, b[i + 1]! - a[i + 1]!, b[i + 2]! - a[i + 2]!);
      }
    } else {
      const band = s.bands[what.band - 1];
      if (band) {
        const w = band.values;
        for (let v = 0, i = 0; v < s.n; v++, i += 4) {
          values[v] = band.scale * Math.hypot(w[i]!, w[i + 1]!, w[i + 2]!);
        }
      }
    }
    return { values };
  },
  async energy({ key, vertex, radius }) {
    const s = shape();
    if (vertex !== null) await s.prepare();
    return {
      rms: s.rms((see) => {
        if (vertex !== null) {
          s.search.run([vertex], radius);
          for (let i = 0; i < s.search.nReached; i++) see(s.search.reached[i]!, 1);
          return;
        }
        const mask = key === null ? null : s.painter.mask(key);
        for (let v = 0; v < s.n; v++) {
          const w = mask ? mask[v]! : 255;
          if (w > 0) see(v, w);
        }
      }),
    };
  },
  normals({ positions }) {
    return { normals: shape().normals(positions) };
  },
  normalsOf({ positions, triangles }) {
    const normals = new Int8Array((4 * positions.length) / 3);
    if (triangles.length > 0) meshNormals(positions, triangles, new Float32Array(positions.length), normals);
    else {
      const { offsets, entries } = neighborsOfCloud(positions, CLOUD_NEIGHBORS);
      cloudNormals(positions, offsets, entries, normals);
    }
    return { normals };
  },
  positions() {
    return { positions: shape().edited.slice() };
  },
};

/** Requests are answered one after the other, except for the stream of bands, which runs concurrently. */
let queue: Promise<void> = Promise.resolve();

async function answer(message: ToWorker): Promise<void> {
  try {
    const answering = answers[message.call] as (what: unknown) => unknown;
    const result = (await answering(message.with)) as Record<string, unknown>;
    const buffers = Object.values(result)
      .filter((v): v is ArrayBufferView => ArrayBuffer.isView(v))
      .map((v) => v.buffer as ArrayBuffer);
    post({ id: message.id, answer: result }, buffers);
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') return;
    post({ id: message.id, error: error instanceof Error ? error.message : String(error) });
  }
}

self.onmessage = (event: MessageEvent<ToWorker>) => {
  const message = event.data;
  if (message.call === 'bands') void answer(message);
  else queue = queue.then(() => answer(message));
};
