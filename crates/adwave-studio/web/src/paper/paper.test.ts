import { inflateSync } from 'node:zlib';
import { expect, test } from 'vitest';
import { crc32 } from './crc';
import { PngWriter } from './png';
import { parseRecipe, USUAL_CHOICES } from './recipe';
import { blend, reduce } from './render';
import { ZipWriter } from './zip';

test('the check of a known text', () => {
  const bytes = new TextEncoder().encode('123456789');
  expect(crc32(bytes)).toBe(0xcbf43926);
  expect(crc32(bytes.subarray(4), crc32(bytes.subarray(0, 4)))).toBe(0xcbf43926);
});

test('a picture is read back from its rows', async () => {
  const [width, height] = [5, 4];
  const rows = Uint8Array.from({ length: 4 * width * height }, (_, i) => (i * i * 37) & 255);
  const png = new PngWriter(width, height);
  await png.write(rows.subarray(0, 4 * width));
  await png.write(rows.subarray(4 * width));
  const bytes = Buffer.from(await (await png.finish()).arrayBuffer());
  const packed: Buffer[] = [];
  for (let at = 8; at < bytes.length; ) {
    const length = bytes.readUInt32BE(at);
    const body = bytes.subarray(at + 4, at + 8 + length);
    expect(bytes.readUInt32BE(at + 8 + length)).toBe(crc32(body));
    if (body.toString('latin1', 0, 4) === 'IDAT') packed.push(body.subarray(4));
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(packed));
  const pixels = new Uint8Array(rows.length);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (4 * width + 1)];
    for (let i = 0; i < 4 * width; i++) {
      const left = i < 4 ? 0 : pixels[y * 4 * width + i - 4]!;
      const up = y === 0 ? 0 : pixels[(y - 1) * 4 * width + i]!;
      pixels[y * 4 * width + i] = raw[y * (4 * width + 1) + 1 + i]! + (filter === 2 ? up : left);
    }
  }
  expect(pixels).toEqual(rows);
});

test('samples become pixels whose colors are not multiplied by the opacity', () => {
  // Of four samples two are red, and the others transparent; rows run from below.
  const samples = Uint8Array.of(200, 0, 0, 255, 100, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0, 0);
  const out = new Uint8Array(4);
  reduce(samples, { width: 1, height: 1 }, out, 4);
  expect([...out]).toEqual([150, 0, 0, 128]);
});

test('a layer covers the ground by its opacity, and is cut at the borders', () => {
  const image = { width: 2, height: 1, data: Uint8ClampedArray.of(255, 0, 0, 255, 0, 0, 255, 51) };
  const rows = new Uint8Array(4 * 2 * 2).fill(100);
  rows[7] = 255;
  const layer = { image: image as unknown as ImageData, x: 0, y: 5 };
  blend(layer, rows, { top: 5, width: 2, height: 2 });
  expect([...rows.subarray(0, 8)]).toEqual([255, 0, 0, 255, 80, 80, 131, 255]);
  const before = [...rows];
  blend({ ...layer, y: 4 }, rows, { top: 5, width: 2, height: 2 });
  expect([...rows], 'above the rows').toEqual(before);
});

test('an archive lists its files', async () => {
  const zip = new ZipWriter();
  await zip.add('a.txt', new Blob(['one']));
  await zip.add('ä.txt', new Blob(['three']));
  const bytes = Buffer.from(await zip.finish().arrayBuffer());
  const end = bytes.length - 22;
  expect([bytes.readUInt32LE(end), bytes.readUInt16LE(end + 10)]).toEqual([0x06054b50, 2]);
  const list = bytes.readUInt32LE(end + 16);
  expect(bytes.readUInt32LE(list)).toBe(0x02014b50);
  expect(list + bytes.readUInt32LE(end + 12)).toBe(end);
  const second = list + 46 + 5;
  expect(bytes.readUInt32LE(second + 16)).toBe(crc32(new TextEncoder().encode('three')));
  const at = bytes.readUInt32LE(second + 42);
  expect(bytes.toString('utf8', at + 30, at + 30 + 11)).toBe('ä.txtthree');
});

test('a recipe is read only if it is complete', () => {
  const camera = { quaternion: [0, 0, 0, 1], pivot: [0, 0, 0], distance: 1, up: 'y', trackball: false };
  const recipe = {
    picture: 1,
    shape: { name: 'a.ply', n_vertices: 4 },
    ...USUAL_CHOICES,
    view: { camera, style: 'shaded', colors: 'none' },
    levels: { levels: 8 },
    edit: { revision: 0, layers: [] },
  };
  expect(parseRecipe(JSON.stringify(recipe))).toEqual(recipe);
  for (const change of [
    { picture: 2 },
    { size: { width: 5, height: 300 } },
    { frames: 0 },
    { view: {} },
    { edit: {} },
  ])
    expect(parseRecipe(JSON.stringify({ ...recipe, ...change })), JSON.stringify(change)).toBeNull();
  expect(parseRecipe('{')).toBeNull();
});
