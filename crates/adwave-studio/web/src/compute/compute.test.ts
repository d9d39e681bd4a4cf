import { describe, expect, test } from 'vitest';
import { neighborsOfCloud } from './adjacency';
import { coarseTriangles, edgePairs } from './coarse';
import { cloudNormals, meshNormals } from './normals';
import { enclosingBalls, nearestVertex, pickMesh } from './pick';
import { carryInto, displacement, editedPositions, volume } from './positions';
import { contour } from './ring';
import { SurfaceSearch } from './search';
import { readBands } from './stream';
import { placeNormals, readSurface } from './surface';
import { random, rows, sheet, surfaceOf } from './testing';

/** Literal reference of the server's search: Dijkstra with straight lines over two edges and a linear queue. */
function literalDistances(
  neighbors: { offsets: Uint32Array; entries: Uint32Array },
  p: Float32Array,
  sources: number[],
  radius: number,
): number[] {
  const n = p.length / 3;
  const far = (a: number, b: number) =>
    Math.sqrt(
      (p[3 * a]! - p[3 * b]!) ** 2 +
        (p[3 * a + 1]! - p[3 * b + 1]!) ** 2 +
        (p[3 * a + 2]! - p[3 * b + 2]!) ** 2,
    );
  const distance = new Array<number>(n).fill(Infinity);
  const before = new Array<number>(n).fill(-1);
  const queue: [number, number][] = [];
  for (const s of sources) {
    if (distance[s]! <= 0) continue;
    distance[s] = 0;
    queue.push([0, s]);
  }
  while (queue.length) {
    queue.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const [key, x] = queue.shift()!;
    if (key > distance[x]!) continue;
    for (let e = neighbors.offsets[x]!; e < neighbors.offsets[x + 1]!; e++) {
      const y = neighbors.entries[e]!;
      let there = distance[x]! + far(x, y);
      if (before[x]! >= 0) there = Math.min(there, distance[before[x]!]! + far(before[x]!, y));
      if (there < distance[y]! && there <= radius) {
        distance[y] = there;
        before[y] = x;
        queue.push([there, y]);
      }
    }
  }
  return distance;
}

describe('distance along the surface', () => {
  test('equals the literal rule for clouds on random strokes', () => {
    const s = sheet(17, 0.02);
    const { neighbors } = rows(s);
    const search = new SurfaceSearch({ ...surfaceOf(s), corners: null });
    const next = random(1);
    for (let stroke = 0; stroke < 40; stroke++) {
      const sources = Array.from({ length: 1 + Math.floor(4 * next()) }, () => Math.floor(next() * s.n));
      const radius = 0.05 + 0.5 * next();
      search.run(sources, radius);
      const expected = literalDistances(neighbors, s.positions, sources, radius);
      expect(Array.from({ length: s.n }, (_, v) => search.distance(v))).toEqual(expected);
      expect(search.nReached).toBe(expected.filter(Number.isFinite).length);
    }
  });

  test('is straight on a plane, whatever the cells', () => {
    for (const stretch of [1, 0.3, 0.05]) {
      const s = sheet(30);
      for (let v = 0; v < s.n; v++) s.positions[3 * v + 1]! *= stretch;
      const search = new SurfaceSearch(surfaceOf(s));
      const p = s.positions;
      for (const source of [0, 31 * 15 + 15, 700]) {
        const radius = 0.4;
        search.run([source], radius);
        for (let v = 0; v < s.n; v++) {
          const expected = Math.hypot(p[3 * v]! - p[3 * source]!, p[3 * v + 1]! - p[3 * source + 1]!);
          if (expected < radius * 0.999999) expect(search.distance(v)).toBeCloseTo(expected, 9);
          if (expected > radius * 1.000001) expect(search.distance(v)).toBe(Infinity);
        }
      }
    }
  });

  test('does not stop at a seam of vertices at one place', () => {
    const s = sheet(8);
    // The same sheet as loose triangles.
    const positions = new Float32Array(3 * s.triangles.length);
    for (const [i, v] of s.triangles.entries()) positions.set(s.positions.subarray(3 * v, 3 * v + 3), 3 * i);
    // Any order of the places is valid.
    const places = Uint32Array.from(s.triangles, (v) => s.n - 1 - v);
    const bytes = new ArrayBuffer(28 * places.length);
    new Float64Array(bytes, 0, 3 * places.length).set(positions);
    new Uint32Array(bytes, 24 * places.length).set(places);
    const triangles = Uint32Array.from(s.triangles, (_, i) => i);
    const surface = readSurface(bytes, places.length, triangles);
    expect(surface.points.length).toBe(3 * s.n);
    const loose = new SurfaceSearch(surface);
    loose.run([s.triangles.indexOf(40)], 0.5);
    const whole = new SurfaceSearch(surfaceOf(s));
    whole.run([40], 0.5);
    for (const [i, v] of s.triangles.entries()) expect(loose.distance(i)).toBeCloseTo(whole.distance(v), 1);
    expect(loose.nReached).toBeGreaterThan(whole.nReached);
    const normals = placeNormals(surface, triangles);
    for (let i = 0; i < normals.length; i += 3)
      expect(Array.from(normals.subarray(i, i + 3))).toEqual([0, 0, 1]);
  });
});

describe('positions', () => {
  const base = Float32Array.from([0, 0, 0, 1, 0, 0]);
  const band = { scale: 0.5, values: Int16Array.from([2, 0, 0, 0, 0, 4, 0, 0]) };
  const other = { scale: 0.25, values: Int16Array.from([0, 0, 4, 0, 0, 0, 8, 0]) };

  test('are f + Σ (Γ − 1) W with the product over layers', () => {
    const out = new Float32Array(6);
    const mask = Uint8Array.from([0, 255]);
    const half = Uint8Array.from([0, 51]);
    const layers = [
      { opacity: 1, gains: [3, 1], mask: null },
      { opacity: 0.5, gains: [2, 0], mask },
      { opacity: 1, gains: [1, 2], mask: half },
    ];
    editedPositions(base, [band, other], layers, out);
    // Vertex 0: Γ = (3, 1). Vertex 1: Γ = (3 · 1.5, 0.5 · 1.2).
    expect(Array.from(out)).toEqual([
      2,
      0,
      0,
      1,
      Math.fround((4.5 - 1) * 2),
      Math.fround((0.5 * 1.2 - 1) * 2),
    ]);
  });

  test('of a neutral edit are those of the shape, to the bit', () => {
    const s = sheet(9, 0.1);
    const w = { scale: 1e-3, values: new Int16Array(4 * s.n).fill(1000) };
    const out = new Float32Array(3 * s.n);
    editedPositions(
      s.positions,
      [w, null],
      [{ opacity: 1, gains: [1, 1], mask: new Uint8Array(s.n).fill(99) }],
      out,
    );
    expect(out).toEqual(s.positions);
  });

  test('of many bands are those of one band after the other, to the bit', () => {
    const s = sheet(9, 0.1);
    const next = random(5);
    const bands = Array.from({ length: 7 }, () => ({
      scale: 1e-5 * (0.1 + next()),
      values: Int16Array.from({ length: 4 * s.n }, () => 65_000 * (next() - 0.5)),
    }));
    const gains = bands.map((_, j) => (j === 2 ? 1 : 3 * next()));
    const expected = s.positions.slice();
    for (const [j, { scale, values }] of bands.entries()) {
      const c = (gains[j]! - 1) * scale;
      for (let i = 0; i < expected.length; i++) expected[i]! += c * values[4 * Math.floor(i / 3) + (i % 3)]!;
    }
    const out = new Float32Array(3 * s.n);
    editedPositions(s.positions, bands, [{ opacity: 1, gains, mask: null }], out);
    expect(out).toEqual(expected);
    // A full mask at a single band splits the sum of bands.
    const mask = new Uint8Array(s.n).fill(255);
    const alone = gains.map((_, j) => (j === 4 ? gains[4]! : 1));
    const layers = [
      { opacity: 1, gains: gains.with(4, 1), mask: null },
      { opacity: 1, gains: alone, mask },
    ];
    const cut = new Float32Array(3 * s.n);
    editedPositions(s.positions, bands, layers, cut);
    for (let i = 0; i < cut.length; i++) expect(cut[i]).toBeCloseTo(expected[i]!, 6);
  });

  test('outside a mask stay to the bit', () => {
    const s = sheet(9, 0.1);
    const w = { scale: 1e-3, values: new Int16Array(4 * s.n).fill(1000) };
    const mask = new Uint8Array(s.n).map((_, v) => (v < 10 ? 0 : 200));
    const out = new Float32Array(3 * s.n);
    editedPositions(s.positions, [w], [{ opacity: 1, gains: [0], mask }], out);
    expect(out.subarray(0, 30)).toEqual(s.positions.subarray(0, 30));
    expect(out[30]).not.toBe(s.positions[30]);
  });

  test('edited positions are carried into a pose in the frames of their vertices', () => {
    const base = Float32Array.from([0, 0, 0, 1, 0, 0]);
    const edited = Float32Array.from([0, 0, 0, 1.5, 0.25, 0]);
    const places = Float32Array.from([5, 5, 5, 2, 3, 4]);
    const half = Math.round(32767 * Math.SQRT1_2);
    // No rotation, and a quarter turn about z.
    carryInto(base, places, Int16Array.from([0, 0, 0, 32767, 0, 0, half, half]), edited);
    expect([...edited.subarray(0, 3)]).toEqual([5, 5, 5]);
    for (const [c, x] of [2 - 0.25, 3 + 0.5, 4].entries()) expect(edited[3 + c]!).toBeCloseTo(x, 4);
  });

  test('displacement and volume are those of a box', () => {
    expect(displacement(base, Float32Array.from([0, 3, 4, 1, 0, 0]))).toEqual({
      greatest: 5,
      rms: Math.sqrt(12.5),
    });
    const tetrahedron = Float32Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1]);
    expect(volume(tetrahedron, Uint32Array.from([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3]))).toBeCloseTo(
      1 / 6,
      12,
    );
  });
});

test('normals of a plane are its normal, for a mesh and a cloud', () => {
  const s = sheet(6);
  const normals = new Int8Array(4 * s.n);
  meshNormals(s.positions, s.triangles, new Float32Array(3 * s.n), normals);
  for (let v = 0; v < s.n; v++)
    expect(Array.from(normals.subarray(4 * v, 4 * v + 4))).toEqual([0, 0, 127, 0]);
  const near = neighborsOfCloud(s.positions, 6);
  cloudNormals(s.positions, near.offsets, near.entries, normals);
  for (let v = 0; v < s.n; v++) expect(Math.abs(normals[4 * v + 2]!)).toBeGreaterThan(125);
});

test('neighbors in a cloud are the nearest', () => {
  const next = random(5);
  // A surface, as scans are.
  const p = Float32Array.from({ length: 600 }, (_, i) => (i % 3 === 2 ? 0.1 : 1) * next());
  const k = 5;
  const { offsets, entries } = neighborsOfCloud(p, k);
  let right = 0;
  for (let v = 0; v < 200; v++) {
    const far = (w: number) =>
      Math.hypot(p[3 * v]! - p[3 * w]!, p[3 * v + 1]! - p[3 * w + 1]!, p[3 * v + 2]! - p[3 * w + 2]!);
    const order = Array.from({ length: 200 }, (_, w) => w)
      .filter((w) => w !== v)
      .sort((a, b) => far(a) - far(b));
    const found = new Set(entries.subarray(offsets[v]!, offsets[v + 1]!));
    right += order.slice(0, k).filter((w) => found.has(w)).length;
  }
  expect(right).toBe(200 * k);
});

test('a pick finds the triangle under the ray, and the nearest of its corners', () => {
  const s = sheet(20);
  const { around } = rows(s);
  const ray = { origin: [0.51, 0.26, 2] as const, direction: [0, 0, -1] as const, pixel: 1e-4 };
  const balls = enclosingBalls(s.positions);
  const hit = pickMesh(s.positions, balls, s.triangles, around, 1 / 20, ray)!;
  expect(hit.point[0]).toBeCloseTo(0.51, 6);
  expect(hit.point[2]).toBeCloseTo(0, 6);
  expect(hit.normal).toEqual([0, 0, 1]);
  expect(hit.vertex).toBe(nearestVertex(s.positions, 0.51, 0.26, 0));
  expect(pickMesh(s.positions, balls, s.triangles, around, 1 / 20, { ...ray, origin: [3, 0, 2] })).toBeNull();
});

test('picking leaves out only what is far from the ray', () => {
  const s = sheet(60, 0.004);
  const { around } = rows(s);
  const balls = enclosingBalls(s.positions);
  const everything = balls.map((x, i) => (i % 4 === 3 ? 10 : x));
  const next = random(3);
  let hits = 0;
  for (let k = 0; k < 200; k++) {
    const aim = [1.2 * next() - 0.1, 1.2 * next() - 0.1, 0];
    const origin = [next(), next(), 0.5 + next()] as const;
    const far = aim.map((x, c) => x - origin[c]!);
    const length = Math.hypot(...far);
    const direction = far.map((x) => x / length) as [number, number, number];
    const ray = { origin, direction, pixel: 0.001 };
    const hit = pickMesh(s.positions, balls, s.triangles, around, 1 / 60, ray);
    expect(hit).toEqual(pickMesh(s.positions, everything, s.triangles, around, 1 / 60, ray));
    if (hit) hits++;
  }
  expect(hits).toBeGreaterThan(100);
});

test('fewer triangles over the same vertices', () => {
  const s = sheet(200);
  const coarse = coarseTriangles(s.positions, s.triangles, 8000);
  expect(coarse.length / 3).toBeGreaterThan(3000);
  expect(coarse.length / 3).toBeLessThan(16_000);
  expect(Math.max(...coarse)).toBeLessThan(s.n);
});

test('edges are there once', () => {
  const s = sheet(3);
  const { neighbors } = rows(s);
  // Euler: V − E + F = 1 for a disc.
  expect(edgePairs(neighbors.offsets, neighbors.entries).length / 2).toBe(s.n + s.triangles.length / 3 - 1);
});

test('bands are read whatever the pieces they come in', async () => {
  const n = 5;
  const bytes = new Uint8Array(2 * (8 + 8 * n));
  const view = new DataView(bytes.buffer);
  for (const [k, level] of [2, 1].entries()) {
    const at = k * (8 + 8 * n);
    view.setUint32(at, level, true);
    view.setFloat32(at + 4, level / 4, true);
    for (let i = 0; i < 4 * n; i++) view.setInt16(at + 8 + 2 * i, 100 * level + i, true);
  }
  for (const piece of [1, 7, 48, 1000]) {
    const stream = new ReadableStream<Uint8Array>({
      start(controller) {
        for (let k = 0; k < bytes.length; k += piece) controller.enqueue(bytes.slice(k, k + piece));
        controller.close();
      },
    });
    const seen: [number, number, number][] = [];
    await readBands(stream, n, 2, false, (level, band) => seen.push([level, band.scale, band.values[19]!]));
    expect(seen).toEqual([
      [2, 0.5, 219],
      [1, 0.25, 119],
    ]);
  }
  const cut = new ReadableStream<Uint8Array>({
    start(controller) {
      controller.enqueue(bytes.slice(0, 60));
      controller.close();
    },
  });
  await expect(readBands(cut, n, 2, false, () => {})).rejects.toThrow('incomplete bands');
});

test('stamps added one after the other have the distances of all of them in one search', () => {
  const s = sheet(40, 0.01);
  const stamps = Array.from({ length: 12 }, (_, k) => nearestVertex(s.positions, 0.2 + 0.04 * k, 0.5, 0));
  const whole = new SurfaceSearch(surfaceOf(s));
  whole.run(stamps, 0.2);
  const added = new SurfaceSearch(surfaceOf(s));
  added.run([0], 0.5); // earlier searches do not count
  added.run(stamps.slice(0, 1), 0.2);
  let found = added.nReached;
  for (const stamp of stamps.slice(1)) {
    added.add([stamp], 0.2);
    found += added.nReached;
  }
  let off = 0;
  let total = 0;
  for (let v = 0; v < s.n; v++) {
    expect(added.distance(v) === Infinity).toBe(whole.distance(v) === Infinity);
    // Where two stamps are equally near, the front may come from either, and on so rough a sheet the ways differ.
    if (whole.distance(v) === Infinity) continue;
    const difference = Math.abs(added.distance(v) - whole.distance(v));
    off = Math.max(off, difference);
    total += difference;
  }
  expect(off).toBeLessThan(0.4 / 40); // a part of an edge
  expect(total / whole.nReached).toBeLessThan(0.02 / 40);
  expect(found).toBeLessThan(6 * whole.nReached);
});

test('the circle of the brush is closed, and at its distance', () => {
  const s = sheet(40);
  const { around } = rows(s);
  const search = new SurfaceSearch(surfaceOf(s));
  const middle = nearestVertex(s.positions, 0.5, 0.5, 0);
  search.run([middle], 0.3);
  const ring = contour(search, s.positions, s.triangles, around, 0.2);
  const ends = new Map<string, number>();
  for (let i = 0; i < ring.length; i += 3) {
    const place = Array.from(ring.subarray(i, i + 2), (x) => x.toFixed(5)).join();
    ends.set(place, (ends.get(place) ?? 0) + 1);
    // The contour is a chord between the edges that it crosses.
    expect(Math.hypot(ring[i]! - 0.5, ring[i + 1]! - 0.5)).toBeGreaterThan(0.198);
    expect(Math.hypot(ring[i]! - 0.5, ring[i + 1]! - 0.5)).toBeLessThan(0.201);
  }
  expect(ends.size).toBeGreaterThan(20);
  for (const times of ends.values()) expect(times % 2).toBe(0);
});
