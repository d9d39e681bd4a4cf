/** Minimal PNG decoder, to test if a screenshot shows something. */

import { inflateSync } from 'node:zlib';

export interface PngImage {
  width: number;
  height: number;
  /** Bytes per pixel. */
  channels: number;
  pixels: Buffer;
}

/** Part of a picture, in pixels. */
export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

/** Decodes a PNG of 8 bits per channel without interlacing. */
export function decodePng(bytes: Buffer): PngImage {
  let at = 8;
  let width = 0;
  let height = 0;
  let channels = 0;
  const parts: Buffer[] = [];
  while (at < bytes.length) {
    const length = bytes.readUInt32BE(at);
    const type = bytes.toString('latin1', at + 4, at + 8);
    const chunk = bytes.subarray(at + 8, at + 8 + length);
    if (type === 'IHDR') {
      width = chunk.readUInt32BE(0);
      height = chunk.readUInt32BE(4);
      channels = { 2: 3, 6: 4 }[chunk[9]!] ?? 0;
      if (chunk[8] !== 8 || !channels || chunk[12] !== 0)
        throw new Error('the image must be an 8-bit color PNG without interlacing');
    } else if (type === 'IDAT') parts.push(chunk);
    at += 12 + length;
  }
  const raw = inflateSync(Buffer.concat(parts));
  const stride = width * channels;
  const pixels = Buffer.alloc(height * stride);
  for (let y = 0; y < height; y++) {
    const filter = raw[y * (stride + 1)]!;
    for (let x = 0; x < stride; x++) {
      const a = x >= channels ? pixels[y * stride + x - channels]! : 0;
      const b = y ? pixels[(y - 1) * stride + x]! : 0;
      const c = y && x >= channels ? pixels[(y - 1) * stride + x - channels]! : 0;
      const pa = Math.abs(b - c);
      const pb = Math.abs(a - c);
      const pc = Math.abs(a + b - 2 * c);
      const paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      const prediction = [0, a, b, (a + b) >> 1, paeth][filter]!;
      pixels[y * stride + x] = raw[y * (stride + 1) + 1 + x]! + prediction;
    }
  }
  return { width, height, channels, pixels };
}

/** Standard deviation of the red channel within a part of a picture. */
export function deviation({ width, channels, pixels }: PngImage, { x, y, width: w, height: h }: Box): number {
  let n = 0;
  let sum = 0;
  let squares = 0;
  for (let j = Math.ceil(y); j < y + h; j++) {
    for (let i = Math.ceil(x); i < x + w; i++) {
      const r = pixels[(j * width + i) * channels]!;
      n++;
      sum += r;
      squares += r * r;
    }
  }
  const mean = sum / n;
  return Math.sqrt(Math.max(0, squares / n - mean * mean));
}
