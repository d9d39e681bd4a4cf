/** Decoder of the stream of bands, coarse to fine, each `u32` level, `f32` scale, `i16 × 4 × n`. */

import type { Band } from './positions';

/** Reader of fixed numbers of bytes from a stream. */
class ByteSource {
  private leftover: Uint8Array | null = null;
  constructor(private readonly reader: ReadableStreamDefaultReader<Uint8Array>) {}

  /** Fills `into`; returns false if the stream ends before. */
  async fill(into: Uint8Array): Promise<boolean> {
    let k = 0;
    while (k < into.length) {
      let chunk = this.leftover;
      this.leftover = null;
      if (!chunk) {
        const { value, done } = await this.reader.read();
        if (done || !value) return false;
        chunk = value;
      }
      const take = Math.min(chunk.length, into.length - k);
      into.set(chunk.subarray(0, take), k);
      if (take < chunk.length) this.leftover = chunk.subarray(take);
      k += take;
    }
    return true;
  }
}

/** Reads all bands of `n` vertices; `see` is called as soon as one is complete. */
export async function readBands(
  body: ReadableStream<Uint8Array>,
  n: number,
  nLevels: number,
  shared: boolean,
  see: (level: number, band: Band) => void,
): Promise<void> {
  const source = new ByteSource(body.getReader());
  const head = new Uint8Array(8);
  for (let k = 0; k < nLevels; k++) {
    if (!(await source.fill(head))) throw new Error('The server sent incomplete bands. Reload the page.');
    const view = new DataView(head.buffer);
    const level = view.getUint32(0, true);
    const scale = view.getFloat32(4, true);
    if (level < 1 || level > nLevels)
      throw new Error(`The server sent band ${level} of ${nLevels}. Reload the page.`);
    const bytes = shared ? new SharedArrayBuffer(8 * n) : new ArrayBuffer(8 * n);
    if (!(await source.fill(new Uint8Array(bytes)))) {
      throw new Error('The server sent incomplete bands. Reload the page.');
    }
    see(level, { scale, values: new Int16Array(bytes) });
  }
}
