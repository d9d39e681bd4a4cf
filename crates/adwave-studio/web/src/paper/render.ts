/** Pictures of a shape at any size: drawn in tiles with supersampling, and written row by row. */

import type { Camera } from '../camera';
import type { View } from '../view';
import { PngWriter } from './png';

/** Samples of a pixel along each side. */
export const SAMPLES = 2;
/** Largest side of a tile in pixels of the picture. */
const TILE = 1024;
/** Pixels around a tile for points whose centers lie outside of it, for a picture as large as that of the page. */
const MARGIN = 34;
/** Largest side of a tile in samples; WebGL 2 has at least 2048, and all machines of the last years have 4096. */
const MOST_SAMPLES = 4096;

export interface PictureSize {
  width: number;
  height: number;
}

/** A layer over the picture, such as the legend: colors with opacity and its upper left corner. */
export interface PictureLayer {
  image: ImageData;
  x: number;
  y: number;
}

export interface PictureParams {
  size: PictureSize;
  /** Color of the ground, from 0 to 1; `null` leaves it transparent. */
  ground: [number, number, number] | null;
  camera: Camera;
  layers: readonly PictureLayer[];
  signal: AbortSignal;
  /** Called with the share that is done. */
  progress: (share: number) => void;
}

/** Draws a picture as a PNG. */
export async function drawPicture(view: View, params: PictureParams): Promise<Blob> {
  const { size, layers, signal } = params;
  const png = new PngWriter(size.width, size.height);
  const scale = (SAMPLES * size.height) / view.part.height;
  const margin = Math.ceil(MARGIN * scale);
  const tile = Math.max(64, Math.min(TILE, Math.floor((MOST_SAMPLES - 2 * margin) / SAMPLES)));
  try {
    for (let top = 0; top < size.height; top += tile) {
      const height = Math.min(tile, size.height - top);
      const band = new Uint8Array(4 * size.width * height);
      for (let left = 0; left < size.width; left += tile) {
        signal.throwIfAborted();
        const width = Math.min(tile, size.width - left);
        const samples = view.drawSamples({
          camera: params.camera,
          whole: { width: SAMPLES * size.width, height: SAMPLES * size.height },
          part: { x: SAMPLES * left, y: SAMPLES * top, width: SAMPLES * width, height: SAMPLES * height },
          margin,
          scale,
          ground: params.ground,
        });
        reduce(samples, { width, height }, band.subarray(4 * left), 4 * size.width);
        // The page can be used meanwhile.
        await new Promise((done) => setTimeout(done));
      }
      for (const layer of layers) blend(layer, band, { top, width: size.width, height });
      await png.write(band);
      params.progress((top + height) / size.height);
    }
    return await png.finish();
  } catch (error) {
    await png.abort();
    throw error;
  }
}

/**
 * Means of the samples of each pixel, whose colors are multiplied by their opacity and whose rows run from below; the
 * colors of the pixels are not multiplied and their rows, `stride` bytes apart, run from the top.
 */
export function reduce(
  samples: Uint8Array,
  { width, height }: PictureSize,
  out: Uint8Array,
  stride: number,
): void {
  const row = 4 * SAMPLES * width;
  const rows = SAMPLES * height;
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      let [r, g, b, a] = [0, 0, 0, 0];
      for (let j = 0; j < SAMPLES; j++) {
        let at = (rows - 1 - (SAMPLES * y + j)) * row + 4 * SAMPLES * x;
        for (let i = 0; i < SAMPLES; i++, at += 4) {
          r += samples[at]!;
          g += samples[at + 1]!;
          b += samples[at + 2]!;
          a += samples[at + 3]!;
        }
      }
      if (a === 0) continue;
      const k = y * stride + 4 * x;
      out[k] = Math.min(255, Math.round((255 * r) / a));
      out[k + 1] = Math.min(255, Math.round((255 * g) / a));
      out[k + 2] = Math.min(255, Math.round((255 * b) / a));
      out[k + 3] = Math.round(a / SAMPLES ** 2);
    }
  }
}

/** Puts a layer over rows of the picture, of which `top` is the first. */
export function blend(
  { image, x, y }: PictureLayer,
  rows: Uint8Array,
  { top, width, height }: { top: number; width: number; height: number },
): void {
  for (let j = Math.max(0, y - top); j < Math.min(height, y + image.height - top); j++) {
    for (let i = Math.max(0, -x); i < Math.min(image.width, width - x); i++) {
      const from = 4 * ((j + top - y) * image.width + i);
      const alpha = image.data[from + 3]! / 255;
      if (alpha === 0) continue;
      const to = 4 * (j * width + x + i);
      const below = (rows[to + 3]! / 255) * (1 - alpha);
      const sum = alpha + below;
      for (let c = 0; c < 3; c++)
        rows[to + c] = Math.round((image.data[from + c]! * alpha + rows[to + c]! * below) / sum);
      rows[to + 3] = Math.round(255 * sum);
    }
  }
}
